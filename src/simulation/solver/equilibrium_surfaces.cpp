// What an equilibrium adds to the forces of the elements for surfaces that meet something: contact with friction,
// buoyancy and drag. Their points may be carried by mesh nodes (object_points).
#include <algorithm>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

using linalg::view;

namespace {

/// Motion of the nodes of the obstacles (3 obstacle nodes).
Eigen::VectorXd or_at_rest(const Eigen::VectorXd& motion, const Controls& controls) {
    if (motion.size() > 0) return motion;
    return Eigen::VectorXd::Zero(controls.obstacles.size());
}

}  // namespace

std::vector<double> Equilibrium::with_obstacles(const Eigen::VectorXd& x, const Eigen::VectorXd& obstacles) const {
    std::vector<double> all(x.data(), x.data() + x.size());
    model_->object_points().append(view(x), all);
    all.insert(all.end(), obstacles.data(), obstacles.data() + obstacles.size());
    return all;
}

Eigen::VectorXd Equilibrium::obstacles_at(double time) const {
    const contact::Contact* contact = model_->contact(true);
    if (contact == nullptr) return {};
    const int first = contact->robot_node_count();
    Eigen::VectorXd positions(3 * (contact->node_count() - first));
    const auto& obstacles = model_->description().contact->obstacles;
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
        const Eigen::Vector3d move = obstacles[k].share.at(time) * linalg::vector(obstacles[k].move_m);
        for (int node = contact->first_node(k); node < contact->first_node(k + 1); ++node) {
            const auto rest = linalg::view(contact->rest(), node);
            positions.segment<3>(3 * (node - first)) = rest + move;
        }
    }
    return positions;
}

double Equilibrium::contact_energy(const Eigen::VectorXd& x, const Controls& controls) const {
    const contact::Contact* contact = this->contact(controls);
    if (contact == nullptr) return 0;
    const std::vector<double> all = with_obstacles(x, controls.obstacles);
    return contact->energy(contact->find(all), all) + (controls.friction ? controls.friction->energy(all) : 0);
}

void Equilibrium::add_contact(const Eigen::VectorXd& x, const Controls& controls, Eigen::VectorXd& forces,
                              double& energy) const {
    const contact::Contact* contact = this->contact(controls);
    if (contact == nullptr) return;
    const std::vector<double> all = with_obstacles(x, controls.obstacles);
    const contact::Pairs pairs = contact->find(all);
    std::vector<double> gradient(all.size(), 0.0);
    contact->add_gradient(pairs, all, gradient);
    energy += contact->energy(pairs, all);
    if (controls.friction) {
        controls.friction->add_gradient(all, gradient);
        energy += controls.friction->energy(all);
    }
    add_carried(gradient, forces);
}

Eigen::VectorXd Equilibrium::contact_gradient(const contact::Pairs& pairs, const std::vector<double>& x,
                                              const Controls& controls) const {
    std::vector<double> on_all(x.size(), 0.0);
    contact(controls)->add_gradient(pairs, x, on_all);
    if (controls.friction) controls.friction->add_gradient(x, on_all);
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(rest_.size());
    add_carried(on_all, forces);
    return restrict_to_free(forces);
}

void Equilibrium::add_carried(const std::vector<double>& on_all, Eigen::VectorXd& forces) const {
    forces += Eigen::Map<const Eigen::VectorXd>(on_all.data(), forces.size());
    if (const auto count = static_cast<std::size_t>(model_->object_points().count()); count > 0)
        model_->object_points().add_forces(
            std::span(on_all).subspan(static_cast<std::size_t>(forces.size()), 3 * count), view(forces));
}

void Equilibrium::add_buoyancy(const Eigen::VectorXd& x, const Controls& controls, Eigen::VectorXd& forces,
                               double& energy) const {
    const std::vector<double> all = with_obstacles(x, {});
    const FluidForces::Gravity gravity = gravity_at(controls.time);
    std::vector<double> on_all(all.size(), 0.0);
    fluid_->add_buoyancy(all, gravity, on_all);
    energy += fluid_->buoyancy_energy(all, gravity);
    add_carried(on_all, forces);
}

Equilibrium::Stream Equilibrium::stream(const Eigen::VectorXd& x, const Inertia& inertia) const {
    return {with_obstacles(inertia.start().x, {}), with_obstacles(inertia.damped_velocity(x), {})};
}

void Equilibrium::add_drag(const Eigen::VectorXd& x, const Controls& controls, const Inertia& inertia,
                           Eigen::VectorXd& forces, double& energy) const {
    if (!fluid_->drags() || !model_->description().moves_in_time) return;
    const Stream s = stream(x, inertia);
    const FluidForces::Motion motion{s.start, s.v, inertia.rate(), gravity_at(controls.time)};
    std::vector<double> on_all(s.v.size(), 0.0);
    fluid_->add_drag(motion, on_all);
    energy += fluid_->drag_energy(motion);
    add_carried(on_all, forces);
}

void Equilibrium::add_drag_tangent(const Eigen::VectorXd& x, const Controls& controls, const Inertia& inertia,
                                   const TangentLayout& layout, std::span<double> values) const {
    if (!fluid_->drags() || !model_->description().moves_in_time) return;
    const Stream s = stream(x, inertia);
    const FluidForces::Motion motion{s.start, s.v, inertia.rate(), gravity_at(controls.time)};
    visit_carried(layout, values, [&](const contact::BlockVisitor& visit) { fluid_->visit_drag(motion, visit); });
}

/// Adds blocks between contact's nodes, transferred to the mesh nodes that carry them.
void Equilibrium::visit_carried(const TangentLayout& layout, std::span<double> values,
                                const std::function<void(const contact::BlockVisitor&)>& blocks) const {
    const std::vector<int>& index = index_of(layout.nodes);
    const contact::BlockVisitor add = [&](int a, int b, const linalg::Matrix3& block) {
        const int i = index[static_cast<std::size_t>(a)];
        const int j = index[static_cast<std::size_t>(b)];
        if (j >= 0 && i >= j) layout.pattern.add_block(values, i, j, [&](int r, int c) { return block(r, c); });
    };
    blocks([&](int a, int b, const linalg::Matrix3& block) { model_->object_points().visit_block(a, b, block, add); });
}

double Equilibrium::largest_step(const Eigen::VectorXd& x, const Eigen::VectorXd& motion, const Controls& controls,
                                 const Eigen::VectorXd& obstacle_motion) const {
    const contact::Contact* contact = this->contact(controls);
    if (contact == nullptr) return 1;
    return contact->largest_step(with_obstacles(x, controls.obstacles),
                                 with_obstacles(motion, or_at_rest(obstacle_motion, controls)));
}

bool Equilibrium::is_free(const Eigen::VectorXd& x, const Eigen::VectorXd& motion, const Controls& controls,
                          const Eigen::VectorXd& obstacle_motion) const {
    const contact::Contact* contact = this->contact(controls);
    return contact == nullptr || contact->is_free(with_obstacles(x, controls.obstacles),
                                                  with_obstacles(motion, or_at_rest(obstacle_motion, controls)));
}

std::shared_ptr<const contact::Friction> Equilibrium::freeze_friction(const State& state, const State& start,
                                                                      const Controls& controls,
                                                                      const Controls& start_controls) const {
    const contact::Contact* contact = this->contact(controls);
    if (contact == nullptr) return nullptr;
    const std::vector<double> x = with_obstacles(state.x, controls.obstacles);
    return std::make_shared<const contact::Friction>(contact->freeze(
        contact->find(x), x, with_obstacles(start.x, start_controls.obstacles), start_controls.friction.get()));
}

bool Equilibrium::has_friction() const {
    const auto& rules = model_->description().contact;
    if (!rules) return false;
    const auto& objects = model_->description().objects;
    if (std::any_of(objects.begin(), objects.end(), [](const FreeObject& object) { return object.friction > 0; }))
        return true;
    return rules->settings.friction > 0 ||
           std::any_of(rules->obstacles.begin(), rules->obstacles.end(),
                       [](const Obstacle& obstacle) { return obstacle.body.friction > 0; });
}

bool Equilibrium::touches(const State& state, const Controls& controls) const {
    const contact::Contact* contact = this->contact(controls);
    return contact != nullptr && !contact->find(with_obstacles(state.x, controls.obstacles)).empty();
}

Touching Equilibrium::touching(const State& state, const Controls& controls) const {
    Touching found;
    if (const contact::Contact* contact = this->contact(controls)) {
        const contact::Pairs pairs = contact->find(with_obstacles(state.x, controls.obstacles));
        found.surfaces = contact->partners(pairs);
        found.faces = contact->faces_met(pairs);
    }
    const std::vector<double> places = joint_coordinates(state.x, controls);
    for (std::size_t j = 0; j < places.size(); ++j) {
        const JointLaw& law = model_->description().joints[j].law;
        if (places[j] < law.low) found.stops.push_back({static_cast<int>(j), 0});
        if (places[j] > law.high) found.stops.push_back({static_cast<int>(j), 1});
    }
    return found;
}

bool Equilibrium::meets_itself(const State& state, const Controls& now, const State& next, const Controls& then) const {
    if (then.met || model_->contact(true) == model_->contact(false)) return false;
    const contact::Contact& contact = *model_->contact(true);
    const std::vector<double> x = with_obstacles(state.x, now.obstacles);
    const std::vector<double> end = with_obstacles(next.x, then.obstacles);
    std::vector<double> motion(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) motion[i] = end[i] - x[i];
    return contact.meets(x, motion);
}

std::optional<Vec3> Equilibrium::crossing(const State& state, const Controls& controls) const {
    if (const auto* contact = model_->contact(true); contact != nullptr && contact->settings().self)
        return std::nullopt;
    const auto found = model_->surfaces().crossing(with_obstacles(state.x, controls.obstacles));
    return found ? std::optional(found->point_m) : std::nullopt;
}

contact::Forces Equilibrium::contact_forces(const State& state, const Controls& controls) const {
    const contact::Contact* contact = this->contact(controls);
    const std::vector<double> x = with_obstacles(state.x, controls.obstacles);
    return contact->forces(contact->find(x), x, controls.friction.get());
}

Eigen::VectorXd Equilibrium::contact_node_forces(const State& state, const Controls& controls) const {
    Eigen::VectorXd out_of_balance = Eigen::VectorXd::Zero(state.x.size());
    double energy = 0;
    add_contact(state.x, controls, out_of_balance, energy);
    return -out_of_balance;
}

std::vector<std::vector<int>> Equilibrium::contact_cliques(const State& state, const Controls& controls,
                                                           TangentNodes of) const {
    std::vector<std::vector<int>> cliques;
    const contact::Contact* contact = this->contact(controls);
    if (contact == nullptr) return cliques;
    const std::vector<int>& index = index_of(of);
    const auto add = [&](std::span<const int> nodes) {
        std::vector<int> clique;
        for (const int& contact_node : nodes) {
            for (const int node : model_->object_points().carriers(contact_node))
                clique.push_back(index[static_cast<std::size_t>(node)]);
        }
        if (!objects().empty()) {
            std::ranges::sort(clique);
            clique.erase(std::unique(clique.begin(), clique.end()), clique.end());
        }
        cliques.push_back(std::move(clique));
    };
    const auto add_pairs_at = [&](const Eigen::VectorXd& x) {
        const contact::Pairs pairs = contact->find(with_obstacles(x, controls.obstacles));
        for (const contact::Pair& pair : pairs) add({pair.nodes.data(), static_cast<std::size_t>(pair.node_count())});
    };
    if (!controls.inertia || controls.inertia->means().empty()) {
        add_pairs_at(state.x);
    } else {
        for (const Inertia::Mean& at : controls.inertia->means())
            add_pairs_at(controls.inertia->on_path(state.x, at.share));
    }
    if (controls.friction) {
        for (const contact::FrozenPair& pair : controls.friction->pairs())
            add({pair.nodes.data(), static_cast<std::size_t>(pair.node_count)});
    }
    return cliques;
}

}  // namespace pliant::sim

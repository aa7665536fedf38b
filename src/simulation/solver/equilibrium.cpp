#include "simulation/solver/equilibrium.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/core/parallel.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/drives.hpp"
#include "simulation/solver/residual.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

/// Stiffness of plate springs relative to that of an element: a load that bends the plate bends the body a hundred
/// times as much.
constexpr double plate_stiffness = 100;

using Flaw = Evaluation::Flaw;

/// Squared distance of a tet's centre from the straight line of a cable through its gap.
double distance_from(const Growth& growth, const Vec3& centre) {
    const Vec3 away = centre - growth.center_m;
    const Vec3 across = away - dot(away, growth.direction) * growth.direction;
    return dot(across, across);
}

/// True if no other cable in the same gap is nearer to the tet; ties go to the first cable.
bool is_nearest(const Description& d, std::size_t tet, const Growth& growth) {
    Vec3 centre;
    for (const int node : d.mesh.tet(tet).first(4)) centre += 0.25 * d.mesh.points[static_cast<std::size_t>(node)];
    const double own = distance_from(growth, centre);
    for (const Growth& other : d.growths) {
        if (other.material != growth.material || other.actuator == growth.actuator) continue;
        const double distance = distance_from(other, centre);
        if (distance < own || (distance == own && other.actuator < growth.actuator)) return false;
    }
    return true;
}

/// A state on the straight path from the start of the step.
State on_the_way(const State& state, const Inertia& inertia, double share) {
    return {inertia.start().x + share * (state.x - inertia.start().x), state.multiplier};
}

Evaluation impossible(double min_J, Flaw flaw) {
    Evaluation e;
    e.min_J = min_J;
    e.flaw = flaw;
    return e;
}

}  // namespace

std::string_view name(Flaw flaw) {
    switch (flaw) {
        case Flaw::none:
            return "is possible";
        case Flaw::inverted:
            return "turns a tetrahedron inside out";
        case Flaw::pierced:
            return "makes surfaces touch or pass through each other";
        case Flaw::collapsed:
            return "leaves a chamber without volume (walls that are to rest on each other need [contact])";
    }
    return {};
}

Equilibrium::Equilibrium(const Model& model) : model_(&model) {
    const Description& d = model.description();
    const Eigen::Index n = model.node_count();
    all_nodes_.resize(static_cast<std::size_t>(n));
    std::iota(all_nodes_.begin(), all_nodes_.end(), 0);
    rest_.resize(3 * n);
    gravity_.resize(3 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Vec3& p = d.mesh.points[static_cast<std::size_t>(i)];
        rest_.segment<3>(3 * i) << p.x, p.y, p.z;
        gravity_.segment<3>(3 * i) =
            model.elements().node_mass_kg()[static_cast<std::size_t>(i)] * linalg::vector(d.gravity_m_s2);
    }
    for (const HeldNodes::Roller& roller : model.held().rollers()) {
        const int free = model.free_index()[static_cast<std::size_t>(roller.node)];
        if (free >= 0) rollers_.push_back({roller.node, free, roller.may_move});
    }
    add_actuators();
    for (std::size_t k = 0; k < d.pressures.size(); ++k) {
        if (!rim_is_held(d.pressures[k].wall)) skew_.push_back(d.cables.size() + d.chambers.size() + k);
    }
    const auto by_gaps = [](const Actuator& actuator) { return actuator.gaps() != nullptr; };
    conservative_ = model.elements().has_energy() && skew_.empty() && torques_.empty() &&
                    std::none_of(actuators_.begin(), actuators_.end(), by_gaps);
    double stiffest = 0;
    for (const Material& material : d.materials) stiffest = std::max(stiffest, material::stiffness_bound(material.law));
    const double volume = mesh::volume(d.mesh);
    add_plates(stiffest, volume);
    force_floor_ = 1e-9 * stiffest * std::pow(volume, 2.0 / 3);
    energy_rounding_ = 1e-16 * stiffest * volume;
    for (const AffineBody& object : objects()) {
        const double edge = (linalg::view(view(std::as_const(rest_)), object.nodes()[1]) -
                             linalg::view(view(std::as_const(rest_)), object.nodes()[0]))
                                .norm();
        energy_rounding_ += 1e-16 * object.node_stiffness() * edge * edge;
    }
    for (const Joint& joint : d.joints) {
        joints_.emplace_back(joint);
        energy_rounding_ += 1e-16 * joint.stiffness_N_m * joint.arm_m * joint.arm_m;
    }
    // Rounding moves a node by a fraction of its coordinate, which causes a force of that times a tet's stiffness times
    // its size.
    const double size = std::cbrt(volume / static_cast<double>(d.mesh.tet_count()));
    const double farthest = rest_.cwiseAbs().maxCoeff();
    force_rounding_ = 1e-16 * stiffest * farthest * size * std::sqrt(static_cast<double>(n));
    // Rigid things are stiffer: objects, with four nodes each.
    for (const AffineBody& object : objects()) force_rounding_ += 2e-16 * object.node_stiffness() * farthest;
    for (const JointForce& joint : joints_) force_rounding_ += 2e-16 * joint.stiffness_N_m() * farthest;
}

void Equilibrium::add_actuators() {
    const Description& d = model_->description();
    const auto rest = view(std::as_const(rest_));
    for (std::size_t c = 0; c < d.cables.size(); ++c)
        actuators_.emplace_back(CablePath(d.cables[c].points, rest), rest, gap_elements_of(c));
    for (const Spring& spring : d.springs) springs_.emplace_back(spring, rest);
    for (const TorqueLoad& load : d.torques) torques_.emplace_back(load.nodes);
    add_fluid();
    for (const Chamber& chamber : d.chambers) actuators_.emplace_back(ChamberSurface(chamber.wall, rest), rest);
    for (const PressureLoad& load : d.pressures) actuators_.emplace_back(ChamberSurface(load.wall, rest), rest);
}

void Equilibrium::add_fluid() {
    const Description& d = model_->description();
    if (!d.fluid) return;
    contact::Surface skin;
    skin.triangles = d.fluid->skin;
    fluid_.emplace(*d.fluid, model_->object_points().with_objects(std::move(skin), d.objects).triangles);
}

Eigen::Vector3d Equilibrium::gravity_at(double time) const {
    const Description& d = model_->description();
    return d.gravity_share.at(time) * linalg::vector(d.gravity_m_s2);
}

/// Of the tets of a gap that several cables pass, each cable has those that are nearest to it.
std::optional<GapElements> Equilibrium::gap_elements_of(std::size_t cable) const {
    const Description& d = model_->description();
    std::vector<GapElements::Gap> gaps;
    for (std::size_t k = 0; k < d.growths.size(); ++k) {
        const Growth& growth = d.growths[k];
        if (growth.actuator != static_cast<int>(cable)) continue;
        GapElements::Gap gap{{}, growth.direction, growth.length_m, growth.weight_Pa, k};
        for (std::size_t t = 0; t < model_->elements().tet_count(); ++t) {
            if (model_->elements().material(t) == growth.material && is_nearest(d, t, growth)) gap.tets.push_back(t);
        }
        if (!gap.tets.empty()) gaps.push_back(std::move(gap));
    }
    return gaps.empty() ? std::nullopt : std::optional(GapElements(model_->elements(), gaps));
}

void Equilibrium::add_plates(double stiffness_Pa, double volume_m3) {
    const double element_m = std::cbrt(volume_m3 / static_cast<double>(model_->mesh().tet_count()));
    for (const RigidPlate& plate : model_->description().plates)
        plates_.emplace_back(plate.nodes, plate_stiffness * stiffness_Pa * element_m, view(std::as_const(rest_)));
}

bool Equilibrium::rim_is_held(const Wall& wall) const {
    const auto held = [&](int point) {
        const auto& nodes = wall.points[static_cast<std::size_t>(point)].nodes;
        return std::all_of(nodes.begin(), nodes.end(),
                           [&](int node) { return model_->free_index()[static_cast<std::size_t>(node)] < 0; });
    };
    const auto rim = rim_points(wall);
    return std::all_of(rim.begin(), rim.end(), held);
}

Eigen::VectorXd Equilibrium::external_at(double time) const {
    const Description& d = model_->description();
    Eigen::VectorXd force = d.gravity_share.at(time) * gravity_;
    for (const Load& load : d.loads) {
        const Eigen::Vector3d total = load.share.at(time) * linalg::vector(load.force_N);
        for (std::size_t k = 0; k < load.nodes.size(); ++k)
            force.segment<3>(3 * load.nodes[k]) += load.shares[k] * total;
    }
    return force;
}

Drive Equilibrium::drive(std::size_t actuator, double target) const {
    const Description& d = model_->description();
    if (actuator < d.cables.size()) return drive(actuator, target, d.cables[actuator].target.offset);
    return drive(actuator, target, d.chambers[actuator - d.cables.size()].target.offset);
}

Drive Equilibrium::drive(std::size_t actuator, double target, double offset) const {
    return drive_of(model_->description(), actuator, target, offset, actuators_[actuator].rest_measure());
}

Drive Equilibrium::drive_at(std::size_t actuator, double time) const {
    return sim::drive_at(model_->description(), actuator, time, actuators_[actuator].rest_measure());
}

Controls Equilibrium::controls(double time) const {
    Controls controls;
    controls.time = time;
    controls.external_N = external_at(time);
    for (const TorqueLoad& load : model_->description().torques)
        controls.torque_Nm.emplace_back(load.share.at(time) * linalg::vector(load.torque_Nm));
    controls.shares.resize(actuators_.size());
    controls.obstacles = obstacles_at(time);
    for (const Support& support : model_->description().supports)
        controls.support_share.push_back(support.share.at(time));
    for (const Joint& joint : model_->description().joints) controls.joint_wanted.push_back(joint.law.wanted.at(time));
    for (std::size_t a = 0; a < actuators_.size(); ++a) controls.drives.push_back(drive_at(a, time));
    return controls;
}

bool Equilibrium::has_cable_friction() const {
    const auto& cables = model_->description().cables;
    return std::any_of(cables.begin(), cables.end(), [](const Cable& cable) { return cable.friction > 0; });
}

void Equilibrium::freeze_cable_friction(const Eigen::VectorXd& x, std::span<const Drive> all_wanted,
                                        std::span<const Drive> before, Controls& controls) const {
    const auto& cables = model_->description().cables;
    for (std::size_t c = 0; c < cables.size(); ++c) {
        if (!(cables[c].friction > 0)) continue;
        const Drive& wanted = all_wanted[c];
        const double change = wanted.value - before[c].value;
        const bool by_length = wanted.kind == Drive::Kind::measure;
        const bool let_go = by_length ? change > 0 : change < 0;
        const CablePath& path = actuators_[c].cable();
        const double friction = let_go ? -cables[c].friction : cables[c].friction;
        controls.shares[c] = path.tension_shares(view(x), friction, cables[c].pulled_at_first);
        if (!by_length) continue;
        const double weighted = path.length(view(x), controls.shares[c]);
        const double length = path.length(view(x));
        controls.drives[c].value = weighted + (wanted.value - length) * weighted / length;
    }
}

double Equilibrium::cable_friction_error(const State& state, std::span<const Drive> all_wanted) const {
    const auto& cables = model_->description().cables;
    double error = 0;
    for (std::size_t c = 0; c < cables.size(); ++c) {
        const Drive& wanted = all_wanted[c];
        if (!(cables[c].friction > 0) || wanted.kind != Drive::Kind::measure) continue;
        const double violation = (actuators_[c].measure(view(state.x)) - wanted.value) / actuators_[c].rest_measure();
        const bool pulls = state.multiplier[static_cast<Eigen::Index>(c)] > 0;
        error =
            std::max(error, pulls ? std::fabs(violation) : violation);  // a slack cable may be shorter than prescribed
    }
    return error;
}

State Equilibrium::rest() const {
    return {rest_, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(actuators_.size()))};
}

void Equilibrium::place_supports(const Controls& controls, Eigen::VectorXd& x) const {
    model_->held().place(model_->description().supports, model_->mesh().points, controls.support_share, x);
}

double Equilibrium::gas_compliance(const Drive& drive, double multiplier) const {
    return sim::gas_compliance(drive, multiplier, model_->description().ambient_pressure_Pa);
}

Evaluation Equilibrium::evaluate(const State& state, const Controls& controls) const {
    Balance balance;
    const bool of_mean = controls.inertia && !controls.inertia->means().empty();
    Evaluation e = of_mean ? evaluate_mean(state, controls, balance)
                           : evaluate_at(state, controls, controls.inertia.get(), balance);
    if (e.possible()) fill_residual(balance, e);
    return e;
}

Evaluation Equilibrium::evaluate_mean(const State& state, const Controls& controls, Balance& balance) const {
    const Inertia& inertia = *controls.inertia;
    Evaluation mean;
    mean.min_J = std::numeric_limits<double>::infinity();
    balance = {Eigen::VectorXd::Zero(state.x.size()), Eigen::VectorXd::Zero(state.x.size())};
    mean.multiplier = mean.constraint_violation = Eigen::VectorXd::Zero(state.multiplier.size());
    for (const Inertia::Mean& at : inertia.means()) {
        Balance here;
        const Evaluation e = evaluate_at(on_the_way(state, inertia, at.share), controls, nullptr, here);
        if (!e.possible()) return e;
        mean.min_J = std::min(mean.min_J, e.min_J);
        mean.energy_J += at.weight / at.share * e.energy_J;
        mean.multiplier += at.weight * e.multiplier;
        balance.internal += at.weight * here.internal;
        balance.driving += at.weight * here.driving;
    }
    mean.energy_J += inertia.evaluate(state.x, balance.internal);
    if (fluid_) add_drag(state.x, controls, inertia, balance.internal, mean.energy_J);
    return mean;
}

Evaluation Equilibrium::evaluate_at(const State& state, const Controls& controls, const Inertia* inertia,
                                    Balance& balance) const {
    Evaluation e;
    Eigen::VectorXd& internal = balance.internal;
    internal = Eigen::VectorXd::Zero(state.x.size());
    const Elements::Evaluation elastic = model_->elements().evaluate(view(state.x), view(internal));
    e.min_J = elastic.min_J;
    for (const AffineBody& object : objects())
        e.min_J = std::min(e.min_J, object.deformation(view(state.x)).determinant());
    if (!(e.min_J > 0)) return impossible(e.min_J, Flaw::inverted);
    if (has_collapsed_chamber(state.x)) return impossible(e.min_J, Flaw::collapsed);
    e.energy_J = elastic.energy_J - controls.external_N.dot(state.x - rest_);
    add_contact(state.x, controls, internal, e.energy_J);
    if (!std::isfinite(e.energy_J)) return impossible(e.min_J, Flaw::pierced);
    for (const Plate& plate : plates_) {
        e.energy_J += plate.energy(view(state.x));
        plate.add_gradient(view(state.x), view(internal));
    }
    for (const AffineBody& object : objects()) {
        e.energy_J += object.energy(view(state.x));
        object.add_gradient(view(state.x), view(internal));
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        e.energy_J += joints_[j].energy(view(state.x), joint_drive(controls, j));
        joints_[j].add_gradient(view(state.x), joint_drive(controls, j), view(internal));
    }
    for (const SpringPath& spring : springs_) {
        e.energy_J += spring.energy(view(state.x));
        spring.add_gradient(view(state.x), view(internal));
    }
    for (const Actuator& actuator : actuators_) {
        if (actuator.gaps() == nullptr) continue;
        e.energy_J += actuator.gaps()->energy(view(state.x));
        actuator.gaps()->add_gradient(view(state.x), view(internal));
    }
    if (fluid_) add_buoyancy(state.x, controls, internal, e.energy_J);
    if (inertia != nullptr) {
        e.energy_J += inertia->evaluate(state.x, internal);
        if (fluid_) add_drag(state.x, controls, *inertia, internal, e.energy_J);
    }
    fill_actuators(state, controls, e);
    balance.driving = driving_forces(state, controls, e);
    return e;
}

bool Equilibrium::has_collapsed_chamber(const Eigen::VectorXd& x) const {
    const std::size_t first = cable_count();
    const std::size_t end = first + model_->description().chambers.size();
    for (std::size_t a = first; a < end; ++a) {
        if (!(actuators_[a].measure(view(x)) > 0)) return true;
    }
    return false;
}

void Equilibrium::fill_actuators(const State& state, const Controls& controls, Evaluation& e) const {
    e.multiplier = state.multiplier;
    e.constraint_violation = Eigen::VectorXd::Zero(state.multiplier.size());
    for (std::size_t a = 0; a < actuators_.size(); ++a) {
        const Actuator& one = actuators_[a];
        const double g = one.measure(view(state.x), controls.shares[a]);
        add_drive(controls.drives[a], a, {g, one.rest_measure(), one.only_pulls()},
                  model_->description().ambient_pressure_Pa, e);
    }
}

Eigen::VectorXd Equilibrium::driving_forces(const State& state, const Controls& controls, const Evaluation& e) const {
    Eigen::VectorXd driving = -controls.external_N;
    for (std::size_t k = 0; k < torques_.size(); ++k)
        torques_[k].subtract_from(view(state.x), controls.torque_Nm[k], view(driving));
    for (std::size_t a = 0; a < actuators_.size(); ++a)
        actuators_[a].add_gradient(view(state.x), e.multiplier[static_cast<Eigen::Index>(a)], view(driving),
                                   controls.shares[a]);
    return driving;
}

void Equilibrium::fill_residual(const Balance& balance, Evaluation& e) const {
    e.out_of_balance = balance.internal + balance.driving;
    const double unbalanced = restrict_to_free(e.out_of_balance).norm();
    const double balancing = std::max({balance.internal.norm(), balance.driving.norm(), force_floor_});
    e.residual = relative_residual(unbalanced, balancing, force_rounding_);
}

double Equilibrium::potential_energy(const State& state, const Controls& controls) const {
    Controls still = controls;
    still.friction = nullptr;
    double springs = 0;
    for (const SpringPath& spring : springs_) springs += spring.energy(view(state.x));
    for (const AffineBody& object : objects()) springs += object.energy(view(state.x));
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        JointDrive drive = joint_drive(controls, j);
        drive.dt = 0;  // damping stores no energy
        springs += joints_[j].energy(view(state.x), drive);
    }
    for (const Actuator& actuator : actuators_) {
        if (actuator.gaps() != nullptr) springs += actuator.gaps()->energy(view(state.x));
    }
    if (fluid_) {
        const Eigen::Vector3d gravity = gravity_at(controls.time);
        springs += fluid_->buoyancy_energy(with_obstacles(state.x, {}), gravity) -
                   fluid_->buoyancy_energy(with_obstacles(rest_, {}), gravity);
    }
    return model_->elements().evaluate(view(state.x), {}).energy_J + springs -
           controls.external_N.dot(state.x - rest_) + contact_energy(state.x, still);
}

JointDrive Equilibrium::joint_drive(const Controls& controls, std::size_t joint) const {
    const bool in_time = controls.inertia && !controls.inertia->is_tether();
    return {controls.joint_wanted[joint], controls.joint_start.empty() ? 0 : controls.joint_start[joint],
            in_time ? controls.inertia->dt() : 0};
}

std::vector<double> Equilibrium::joint_coordinates(const Eigen::VectorXd& x, const Controls& controls) const {
    std::vector<double> all;
    for (std::size_t j = 0; j < joints_.size(); ++j)
        all.push_back(joints_[j].coordinate(view(x), joint_drive(controls, j).start));
    return all;
}

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
    const Eigen::Vector3d gravity = gravity_at(controls.time);
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
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(controls.obstacles.size());
    return contact->largest_step(with_obstacles(x, controls.obstacles),
                                 with_obstacles(motion, obstacle_motion.size() > 0 ? obstacle_motion : none));
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
            add_pairs_at(on_the_way(state, *controls.inertia, at.share).x);
    }
    if (controls.friction) {
        for (const contact::FrozenPair& pair : controls.friction->pairs())
            add({pair.nodes.data(), static_cast<std::size_t>(pair.node_count)});
    }
    return cliques;
}

TangentLayout Equilibrium::lay_out_tangent(const std::vector<std::vector<int>>& touching, TangentNodes nodes) const {
    const std::vector<int>& index = index_of(nodes);
    auto cliques = model_->elements().cliques(index);
    append_cliques_beside_tets(index, touching, cliques);
    const bool all = nodes == TangentNodes::all;
    TangentLayout layout{
        linalg::make_pattern(all ? model_->node_count() : model_->free_count(), 3, cliques), {}, nodes};
    const Eigen::VectorXd rest = all ? rest_ : free_positions(rest_);
    for (Eigen::Index k = 0; k < rest.size(); k += 3)
        layout.pattern.points.push_back({rest[k], rest[k + 1], rest[k + 2]});
    layout.element_sums = model_->elements().block_sums(index, layout.pattern);
    return layout;
}

void Equilibrium::append_cliques_beside_tets(const std::vector<int>& index,
                                             const std::vector<std::vector<int>>& touching,
                                             linalg::Lists& cliques) const {
    for (const Actuator& actuator : actuators_) actuator.append_cliques(index, cliques);
    for (const Plate& plate : plates_) plate.append_clique(index, cliques);
    for (const AffineBody& object : objects()) object.append_clique(index, cliques);
    for (const SpringPath& spring : springs_) spring.append_clique(index, cliques);
    for (const JointForce& joint : joints_) joint.append_clique(index, cliques);
    for (const TorqueForces& torque : torques_) torque.append_clique(index, cliques);
    if (fluid_) {
        for (const auto& triangle : fluid_->skin()) {
            std::vector<int> clique;
            for (const int& corner : triangle) {
                for (const int node : model_->object_points().carriers(corner))
                    clique.push_back(index[static_cast<std::size_t>(node)]);
            }
            std::ranges::sort(clique);
            clique.erase(std::unique(clique.begin(), clique.end()), clique.end());
            cliques.push_back(clique);
        }
    }
    for (const std::vector<int>& clique : touching) cliques.push_back(clique);
}

TangentLayout Equilibrium::lay_out_tangent_beside_tets(const std::vector<std::vector<int>>& touching) const {
    linalg::Lists cliques;
    append_cliques_beside_tets(all_nodes_, touching, cliques);
    return {linalg::make_pattern(model_->node_count(), 3, cliques), {}, TangentNodes::all};
}

void Equilibrium::add_tangent_at(const State& state, const Controls& controls, const TangentLayout& layout,
                                 std::span<double> values, bool project, TangentParts parts) const {
    model_->elements().add_tangent(view(state.x), layout.element_sums, values, project);
    add_tangent_beside_tets(state, controls, layout, values, project, parts);
}

/// The derivative of the force at share s of the path with respect to the end is s times the tangent there.
void Equilibrium::add_tangent(const State& state, const Controls& controls, const TangentLayout& layout,
                              std::span<double> values, bool project, TangentParts parts) const {
    const Inertia* inertia = controls.inertia.get();
    if (inertia != nullptr && !inertia->means().empty()) {
        for (const Inertia::Mean& at : inertia->means()) {
            std::vector<double> there(values.size(), 0.0);
            add_tangent_at(on_the_way(state, *inertia, at.share), controls, layout, there, project, parts);
            for (std::size_t k = 0; k < values.size(); ++k) values[k] += at.weight * at.share * there[k];
        }
    } else {
        add_tangent_at(state, controls, layout, values, project, parts);
    }
    if (inertia != nullptr) {
        inertia->add_hessian(layout.element_sums, index_of(layout.nodes), layout.pattern, values);
        if (fluid_) add_drag_tangent(state.x, controls, *inertia, layout, values);
    }
    if (layout.nodes == TangentNodes::free) decouple_rollers(layout.pattern, values);
}

void Equilibrium::add_tangent_beside_tets(const State& state, const Controls& controls, const TangentLayout& layout,
                                          std::span<double> values, bool project, TangentParts parts) const {
    const linalg::SymmetricPattern& pattern = layout.pattern;
    const std::vector<int>& index = index_of(layout.nodes);
    for (const Plate& plate : plates_) plate.add_hessian(view(state.x), index, pattern, values);
    for (const AffineBody& object : objects()) object.add_hessian(view(state.x), index, pattern, values, project);
    for (const SpringPath& spring : springs_) spring.add_hessian(view(state.x), index, pattern, values, project);
    for (std::size_t j = 0; j < joints_.size(); ++j)
        joints_[j].add_hessian(view(state.x), joint_drive(controls, j), index, pattern, values, project);
    for (std::size_t k = 0; k < torques_.size(); ++k)
        torques_[k].add_tangent(view(state.x), controls.torque_Nm[k], TorqueForces::Part::symmetric, index, pattern,
                                values);
    if (fluid_) {
        const std::vector<double> all = with_obstacles(state.x, {});
        visit_carried(layout, values, [&](const contact::BlockVisitor& visit) {
            fluid_->visit_buoyancy(all, gravity_at(controls.time), project, visit);
        });
    }
    const contact::Contact* contact = parts == TangentParts::all ? this->contact(controls) : nullptr;
    if (contact != nullptr) {
        const std::vector<double> x = with_obstacles(state.x, controls.obstacles);
        const contact::BlockVisitor add = [&](int a, int b, const linalg::Matrix3& block) {
            const int i = index[static_cast<std::size_t>(a)];
            const int j = index[static_cast<std::size_t>(b)];
            if (j >= 0 && i >= j) pattern.add_block(values, i, j, [&](int r, int c) { return block(r, c); });
        };
        const contact::BlockVisitor add_carried = [&](int a, int b, const linalg::Matrix3& block) {
            model_->object_points().visit_block(a, b, block, add);
        };
        contact->visit_hessian(contact->find(x), x, project, add_carried);
        if (controls.friction) controls.friction->visit_hessian(x, add_carried);
    }
    for (std::size_t a = 0; a < actuators_.size(); ++a) {
        const double multiplier = state.multiplier[static_cast<Eigen::Index>(a)];
        if (multiplier != 0 || actuators_[a].gaps() != nullptr)
            actuators_[a].add_hessian(view(state.x), multiplier, index, pattern, values, project, controls.shares[a]);
    }
}

void Equilibrium::add_skew(const State& state, const Controls& controls, const TangentLayout& layout,
                           std::span<double> values) const {
    const std::vector<int>& index = index_of(layout.nodes);
    for (std::size_t k = 0; k < torques_.size(); ++k)
        torques_[k].add_tangent(view(state.x), controls.torque_Nm[k], TorqueForces::Part::skew, index, layout.pattern,
                                values);
    model_->elements().add_skew(view(state.x), index, layout.pattern, values);
    std::vector<std::size_t> patches = skew_;
    if (layout.nodes == TangentNodes::all) {  // if its rim is held, it affects the forces on other nodes
        const std::size_t first = cable_count() + model_->description().chambers.size();
        patches.resize(actuators_.size() - first);
        std::iota(patches.begin(), patches.end(), first);
    }
    for (const std::size_t a : patches)
        actuators_[a].add_skew(view(state.x), state.multiplier[static_cast<Eigen::Index>(a)], index, layout.pattern,
                               values);
}

void Equilibrium::decouple_rollers(const linalg::SymmetricPattern& pattern, std::span<double> values) const {
    if (rollers_.empty()) return;
    std::vector<const Eigen::Matrix3d*> may_move(static_cast<std::size_t>(pattern.nodes), nullptr);
    for (const FreeRoller& roller : rollers_) may_move[static_cast<std::size_t>(roller.free)] = &roller.may_move;
    const auto decouple = [&](std::size_t i, std::size_t j, double* entries) {
        if (may_move[i] == nullptr && may_move[j] == nullptr) return;
        Eigen::Map<Eigen::Matrix3d> block(entries);
        const double stiffness = std::fabs(block.trace()) / 3;
        if (may_move[i] != nullptr) block = (*may_move[i] * block).eval();
        if (may_move[j] != nullptr) block = (block * *may_move[j]).eval();
        if (i == j) block += stiffness * (Eigen::Matrix3d::Identity() - *may_move[j]);
    };
    parallel_for(may_move.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j) {
            for (int k = pattern.node_start[j]; k < pattern.node_start[j + 1]; ++k)
                decouple(static_cast<std::size_t>(pattern.node_row[static_cast<std::size_t>(k)]), j,
                         values.data() + 9 * static_cast<std::size_t>(k));
        }
    });
}

Eigen::VectorXd Equilibrium::apply_skew(const State& state, const Eigen::VectorXd& v) const {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(state.x.size());
    add_free(v, 1, motion);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(state.x.size());
    for (const std::size_t a : skew_) {
        const double multiplier = state.multiplier[static_cast<Eigen::Index>(a)];
        actuators_[a].apply_skew(view(state.x), multiplier, view(std::as_const(motion)), view(result));
    }
    return restrict_to_free(result);
}

Eigen::VectorXd Equilibrium::restrict_to_free(const Eigen::VectorXd& full) const {
    Eigen::VectorXd free = free_positions(full);
    for (const FreeRoller& roller : rollers_)
        free.segment<3>(3 * roller.free) = (roller.may_move * free.segment<3>(3 * roller.free)).eval();
    return free;
}

Eigen::VectorXd Equilibrium::free_positions(const Eigen::VectorXd& full) const {
    Eigen::VectorXd free(3 * model_->free_count());
    const auto& index = model_->free_index();
    for (std::size_t node = 0; node < index.size(); ++node) {
        if (index[node] >= 0) free.segment<3>(3 * index[node]) = full.segment<3>(3 * static_cast<Eigen::Index>(node));
    }
    return free;
}

void Equilibrium::add_free(const Eigen::VectorXd& free, double factor, Eigen::VectorXd& full) const {
    const auto& index = model_->free_index();
    for (std::size_t node = 0; node < index.size(); ++node) {
        if (index[node] < 0) continue;
        full.segment<3>(3 * static_cast<Eigen::Index>(node)) += factor * free.segment<3>(3 * index[node]);
    }
    for (const FreeRoller& roller : rollers_) {
        const Eigen::Vector3d motion = free.segment<3>(3 * roller.free);
        full.segment<3>(3 * roller.node) -= factor * (motion - roller.may_move * motion);
    }
}

}  // namespace pliant::sim

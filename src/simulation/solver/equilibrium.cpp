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
#include "simulation/solver/wetted_skin.hpp"

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

/// Rounding errors of the forces of inertia, N: in very short steps they exceed what can be balanced.
double inertia_rounding(const Model& model, const Inertia& inertia, const Eigen::VectorXd& x) {
    const auto& mass_kg = model.elements().node_mass_kg();
    double squared = 0;
    for (std::size_t node = 0; node < mass_kg.size(); ++node)
        squared += mass_kg[node] * mass_kg[node] * x.segment<3>(3 * static_cast<Eigen::Index>(node)).squaredNorm();
    return 2e-16 * inertia.rate() * inertia.rate() * std::sqrt(squared);
}

/// Whether a cable is let go on the way from one drive to another. Where the drive stays, so does the direction of the
/// last change, which the tensions show: `shares` frozen before, that of the pulled end being 1; without any it pulls.
bool lets_go(const Cable& cable, const std::vector<double>& shares, const Drive& before, const Drive& wanted) {
    constexpr double rounding = 1e-12;
    const double change = wanted.value - before.value;
    const double largest = std::max(std::fabs(wanted.value), std::fabs(before.value));
    if (wanted.kind == before.kind && std::fabs(change) > rounding * largest)
        return wanted.kind == Drive::Kind::measure ? change > 0 : change < 0;
    return !shares.empty() && (cable.pulled_at_first ? shares.back() : shares.front()) > 1;
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
        if (!rim_is_held(d.pressures[k].wall)) skew_.push_back(d.steered_count() + k);
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
    // A motor that turns a thing which nothing resists ends without any force: so small an opening of its joint is
    // none.
    constexpr double negligible_opening = 1e-7;
    for (const Joint& joint : d.joints) {
        joints_.emplace_back(joint);
        force_floor_ += negligible_opening * joint.stiffness_N_m * joint.arm_m;
        energy_rounding_ += 1e-16 * joint.stiffness_N_m * joint.arm_m * joint.arm_m;
    }
    // Rounding moves a node by a fraction of its coordinate, which causes a force of that times a tet's stiffness times
    // its size.
    const double size = std::cbrt(volume / static_cast<double>(d.mesh.tet_count()));
    const double farthest = rest_.cwiseAbs().maxCoeff();
    force_rounding_ = 1e-16 * stiffest * farthest * size * std::sqrt(static_cast<double>(n));
    // Rigid things are stiffer: plates, objects, with four nodes each, and joints.
    for (const Plate& plate : plates_)
        force_rounding_ +=
            1e-16 * plate.stiffness_N_m() * farthest * std::sqrt(static_cast<double>(plate.node_count()));
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
    skin.triangles = wetted(d.fluid->skin, view(std::as_const(rest_)), model_->held());
    fluid_.emplace(*d.fluid, model_->object_points().with_objects(std::move(skin), d.objects).triangles);
}

FluidForces::Gravity Equilibrium::gravity_at(double time) const {
    const Description& d = model_->description();
    return {linalg::vector(d.gravity_m_s2), d.gravity_share.at(time)};
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
        const bool by_length = wanted.kind == Drive::Kind::measure;
        const CablePath& path = actuators_[c].cable();
        const double friction =
            lets_go(cables[c], controls.shares[c], before[c], wanted) ? -cables[c].friction : cables[c].friction;
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
    Evaluation e = controls.of_means() ? evaluate_mean(state, controls, balance)
                                       : evaluate_at(state, controls, controls.inertia.get(), balance);
    if (!e.possible()) return e;
    fill_residual(balance, e);
    if (controls.inertia && e.residual > 0 &&
        restrict_to_free(e.out_of_balance).norm() <= inertia_rounding(*model_, *controls.inertia, state.x))
        e.residual = 0;
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
        const Evaluation e =
            evaluate_at({inertia.on_path(state.x, at.share), state.multiplier}, controls, nullptr, here);
        if (!e.possible()) return e;
        mean.min_J = std::min(mean.min_J, e.min_J);
        mean.energy_J += at.weight / at.share * e.energy_J;
        mean.multiplier += at.weight * e.multiplier;
        balance.internal += at.weight * here.internal;
        balance.driving += at.weight * here.driving;
    }
    for (std::size_t k = 0; k < objects().size(); ++k) {
        const Eigen::VectorXd& start = inertia.start().x;
        mean.energy_J += objects()[k].mean_energy(view(start), view(state.x), controls.object_stress[k]);
        objects()[k].add_mean_gradient(view(start), view(state.x), controls.object_stress[k], view(balance.internal));
    }
    mean.energy_J += inertia.evaluate(state.x, balance.internal);
    if (fluid_) add_drag(state.x, controls, inertia, balance.internal, mean.energy_J);
    return mean;
}

std::vector<linalg::Matrix3> Equilibrium::object_stress(const Eigen::VectorXd& start, const Eigen::VectorXd& x) const {
    std::vector<linalg::Matrix3> stress;
    for (const AffineBody& object : objects()) stress.push_back(object.mean_stress(view(start), view(x)));
    return stress;
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
    if (!controls.of_means()) {  // else theirs is not a mean along the path
        for (const AffineBody& object : objects()) {
            e.energy_J += object.energy(view(state.x));
            object.add_gradient(view(state.x), view(internal));
        }
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
        const FluidForces::Gravity gravity = gravity_at(controls.time);
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

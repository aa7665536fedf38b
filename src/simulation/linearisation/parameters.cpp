#include "simulation/linearisation/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/actuators/torque.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/linearisation/contact_forces.hpp"
#include "simulation/linearisation/damping_stiffness.hpp"
#include "simulation/linearisation/element_derivatives.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::sim {
namespace {

using Kind = Parameter::Kind;

using linalg::view;

Derivative nothing(const Linearisation& at) {
    return {Eigen::VectorXd::Zero(at.size()),
            {Eigen::VectorXd::Zero(at.state().x.size()), Eigen::VectorXd::Zero(at.state().multiplier.size())}};
}

/// Derivative for a force (3n), or with the nodes of obstacles, added to the out-of-balance force.
Derivative by_force(const Linearisation& at, const Eigen::VectorXd& force) {
    Derivative by = nothing(at);
    const Eigen::VectorXd free = at.system().restrict_to_free(force.head(at.state().x.size()));
    by.equations.head(free.size()) = free;
    by.forces = force;
    return by;
}

Derivative by_motion(Linearisation& at, const Eigen::VectorXd& held) {
    Derivative by = nothing(at);
    by.equations = at.equations_of_motion(held);
    by.direct.positions = held;
    return by;
}

/// Derivative for the prescribed value in a multiplier's own equation.
Derivative by_wanted(const Linearisation& at, std::size_t actuator, double change) {
    Derivative by = nothing(at);
    const auto place = std::ranges::find(at.solved(), actuator) - at.solved().begin();
    const Eigen::Index first = at.size() - static_cast<Eigen::Index>(at.solved().size());
    if (!at.is_slack(actuator)) by.equations[first + place] = change;
    return by;
}

Derivative by_multiplier(const Linearisation& at, std::size_t actuator, double sign) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    at.system().actuators()[actuator].add_gradient(view(at.state().x), sign, view(force),
                                                   at.controls().shares[actuator]);
    Derivative by = by_force(at, force);
    by.direct.multipliers[static_cast<Eigen::Index>(actuator)] = sign;
    by.forces.resize(0);  // the force belongs to the multiplier
    return by;
}

/// (3n) nodal forces of a load at full share, in the direction of `total`.
Eigen::VectorXd spread(const Linearisation& at, const Load& load, const Eigen::Vector3d& total) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    for (std::size_t k = 0; k < load.nodes.size(); ++k) force.segment<3>(3 * load.nodes[k]) += load.shares[k] * total;
    return force;
}

/// (3n) minus the nodal forces of a torque on the nodes of a load.
Eigen::VectorXd torque_forces(const Linearisation& at, const TorqueLoad& load, const Eigen::Vector3d& torque_Nm) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    TorqueForces(load.nodes).subtract_from(view(at.state().x), torque_Nm, view(force));
    return force;
}

/// Relative stiffening rate of plate springs and objects as constants of a material change along `direction`.
double stiffness_rate(const Description& d, std::size_t material, const std::vector<double>& direction) {
    double stiffest = 0;
    for (const Material& one : d.materials) stiffest = std::max(stiffest, material::stiffness_bound(one.law));
    const material::Law& law = d.materials[material].law;
    if (material::stiffness_bound(law) < stiffest) return 0;
    const material::Moduli now = material::moduli(law), rate = material::moduli_rate(law, direction);
    return (3 * now.bulk_Pa >= 2 * now.shear_Pa ? 3 * rate.bulk_Pa : 2 * rate.shear_Pa) / stiffest;
}

/// Adds the forces of everything whose stiffness follows the stiffest material.
void add_stiff_force(const Linearisation& at, double factor, Eigen::VectorXd& force) {
    if (factor == 0) return;
    Eigen::VectorXd stiff = Eigen::VectorXd::Zero(force.size());
    for (const Plate& plate : at.system().plates()) plate.add_gradient(view(at.state().x), view(stiff));
    for (const AffineBody& object : at.system().objects()) object.add_gradient(view(at.state().x), view(stiff));
    force += factor * stiff;
}

bool has_stiff_parts(const Equilibrium& system) {
    return !system.plates().empty() || !system.objects().empty();
}

/// (3n) forces of all masses under an acceleration.
Eigen::VectorXd weight(const Linearisation& at, const Eigen::Vector3d& acceleration) {
    const std::vector<double>& mass = at.system().model().elements().node_mass_kg();
    Eigen::VectorXd force(at.state().x.size());
    for (std::size_t node = 0; node < mass.size(); ++node)
        force.segment<3>(3 * static_cast<Eigen::Index>(node)) = mass[node] * acceleration;
    return force;
}

Derivative by_obstacle_share(const Linearisation& at, std::size_t obstacle) {
    const contact::Contact& contact = *at.system().model().contact(true);
    const Eigen::Index robot = at.state().x.size();
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(robot + 3 * obstacle_nodes(at.system()));
    const Vec3& move = at.system().model().description().contact->obstacles[obstacle].move_m;
    for (int node = contact.first_node(obstacle); node < contact.first_node(obstacle + 1); ++node)
        motion.segment<3>(robot + 3 * Eigen::Index{node - contact.robot_node_count()}) = linalg::vector(move);
    return by_force(at, contact_stiffness_times(at.system(), at.state(), at.controls(), motion));
}

Derivative by_law(const Linearisation& at, const Parameter& by) {
    const Description& d = at.system().model().description();
    const material::Law& law = d.materials[by.index].law;
    const std::vector<double> direction = material::parameters(law)[by.part].direction;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    const Elements& elements = at.system().model().elements();
    const Eigen::MatrixXd constants = constants_of_tets(elements, by.index, direction);
    add_law_force(elements, constants, at.state().x, force);
    if (const auto damped = damped_step(at)) add_damping_law_force(*damped, constants, force);
    add_stiff_force(at, stiffness_rate(d, by.index, direction), force);
    return by_force(at, force);
}

Derivative by_density(const Linearisation& at, std::size_t material) {
    const Description& d = at.system().model().description();
    const Elements& elements = at.system().model().elements();
    Eigen::VectorXd density = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(elements.tet_count()));
    for (std::size_t t = 0; t < elements.tet_count(); ++t)
        density[static_cast<Eigen::Index>(t)] = elements.material(t) == static_cast<int>(material) ? 1 : 0;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    add_density_force(elements, masses_at(d, at.controls(), at.state().x), density, force);
    return by_force(at, force);
}

Derivative by_spring(const Linearisation& at, const Parameter& by) {
    const Description& d = at.system().model().description();
    const SpringPath& path = at.system().springs()[by.index];
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    const double pull = path.force(view(at.state().x)), stiffness = d.springs[by.index].stiffness_N_m;
    const bool slack = d.springs[by.index].only_pulls && !(pull > 0);
    const double rate = by.kind == Kind::spring_stiffness ? pull / stiffness : -stiffness;
    if (!slack) path.add_length_gradient(view(at.state().x), rate, view(force));
    return by_force(at, force);
}

/// The shares s = exp(-f a) of a cable with friction have ds/df = s log(s) / f. The prescribed weighted length changes
/// just as the weighted length does, once the cable has its prescribed length.
Derivative by_cable_friction(const Linearisation& at, const Parameter& by) {
    std::vector<double> rates = at.controls().shares[by.index];
    for (double& share : rates) share *= std::log(share) / by.value;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    const double tension = at.state().multiplier[static_cast<Eigen::Index>(by.index)];
    if (!rates.empty()) at.system().actuators()[by.index].add_gradient(view(at.state().x), tension, view(force), rates);
    return by_force(at, force);
}

/// All contact forces, including friction, are proportional to the contact stiffness.
Derivative by_contact_stiffness(const Linearisation& at, double stiffness_Pa) {
    const ContactForces forces = contact_forces(at.system(), at.state(), at.controls());
    return by_force(at, (forces.pressure + forces.friction) / stiffness_Pa);
}

/// True if the coefficient applies to a pair.
bool is_coefficient_of(const contact::Contact& contact, const contact::FrozenPair& pair, const Parameter& p) {
    const auto nodes = std::span(pair.nodes).first(static_cast<std::size_t>(pair.node_count));
    const contact::FrictionOwner owner = contact.friction_owner(nodes, pair.obstacle);
    const auto index = static_cast<int>(p.index);
    if (p.kind == Kind::object_friction) return owner.rigid == index;
    if (p.kind == Kind::obstacle_friction) return owner.obstacle == index;
    return owner.obstacle < 0 && owner.rigid < 0;
}

/// For friction against one obstacle or object, or of the robot against itself.
Derivative by_friction(const Linearisation& at, const Parameter& by) {
    const Controls& controls = at.controls();
    Eigen::VectorXd force = Eigen::VectorXd::Zero(force_size(at.system()));
    if (!controls.friction) return by_force(at, force);
    const contact::Contact& contact = *at.system().model().contact(controls.met);
    const std::span<const contact::FrozenPair> all = controls.friction->pairs();
    std::vector<contact::FrozenPair> pairs(all.begin(), all.end());
    for (contact::FrozenPair& pair : pairs) pair.limit_N *= is_coefficient_of(contact, pair, by) ? 1 / by.value : 0;
    const std::span<const double> start = controls.friction->start();
    Controls with_those = controls;
    with_those.friction = std::make_shared<const contact::Friction>(
        std::move(pairs), std::vector<double>(start.begin(), start.end()), controls.friction->slip_m());
    return by_force(at, contact_forces(at.system(), at.state(), with_those).friction);
}

/// For the forces along a joint's coordinate. A change of U' is a force along the coordinate's gradient.
Derivative by_joint(const Linearisation& at, const Parameter& by) {
    const JointForce& joint = at.system().joints()[by.index];
    const JointDrive drive = at.system().joint_drive(at.controls(), by.index);
    const std::span<const double> x = view(at.state().x);
    const double place = joint.coordinate(x, drive.start);
    double rate = joint.slope_by_wanted();
    if (by.kind == Kind::joint_stiffness) rate = place - at.system().model().description().joints[by.index].law.rest;
    if (by.kind == Kind::joint_damping) rate = drive.dt > 0 ? (place - drive.start) / drive.dt : 0;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    joint.add_coordinate_gradient(x, rate, view(force));
    return by_force(at, force);
}

/// For an object's mass, a quarter of which is at each of its nodes, or for a [[mass]].
Derivative by_lump(const Linearisation& at, const Parameter& by) {
    const Description& d = at.system().model().description();
    const Masses masses = masses_at(d, at.controls(), at.state().x);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    const auto add = [&](std::span<const int> nodes, std::span<const double> weights, double mass) {
        Eigen::Vector3d needed = masses.weight;
        for (std::size_t a = 0; masses.acceleration.size() > 0 && a < nodes.size(); ++a)
            needed += weights[a] * masses.acceleration.segment<3>(3 * nodes[a]);
        for (std::size_t a = 0; a < nodes.size(); ++a) force.segment<3>(3 * nodes[a]) += mass * weights[a] * needed;
    };
    constexpr double all_of_it = 1;
    if (by.kind == Kind::point_mass) {
        for (const PointMass& point : points_of_mass(d, by.index))
            add(point.point.nodes, point.point.weights, point.mass_kg / by.value);
    } else {
        for (const int node : d.objects[by.index].nodes) add({&node, 1}, {&all_of_it, 1}, 0.25);
    }
    return by_force(at, force);
}

Derivative by_ambient_pressure(const Linearisation& at) {
    Derivative by = nothing(at);
    const Eigen::Index first = at.size() - static_cast<Eigen::Index>(at.solved().size());
    for (std::size_t k = 0; k < at.solved().size(); ++k) {
        const std::size_t a = at.solved()[k];
        const Drive& drive = at.controls().drives[a];
        if (drive.kind != Drive::Kind::gas) continue;
        by.equations[first + static_cast<Eigen::Index>(k)] =
            at.system().gas_compliance(drive, at.state().multiplier[static_cast<Eigen::Index>(a)]);
    }
    return by;
}

Derivative by_gap_weight(const Linearisation& at, std::size_t growth) {
    const auto& growths = at.system().model().description().growths;
    const auto cable = static_cast<std::size_t>(growths[growth].actuator);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    at.system().actuators()[cable].gaps()->add_weight_force(
        view(at.state().x), at.state().multiplier[static_cast<Eigen::Index>(cable)], growth, view(force));
    return by_force(at, force);
}

/// Damping forces are proportional to the coefficient.
Derivative by_damping(const Linearisation& at, bool by_mass) {
    const Inertia& inertia = *at.controls().inertia;
    const Eigen::VectorXd velocity = inertia.damped_velocity(at.state().x);
    return by_force(at, by_mass ? inertia.mass_times(velocity) : inertia.stiffness_times(velocity));
}

bool is_of_support(Kind kind) {
    return kind == Kind::support_share || kind == Kind::support_move || kind == Kind::support_angle;
}

/// The motion (3n) of held nodes per unit of a number of a support.
Eigen::VectorXd support_motion(const Linearisation& at, const Parameter& by) {
    const Description& d = at.system().model().description();
    const Support& support = d.supports[by.index];
    const double share = at.controls().support_share[by.index];
    const std::vector<Vec3>& rest = at.system().model().mesh().points;
    return at.system().model().held().motion([&](std::size_t s, int node) -> Eigen::Vector3d {
        if (s != by.index) return Eigen::Vector3d::Zero();
        const Vec3& p = rest[static_cast<std::size_t>(node)];
        if (by.kind == Kind::support_share) return linalg::vector(support.velocity(p, share));
        if (by.kind == Kind::support_angle) return linalg::vector(support.arc(p, share));
        return share * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(by.part));
    });
}

/// Product of adjoint weights with the forces of everything whose stiffness follows the stiffest material.
double stiff_product(const Linearisation& at, const Adjoint& adjoint) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    add_stiff_force(at, 1, force);
    return at.force_weights(adjoint).head(force.size()).dot(force);
}

/// Sums over all tets of each material.
struct Sums {
    Eigen::MatrixXd constants;  ///< (constants, materials)
    Eigen::VectorXd density;    ///< (materials)
};
Sums sums_of(const Elements& elements, std::size_t materials, const TetDerivatives& tets) {
    Sums sums{Eigen::MatrixXd::Zero(tets.constants.rows(), static_cast<Eigen::Index>(materials)),
              Eigen::VectorXd::Zero(static_cast<Eigen::Index>(materials))};
    for (Eigen::Index t = 0; t < tets.density.size(); ++t) {
        const int material = elements.material(static_cast<std::size_t>(t));
        sums.constants.col(material) += tets.constants.col(t);
        sums.density[material] += tets.density[t];
    }
    return sums;
}

}  // namespace

Derivative derivative(Linearisation& at, const Parameter& by) {
    const Description& d = at.system().model().description();
    const double time = at.controls().time;
    const auto axis = [&] { return Eigen::Vector3d(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(by.part))); };
    switch (by.kind) {
        case Kind::length:
            return by_wanted(at, by.index, -weighted_share(at, by.index));
        case Kind::volume:
            return by_wanted(at, by.index, -1);
        case Kind::gas:
            return by_wanted(at, by.index,
                             -1 / (d.ambient_pressure_Pa - at.state().multiplier[static_cast<Eigen::Index>(by.index)]));
        case Kind::tension:
            return by_multiplier(at, by.index, 1);
        case Kind::pressure:
            return by_multiplier(at, by.index, -1);
        case Kind::support_share:
        case Kind::support_move:
        case Kind::support_angle:
            return by_motion(at, support_motion(at, by));
        case Kind::load_share:
            return by_force(at, -spread(at, d.loads[by.index], linalg::vector(d.loads[by.index].force_N)));
        case Kind::gravity_share:
            return by_force(at, -weight(at, linalg::vector(d.gravity_m_s2)));
        case Kind::obstacle_share:
            return by_obstacle_share(at, by.index);
        case Kind::law:
            return by_law(at, by);
        case Kind::density:
            return by_density(at, by.index);
        case Kind::spring_stiffness:
        case Kind::spring_free_length:
            return by_spring(at, by);
        case Kind::cable_friction:
            return by_cable_friction(at, by);
        case Kind::load_force:
            return by_force(at, -d.loads[by.index].share.at(time) * spread(at, d.loads[by.index], axis()));
        case Kind::load_torque:
            return by_force(at, d.torques[by.index].share.at(time) * torque_forces(at, d.torques[by.index], axis()));
        case Kind::load_pressure: {
            const std::size_t first = d.steered_count();
            return by_multiplier(at, first + by.index, -d.pressures[by.index].share.at(time));
        }
        case Kind::gravity:
            return by_force(at, -d.gravity_share.at(time) * weight(at, axis()));
        case Kind::ambient_pressure:
            return by_ambient_pressure(at);
        case Kind::contact_stiffness:
            return by_contact_stiffness(at, by.value);
        case Kind::self_friction:
        case Kind::obstacle_friction:
        case Kind::object_friction:
            return by_friction(at, by);
        case Kind::object_mass:
        case Kind::point_mass:
            return by_lump(at, by);
        case Kind::joint_wanted:
        case Kind::joint_stiffness:
        case Kind::joint_damping:
            return by_joint(at, by);
        case Kind::gap_weight:
            return by_gap_weight(at, by.index);
        case Kind::mass_damping:
        case Kind::stiffness_damping:
            return by_damping(at, by.kind == Kind::mass_damping);
    }
    return nothing(at);
}

TetDerivatives tet_derivatives(const Linearisation& at, const Adjoint& adjoint) {
    const Description& d = at.system().model().description();
    const Elements& elements = at.system().model().elements();
    const Eigen::VectorXd weights = at.force_weights(adjoint).head(at.state().x.size());
    TetDerivatives by{law_products(elements, d, at.state().x, weights),
                      density_products(elements, masses_at(d, at.controls(), at.state().x), weights)};
    if (const auto damped = damped_step(at)) add_damping_law_products(*damped, weights, by.constants);
    return by;
}

Eigen::VectorXd derivatives(Linearisation& at, const Adjoint& adjoint, std::span<const Parameter> by) {
    const auto of_material = [](const Parameter& p) { return p.kind == Kind::law || p.kind == Kind::density; };
    if (std::ranges::none_of(by, of_material)) return derivatives(at, adjoint, by, {});
    return derivatives(at, adjoint, by, tet_derivatives(at, adjoint));
}

Eigen::VectorXd derivatives(Linearisation& at, const Adjoint& adjoint, std::span<const Parameter> by,
                            const TetDerivatives& tets) {
    const Description& d = at.system().model().description();
    const Sums of = sums_of(at.system().model().elements(), d.materials.size(), tets);
    const auto moves = [](const Parameter& p) { return is_of_support(p.kind); };
    const Eigen::VectorXd held =
        std::ranges::any_of(by, moves)
            ? Eigen::VectorXd(adjoint.quantity.by_positions - at.held_motion_weights(adjoint.weights))
            : Eigen::VectorXd();
    std::optional<double> stiff;
    Eigen::VectorXd all(static_cast<Eigen::Index>(by.size()));
    for (std::size_t k = 0; k < by.size(); ++k) {
        double& result = all[static_cast<Eigen::Index>(k)];
        const auto owner = static_cast<Eigen::Index>(by[k].index);
        if (by[k].kind == Kind::density) {
            result = of.density[owner];
        } else if (is_of_support(by[k].kind)) {
            result = held.dot(support_motion(at, by[k]));
        } else if (by[k].kind != Kind::law) {
            result = adjoint.derivative(derivative(at, by[k]));
        } else {
            const std::vector<double> direction =
                material::parameters(d.materials[by[k].index].law)[by[k].part].direction;
            result = 0;
            for (std::size_t c = 0; c < direction.size(); ++c)
                result += direction[c] * of.constants(static_cast<Eigen::Index>(c), owner);
            const double stiffer = stiffness_rate(d, by[k].index, direction);
            if (stiffer == 0 || !has_stiff_parts(at.system())) continue;
            if (!stiff) stiff = stiff_product(at, adjoint);
            result += stiffer * *stiff;
        }
    }
    return all;
}

}  // namespace pliant::sim

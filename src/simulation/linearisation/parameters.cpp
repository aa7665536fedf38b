#include "simulation/linearisation/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

using Kind = Parameter::Kind;

std::span<const double> view(const Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}
std::span<double> view(Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}

/// Weighted over true length of a cable; 1 without friction.
double weighted_share(const Linearisation& at, std::size_t cable) {
    const Actuator& actuator = at.system().actuators()[cable];
    const std::vector<double>& shares = at.controls().shares[cable];
    return shares.empty() ? 1 : actuator.measure(view(at.state().x), shares) / actuator.measure(view(at.state().x));
}

Parameter drive_of(const Linearisation& at, std::size_t a) {
    const Description& d = at.system().model().description();
    const Drive& drive = at.controls().drives[a];
    const std::size_t chambers = d.cables.size(), pressures = chambers + d.chambers.size();
    if (a < chambers) {
        const std::string& name = d.cables[a].name;
        if (drive.kind == Drive::Kind::multiplier)
            return {Kind::tension, a, fmt::format("cable \"{}\": tension", name), "N", drive.value};
        return {Kind::length, a, fmt::format("cable \"{}\": length", name), "m", drive.value / weighted_share(at, a)};
    }
    if (a >= pressures)
        return {Kind::pressure, a, fmt::format("load \"{}\": pressure", d.pressures[a - pressures].name), "Pa",
                -drive.value};
    const std::string& name = d.chambers[a - chambers].name;
    switch (drive.kind) {
        case Drive::Kind::measure:
            return {Kind::volume, a, fmt::format("chamber \"{}\": volume", name), "m^3", drive.value};
        case Drive::Kind::multiplier:
            return {Kind::pressure, a, fmt::format("chamber \"{}\": pressure", name), "Pa", -drive.value};
        case Drive::Kind::gas:
            break;
    }
    return {Kind::gas, a, fmt::format("chamber \"{}\": gas", name), "J", drive.value};
}

Derivative nothing(const Linearisation& at) {
    return {Eigen::VectorXd::Zero(at.size()),
            {Eigen::VectorXd::Zero(at.state().x.size()), Eigen::VectorXd::Zero(at.state().multiplier.size())}};
}

/// Of a force (3n) that is added to the out-of-balance one.
Derivative by_force(const Linearisation& at, const Eigen::VectorXd& force) {
    Derivative by = nothing(at);
    const Eigen::VectorXd free = at.system().restrict_to_free(force);
    by.equations.head(free.size()) = free;
    return by;
}

Derivative by_motion(Linearisation& at, const Eigen::VectorXd& held) {
    Derivative by = nothing(at);
    by.equations = at.equations_of_motion(held);
    by.direct.positions = held;
    return by;
}

/// What is asked of a multiplier's own equation.
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
    return by;
}

Derivative by_support_share(Linearisation& at, std::size_t support) {
    const Description& d = at.system().model().description();
    const double share = at.controls().support_share[support];
    return by_motion(at, at.system().model().held().motion([&](std::size_t s, int node) -> Eigen::Vector3d {
        if (s != support) return Eigen::Vector3d::Zero();
        return linalg::vector(d.supports[s].velocity(d.mesh.points[static_cast<std::size_t>(node)], share));
    }));
}

/// (3n) of a load at its full share, in the direction of `total`.
Eigen::VectorXd spread(const Linearisation& at, const Load& load, const Eigen::Vector3d& total) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    for (std::size_t k = 0; k < load.nodes.size(); ++k) force.segment<3>(3 * load.nodes[k]) += load.shares[k] * total;
    return force;
}

/// (3n) of all masses under an acceleration.
Eigen::VectorXd weight(const Linearisation& at, const Eigen::Vector3d& acceleration) {
    const std::vector<double>& mass = at.system().model().elements().node_mass_kg();
    Eigen::VectorXd force(at.state().x.size());
    for (std::size_t node = 0; node < mass.size(); ++node)
        force.segment<3>(3 * static_cast<Eigen::Index>(node)) = mass[node] * acceleration;
    return force;
}

Derivative by_obstacle_share(const Linearisation& at, std::size_t obstacle) {
    const contact::Contact& contact = *at.system().model().contact(true);
    const int first = contact.robot_node_count();
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(at.controls().obstacles.size());
    const Vec3& move = at.system().model().description().contact->obstacles[obstacle].move_m;
    for (int node = contact.first_node(obstacle); node < contact.first_node(obstacle + 1); ++node)
        motion.segment<3>(3 * (node - first)) = linalg::vector(move);
    return by_force(at, at.system().obstacle_stiffness_times(at.state(), at.controls(), motion));
}

}  // namespace

std::vector<Parameter> inputs(const Linearisation& at) {
    const Description& d = at.system().model().description();
    const double time = at.controls().time;
    std::vector<Parameter> all;
    for (std::size_t a = 0; a < at.controls().drives.size(); ++a) all.push_back(drive_of(at, a));
    for (std::size_t s = 0; s < d.supports.size(); ++s) {
        if (d.supports[s].moves())
            all.push_back({Kind::support_share, s, fmt::format("fixed \"{}\": share of its motion", d.supports[s].name),
                           "", at.controls().support_share[s]});
    }
    for (std::size_t k = 0; k < d.loads.size(); ++k)
        all.push_back(
            {Kind::load_share, k, fmt::format("load \"{}\": share", d.loads[k].name), "", d.loads[k].share.at(time)});
    if (!(d.gravity_m_s2 == Vec3{}))
        all.push_back({Kind::gravity_share, 0, "gravity: share", "", d.gravity_share.at(time)});
    for (std::size_t k = 0; d.contact && k < d.contact->obstacles.size(); ++k) {
        const Obstacle& obstacle = d.contact->obstacles[k];
        if (!(obstacle.move_m == Vec3{}))
            all.push_back({Kind::obstacle_share, k,
                           fmt::format("obstacle \"{}\": share of its motion", obstacle.body.name), "",
                           obstacle.share.at(time)});
    }
    return all;
}

Derivative derivative(Linearisation& at, const Parameter& by) {
    const Description& d = at.system().model().description();
    const auto m = [&] { return at.state().multiplier[static_cast<Eigen::Index>(by.index)]; };
    switch (by.kind) {
        case Kind::length:
            return by_wanted(at, by.index, -weighted_share(at, by.index));
        case Kind::volume:
            return by_wanted(at, by.index, -1);
        case Kind::gas:
            return by_wanted(at, by.index, -1 / (d.ambient_pressure_Pa - m()));
        case Kind::tension:
            return by_multiplier(at, by.index, 1);
        case Kind::pressure:
            return by_multiplier(at, by.index, -1);
        case Kind::support_share:
            return by_support_share(at, by.index);
        case Kind::load_share:
            return by_force(at, -spread(at, d.loads[by.index], linalg::vector(d.loads[by.index].force_N)));
        case Kind::gravity_share:
            return by_force(at, -weight(at, linalg::vector(d.gravity_m_s2)));
        case Kind::obstacle_share:
            return by_obstacle_share(at, by.index);
    }
    return nothing(at);
}

}  // namespace pliant::sim

#include "simulation/gradient/measure.hpp"

#include <utility>
#include <vector>

#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/linearisation/contact_forces.hpp"
#include "simulation/linearisation/met_segments.hpp"

namespace pliant::sim {
namespace {

using Kind = Measure::Kind;
using linalg::view;

/// The state at which something is measured.
struct Place {
    const Equilibrium& system_;
    const State& state_;
    const Controls& controls_;
    [[nodiscard]] const Equilibrium& system() const { return system_; }
    [[nodiscard]] const State& state() const { return state_; }
    [[nodiscard]] const Controls& controls() const { return controls_; }
};

Slope nothing(const Place& at) {
    return no_slope(at.system());
}

/// The actuator that a measure refers to.
std::size_t actuator_of(const Description& d, const Measure& m) {
    const bool cable = m.kind == Kind::tension || m.kind == Kind::length || m.kind == Kind::length_ratio;
    return (cable ? 0 : d.cables.size()) + (m.pressure_load ? d.chambers.size() : 0) + m.index;
}

Slope of_point(const Place& at, const Attachment& point, const Vec3& direction) {
    Slope slope = nothing(at);
    slope.value = dot(position(point, view(at.state().x)), direction);
    for (std::size_t k = 0; k < point.nodes.size(); ++k)
        slope.state.by_positions.segment<3>(3 * point.nodes[k]) += point.weights[k] * linalg::vector(direction);
    return slope;
}

/// by_rest += derivative of the met length with respect to the rest shape, `factor` per unit of length.
void add_met_length(const Place& at, const CablePath& path, double factor, Slope& slope) {
    const MetSegments met(path, view(at.state().x));
    if (!met.any()) return;
    if (slope.by_rest.size() == 0) slope.by_rest = Eigen::VectorXd::Zero(at.state().x.size());
    const Eigen::VectorXd rest = at.system().rest().x;
    add_met_length_gradient(path, view(rest), factor * met.length_rate(), view(slope.by_rest));
}

/// Adds derivatives with respect to an actuator's measure, now and at rest.
void add_measure(const Place& at, std::size_t a, double by_now, double by_rest, Slope& slope) {
    at.system().actuators()[a].add_measure_gradient(view(at.state().x), by_now, view(slope.state.by_positions));
    slope.by_measures.push_back({a, by_now, by_rest});
    if (a < at.system().model().description().cables.size())
        add_met_length(at, at.system().actuators()[a].cable(), by_now, slope);
}

/// Length or volume, or its ratio to the rest value.
Slope of_measure(const Place& at, std::size_t a, bool ratio) {
    const Actuator& actuator = at.system().actuators()[a];
    const double now = actuator.measure(view(at.state().x)), rest = actuator.rest_measure();
    Slope slope = nothing(at);
    slope.value = ratio ? now / rest : now;
    add_measure(at, a, ratio ? 1 / rest : 1, ratio ? -now / (rest * rest) : 0, slope);
    return slope;
}

/// The multiplier or, with gap elements, the part that is left to pull.
Slope of_tension(const Place& at, std::size_t a) {
    Slope slope = nothing(at);
    slope.value = at.state().multiplier[static_cast<Eigen::Index>(a)];
    slope.state.by_multipliers[static_cast<Eigen::Index>(a)] = 1;
    const Actuator& actuator = at.system().actuators()[a];
    if (const GapElements* gaps = actuator.gaps()) {
        slope.value = gaps->tension(view(at.state().x), slope.value);
        actuator.add_gradient(view(at.state().x), gaps->tension_rate(), view(slope.state.by_positions));
        slope.by_rest = Eigen::VectorXd::Zero(at.state().x.size());
        gaps->add_tension_rest_gradient(at.system().model().elements(), view(at.state().x), 1, view(slope.by_rest));
        for (std::size_t k = 0; k < at.system().model().description().growths.size(); ++k) {
            if (gaps->has(k))
                slope.direct.push_back(
                    {{Parameter::Kind::gap_weight, k, "", "", 0, 0}, gaps->tension_by_weight(view(at.state().x), k)});
        }
    }
    return slope;
}

/// Minus the multiplier and, if air is meshed, the resistance of its elements.
Slope of_pressure(const Place& at, std::size_t a) {
    Slope slope = nothing(at);
    slope.value = 0 - at.state().multiplier[static_cast<Eigen::Index>(a)];
    slope.state.by_multipliers[static_cast<Eigen::Index>(a)] = -1;
    const Description& d = at.system().model().description();
    for (const Growth& growth : d.growths) {
        if (growth.actuator != static_cast<int>(a)) continue;
        const Actuator& actuator = at.system().actuators()[a];
        const double now = actuator.measure(view(at.state().x)), rest = actuator.rest_measure();
        slope.value -= growth.weight_Pa * (now / rest - 1);
        add_measure(at, a, -growth.weight_Pa / rest, growth.weight_Pa * now / (rest * rest), slope);
        break;
    }
    return slope;
}

/// The length of a spring, or its force. The free length counts as a number of its own; where none is given, the force
/// also follows the rest length, which it then is.
Slope of_spring(const Place& at, std::size_t s, bool force) {
    const SpringPath& path = at.system().springs()[s];
    const Spring& spring = at.system().model().description().springs[s];
    Slope slope = nothing(at);
    const double pull = path.force(view(at.state().x));
    slope.value = force ? pull : path.length(view(at.state().x));
    const bool slack = spring.only_pulls && !(pull > 0);
    if (force && slack) return slope;
    const double by_length = force ? spring.stiffness_N_m : 1;
    path.add_length_gradient(view(at.state().x), by_length, view(slope.state.by_positions));
    const Eigen::VectorXd rest = at.system().rest().x;
    add_met_length(at, CablePath(spring.points, view(rest)), by_length, slope);
    slope.by_springs.push_back({s, by_length, force && !spring.free_length_m ? -by_length : 0});
    if (!force) return slope;
    slope.direct.push_back({{Parameter::Kind::spring_stiffness, s, "", "", 0, 0}, pull / spring.stiffness_N_m});
    slope.direct.push_back({{Parameter::Kind::spring_free_length, s, "", "", 0, 0}, -spring.stiffness_N_m});
    if (spring.free_length_m) return slope;
    if (slope.by_rest.size() == 0) slope.by_rest = Eigen::VectorXd::Zero(at.state().x.size());
    path.add_length_gradient(view(rest), -spring.stiffness_N_m, view(slope.by_rest));
    return slope;
}

Slope of_reaction(const Place& at, std::size_t support, const Vec3& direction) {
    Slope slope = nothing(at);
    const Equilibrium& system = at.system();
    slope.state.by_forces = system.model().held().motion([&](std::size_t s, int) -> Eigen::Vector3d {
        return s == support ? linalg::vector(direction) : Eigen::Vector3d::Zero();
    });
    slope.value = slope.state.by_forces.dot(system.evaluate(at.state(), at.controls()).out_of_balance);
    return slope;
}

Slope of_contact(const Place& at, std::size_t obstacle, const Vec3& direction) {
    Slope slope = nothing(at);
    const contact::Contact& contact = *at.system().model().contact(true);
    slope.state.by_forces = Eigen::VectorXd::Zero(force_size(at.system()));
    const Eigen::Index first = at.system().model().node_count() - contact.robot_node_count();
    for (int node = contact.first_node(obstacle); node < contact.first_node(obstacle + 1); ++node)
        slope.state.by_forces.segment<3>(3 * (first + node)) = linalg::vector(direction);
    const ContactForces forces = contact_forces(at.system(), at.state(), at.controls());
    slope.value = slope.state.by_forces.dot(forces.pressure + forces.friction);
    return slope;
}

/// Only the robot's own nodes are involved.
Slope of_self_contact(const Place& at) {
    Slope slope = nothing(at);
    const contact::Contact* contact = at.system().model().contact(at.controls().met);
    if (contact == nullptr) return slope;
    const std::vector<double> x = contact_nodes(at.system(), at.state(), at.controls());
    std::vector<double> gradient(x.size(), 0.0);
    slope.value = contact->add_self_force(contact->find(x), x, gradient);
    slope.state.by_positions = Eigen::Map<const Eigen::VectorXd>(gradient.data(), at.state().x.size());
    const double stiffness = contact->settings().stiffness_Pa;
    slope.direct.push_back({{Parameter::Kind::contact_stiffness, 0, "", "", 0, 0}, slope.value / stiffness});
    return slope;
}

/// Number of things that a measure can refer to, and their name.
std::pair<std::size_t, const char*> count_of(const Description& d, const Measure& m) {
    switch (m.kind) {
        case Kind::marker:
            return {d.markers.size(), "marker"};
        case Kind::tension:
        case Kind::length:
        case Kind::length_ratio:
            return {d.cables.size(), "cable"};
        case Kind::pressure:
            if (m.pressure_load) return {d.pressures.size(), "pressure load"};
            [[fallthrough]];
        case Kind::volume:
        case Kind::volume_ratio:
            return {d.chambers.size(), "chamber"};
        case Kind::spring_length:
        case Kind::spring_force:
            return {d.springs.size(), "spring"};
        case Kind::reaction:
            return {d.supports.size(), "support"};
        case Kind::contact_force:
            return {d.contact ? d.contact->obstacles.size() : 0, "obstacle"};
        case Kind::point:
        case Kind::self_contact:
            break;
    }
    return {1, ""};
}

}  // namespace

Status check(const Equilibrium& system, const Measure& measure) {
    const auto [count, name] = count_of(system.model().description(), measure);
    if (measure.index < count) return {};
    return input_error("there is no {} {}: the robot has {}, counted from 0", name, measure.index, count);
}

Slope slope(const Linearisation& at, const Measure& measure) {
    return slope(at.system(), at.state(), at.controls(), measure);
}

Slope slope(const Equilibrium& system, const State& state, const Controls& controls, const Measure& m) {
    const Place at{system, state, controls};
    const Description& d = at.system().model().description();
    switch (m.kind) {
        case Kind::marker:
            return of_point(at, d.markers[m.index].point, m.direction);
        case Kind::point:
            return of_point(at, m.point, m.direction);
        case Kind::tension:
            return of_tension(at, actuator_of(d, m));
        case Kind::pressure:
            return of_pressure(at, actuator_of(d, m));
        case Kind::length:
        case Kind::volume:
            return of_measure(at, actuator_of(d, m), false);
        case Kind::length_ratio:
        case Kind::volume_ratio:
            return of_measure(at, actuator_of(d, m), true);
        case Kind::spring_length:
        case Kind::spring_force:
            return of_spring(at, m.index, m.kind == Kind::spring_force);
        case Kind::reaction:
            return of_reaction(at, m.index, m.direction);
        case Kind::contact_force:
            return of_contact(at, m.index, m.direction);
        case Kind::self_contact:
            return of_self_contact(at);
    }
    return nothing(at);
}

void add(const Slope& slope, double factor, Slope& sum) {
    const auto add_vector = [&](const Eigen::VectorXd& from, Eigen::VectorXd& to) {
        if (from.size() == 0) return;
        if (to.size() < from.size()) {
            const Eigen::Index had = to.size();
            to.conservativeResize(from.size());
            to.tail(from.size() - had).setZero();
        }
        to.head(from.size()) += factor * from;
    };
    sum.value += factor * slope.value;
    add_vector(slope.state.by_positions, sum.state.by_positions);
    add_vector(slope.state.by_multipliers, sum.state.by_multipliers);
    add_vector(slope.state.by_forces, sum.state.by_forces);
    add_vector(slope.by_rest, sum.by_rest);
    add_vector(slope.by_numbers, sum.by_numbers);
    for (const auto& [by, rate] : slope.direct) sum.direct.push_back({by, factor * rate});
    for (const Slope::ByMeasure& by : slope.by_measures)
        sum.by_measures.push_back({by.actuator, factor * by.now, factor * by.at_rest});
    for (const Slope::ByMeasure& by : slope.by_springs)
        sum.by_springs.push_back({by.actuator, factor * by.now, factor * by.at_rest});
}

Slope no_slope(const Equilibrium& system) {
    Slope slope;
    slope.state = {Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(system.model().node_count())),
                   Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.actuators().size()))};
    return slope;
}

}  // namespace pliant::sim

#include "simulation/linearisation/rest_positions.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/linalg/vectors.hpp"
#include "simulation/actuators/loads.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/linearisation/damping_stiffness.hpp"
#include "simulation/linearisation/element_derivatives.hpp"
#include "simulation/linearisation/met_segments.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

Eigen::VectorXd zeros(const Linearisation& at) {
    return Eigen::VectorXd::Zero(at.state().x.size());
}

/// (3n) gradient of the volume of the straight tets, divided by that volume; for their mean size, which determines the
/// stiffness of plates, a third of it.
Eigen::VectorXd volume_gradient(const mesh::TetMesh& mesh) {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.points.size()));
    double volume = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const std::span<const int> n = mesh.tet(t).first(4);
        const auto edge = [&](std::size_t k) {
            return mesh.points[static_cast<std::size_t>(n[k])] - mesh.points[static_cast<std::size_t>(n[0])];
        };
        const std::array<Vec3, 3> by = {cross(edge(2), edge(3)) / 6, cross(edge(3), edge(1)) / 6,
                                        cross(edge(1), edge(2)) / 6};
        volume += dot(edge(1), by[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            gradient.segment<3>(3 * n[k + 1]) += linalg::vector(by[k]);
            gradient.segment<3>(3 * n[0]) -= linalg::vector(by[k]);
        }
    }
    return gradient / volume;
}

/// (3n) forces of all plates.
Eigen::VectorXd plate_forces(const Linearisation& at) {
    Eigen::VectorXd forces = zeros(at);
    for (const Plate& plate : at.system().plates()) plate.add_gradient(view(at.state().x), view(forces));
    return forces;
}

template <class Visit>
void visit_objects(const Linearisation& at, const Visit& visit) {
    for (const AffineBody& object : at.system().objects()) visit(object);
}

/// Calls visit(dL/dx at this state times -k, dL0/dX) for each active spring without a given free length.
template <class Visit>
void visit_free_springs(const Linearisation& at, const Visit& visit) {
    const Description& d = at.system().model().description();
    const Eigen::VectorXd rest = at.system().rest().x;
    for (std::size_t s = 0; s < d.springs.size(); ++s) {
        const SpringPath& path = at.system().springs()[s];
        const bool slack = d.springs[s].only_pulls && !(path.force(view(at.state().x)) > 0);
        if (d.springs[s].free_length_m || slack) continue;
        Eigen::VectorXd force = zeros(at), at_rest = zeros(at);
        path.add_length_gradient(view(at.state().x), -d.springs[s].stiffness_N_m, view(force));
        path.add_length_gradient(view(rest), 1, view(at_rest));
        visit(force, at_rest);
    }
}

/// Calls visit(load, force) for each load that is spread over faces, with its force now.
template <class Visit>
void visit_spread_loads(const Linearisation& at, const Visit& visit) {
    for (const Load& load : at.system().model().description().loads) {
        if (!load.faces.empty()) visit(load, load.share.at(at.controls().time) * load.force_N);
    }
}

template <class Visit>
void visit_gaps(const Linearisation& at, const Visit& visit) {
    const auto& actuators = at.system().actuators();
    for (std::size_t a = 0; a < actuators.size(); ++a) {
        if (actuators[a].gaps() != nullptr)
            visit(*actuators[a].gaps(), at.state().multiplier[static_cast<Eigen::Index>(a)]);
    }
}

/// Calls visit(path, force, row, actuator) for each cable and spring with segments whose ends have met: dF/d(met
/// length) (3n) and, for a cable, the change of its measure.
template <class Visit>
void visit_met_segments(const Linearisation& at, const Visit& visit) {
    const Eigen::VectorXd& x = at.state().x;
    const Description& d = at.system().model().description();
    for (std::size_t c = 0; c < d.cables.size(); ++c) {
        const Actuator& actuator = at.system().actuators()[c];
        const MetSegments met(actuator.cable(), view(x), at.controls().shares[c]);
        if (!met.any()) continue;
        Eigen::VectorXd force = zeros(at);
        const bool by_gaps = actuator.gaps() != nullptr;  // there the multiplier is not a tension
        if (!by_gaps) met.add_gradient_rate(at.state().multiplier[static_cast<Eigen::Index>(c)], view(force));
        visit(actuator.cable(), force, met.length_rate(), c);
    }
    const Eigen::VectorXd rest = at.system().rest().x;
    for (std::size_t s = 0; s < d.springs.size(); ++s) {
        const double pull = at.system().springs()[s].force(view(x));
        if (d.springs[s].only_pulls && !(pull > 0)) continue;
        const CablePath path(d.springs[s].points, view(rest));
        const MetSegments met(path, view(x));
        if (!met.any()) continue;
        Eigen::VectorXd force = zeros(at);
        met.add_gradient_rate(pull, view(force));
        path.add_gradient(view(x), d.springs[s].stiffness_N_m * met.length_rate(), view(force));
        visit(path, force, 0.0, at.system().actuators().size());
    }
}

/// The row of a multiplier's own equation; empty if it has none, or if the cable is slack.
std::optional<Eigen::Index> row_of(const Linearisation& at, std::size_t actuator) {
    const auto place = std::ranges::find(at.solved(), actuator);
    if (place == at.solved().end() || at.is_slack(actuator)) return std::nullopt;
    return at.size() - (at.solved().end() - place);
}

/// The motion (3n) of held nodes that follows from that of their rest positions.
Eigen::VectorXd held_motion(const Linearisation& at, const Eigen::VectorXd& motion) {
    const Description& d = at.system().model().description();
    return at.system().model().held().motion([&](std::size_t s, int node) -> Eigen::Vector3d {
        const auto arm = linalg::view(view(motion), node);
        return linalg::vector(d.supports[s].turned_arm({arm[0], arm[1], arm[2]}, at.controls().support_share[s]));
    });
}

/// Its transpose.
Eigen::VectorXd held_weights(const Linearisation& at, const Eigen::VectorXd& weights) {
    const Description& d = at.system().model().description();
    Eigen::VectorXd result = zeros(at);
    at.system().model().held().visit_weights(
        weights, [&](std::size_t s, int node, const Eigen::Vector3d& w) {  // rotated back
            const Vec3 back = d.supports[s].turned_arm({w[0], w[1], w[2]}, -at.controls().support_share[s]);
            result.segment<3>(3 * node) += linalg::vector(back);
        });
    return result;
}

}  // namespace

Derivative derivative_by_rest(Linearisation& at, const Eigen::VectorXd& motion) {
    const Equilibrium& system = at.system();
    Eigen::VectorXd force = zeros(at);
    add_rest_product(system.model().elements(),
                     masses_at(at.system().model().description(), at.controls(), at.state().x), at.state().x, motion,
                     force);
    if (const auto damped = damped_step(at)) add_damping_rest_product(*damped, motion, force);
    for (const Plate& plate : system.plates()) plate.add_rest_product(view(at.state().x), view(motion), view(force));
    if (!system.plates().empty()) force += volume_gradient(system.model().mesh()).dot(motion) / 3 * plate_forces(at);
    visit_objects(
        at, [&](const AffineBody& object) { object.add_rest_product(view(at.state().x), view(motion), view(force)); });
    visit_free_springs(at, [&](const Eigen::VectorXd& by_length, const Eigen::VectorXd& at_rest) {
        force += at_rest.dot(motion) * by_length;
    });
    visit_spread_loads(at, [&](const Load& load, const Vec3& total) {
        const std::vector<double> rates = share_rates(system.model().mesh(), load.faces, view(motion));
        for (std::size_t k = 0; k < rates.size(); ++k)
            force.segment<3>(3 * load.nodes[k]) -= rates[k] * linalg::vector(total);
    });
    visit_gaps(at, [&](const GapElements& gaps, double multiplier) {
        gaps.add_rest_product(system.model().elements(), view(at.state().x), multiplier, view(motion), view(force));
    });
    const Eigen::VectorXd rest = system.rest().x;
    std::vector<std::pair<Eigen::Index, double>> rows;
    visit_met_segments(at, [&](const CablePath& path, const Eigen::VectorXd& by_met, double row, std::size_t a) {
        Eigen::VectorXd gradient = zeros(at);
        add_met_length_gradient(path, view(rest), 1, view(gradient));
        const double change = gradient.dot(motion);
        force += change * by_met;
        if (const auto own = row_of(at, a)) rows.emplace_back(*own, row * change);
    });
    const Eigen::VectorXd held = held_motion(at, motion);
    Derivative by{at.equations_of_motion(held), {held, Eigen::VectorXd::Zero(at.state().multiplier.size())}};
    const Eigen::VectorXd free = system.restrict_to_free(force);
    by.equations.head(free.size()) += free;
    for (const auto& [row, change] : rows) by.equations[row] += change;
    by.forces = std::move(force);
    return by;
}

Eigen::VectorXd rest_gradient(Linearisation& at, const Adjoint& adjoint) {
    const Equilibrium& system = at.system();
    const Eigen::VectorXd weights = at.force_weights(adjoint).head(at.state().x.size());
    Eigen::VectorXd sum = zeros(at);
    add_rest_weights(system.model().elements(),
                     masses_at(at.system().model().description(), at.controls(), at.state().x), at.state().x, weights,
                     sum);
    if (const auto damped = damped_step(at)) add_damping_rest_weights(*damped, weights, sum);
    for (const Plate& plate : system.plates()) plate.add_rest_weights(view(at.state().x), view(weights), view(sum));
    if (!system.plates().empty()) sum += weights.dot(plate_forces(at)) / 3 * volume_gradient(system.model().mesh());
    visit_objects(
        at, [&](const AffineBody& object) { object.add_rest_weights(view(at.state().x), view(weights), view(sum)); });
    visit_free_springs(at, [&](const Eigen::VectorXd& by_length, const Eigen::VectorXd& at_rest) {
        sum += by_length.dot(weights) * at_rest;
    });
    visit_spread_loads(at, [&](const Load& load, const Vec3& total) {
        std::vector<double> worth;
        for (const int node : load.nodes) worth.push_back(-weights.segment<3>(3 * node).dot(linalg::vector(total)));
        add_share_gradient(system.model().mesh(), load.faces, worth, view(sum));
    });
    visit_gaps(at, [&](const GapElements& gaps, double multiplier) {
        gaps.add_rest_weights(system.model().elements(), view(at.state().x), multiplier, view(weights), view(sum));
    });
    const Eigen::VectorXd rest = system.rest().x;
    visit_met_segments(at, [&](const CablePath& path, const Eigen::VectorXd& by_met, double row, std::size_t a) {
        double worth = weights.dot(by_met);
        if (const auto own = row_of(at, a)) worth -= adjoint.weights[*own] * row;
        add_met_length_gradient(path, view(rest), worth, view(sum));
    });
    return held_weights(at, adjoint.quantity.by_positions - at.held_motion_weights(adjoint.weights)) + sum;
}

Eigen::VectorXd rest_measure_gradient(const Equilibrium& system, std::size_t actuator) {
    const Eigen::VectorXd rest = system.rest().x;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(rest.size());
    system.actuators()[actuator].add_measure_gradient(view(rest), 1, view(gradient));
    return gradient;
}

}  // namespace pliant::sim

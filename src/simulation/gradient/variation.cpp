#include "simulation/gradient/variation.hpp"

#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/gradient/guide_points.hpp"
#include "simulation/linearisation/contact_forces.hpp"
#include "simulation/linearisation/damping_stiffness.hpp"
#include "simulation/linearisation/element_derivatives.hpp"
#include "simulation/linearisation/rest_positions.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

bool is_same(const Parameter& a, const Parameter& b) {
    return a.kind == b.kind && a.index == b.index && a.part == b.part;
}

/// Adds the explicit derivatives of the measure with respect to each number.
void add_direct(const Slope& of, std::span<const Parameter> all, Eigen::VectorXd& sum) {
    for (const auto& [by, rate] : of.direct) {
        for (std::size_t k = 0; k < all.size(); ++k) {
            if (is_same(all[k], by)) sum[static_cast<Eigen::Index>(k)] += rate;
        }
    }
}

/// (actuators) derivative with respect to each measure at rest: explicit, and through the prescribed values.
Eigen::VectorXd by_rest_measure(Linearisation& at, const Adjoint& adjoint, const Slope& of) {
    Eigen::VectorXd by = wanted_by_rest(at);
    const std::vector<Parameter> all = inputs(at);
    for (Eigen::Index a = 0; a < by.size(); ++a) {
        if (by[a] != 0) by[a] *= adjoint.derivative(derivative(at, all[static_cast<std::size_t>(a)]));
    }
    for (const Slope::ByMeasure& own : of.by_measures) by[static_cast<Eigen::Index>(own.actuator)] += own.at_rest;
    return by;
}

Eigen::VectorXd by_rest_positions(Linearisation& at, const Adjoint& adjoint, const Slope& of,
                                  const Eigen::VectorXd& by_measure) {
    Eigen::VectorXd by = rest_gradient(at, adjoint);
    if (of.by_rest.size() > 0) by += of.by_rest;
    const Eigen::VectorXd rest = at.system().rest().x;
    for (Eigen::Index a = 0; a < by_measure.size(); ++a) {
        if (by_measure[a] != 0)
            at.system().actuators()[static_cast<std::size_t>(a)].add_measure_gradient(view(rest), by_measure[a],
                                                                                      view(by));
    }
    return by;
}

void add_to(const Derivative& one, double factor, Derivative& sum) {
    sum.equations += factor * one.equations;
    sum.direct.positions += factor * one.direct.positions;
    sum.direct.multipliers += factor * one.direct.multipliers;
    sum.forces.head(one.forces.size()) += factor * one.forces;
}

Derivative no_derivative(const Linearisation& at) {
    const Eigen::Index nodes = at.state().x.size();
    return {Eigen::VectorXd::Zero(at.size()),
            {Eigen::VectorXd::Zero(nodes), Eigen::VectorXd::Zero(at.state().multiplier.size())},
            Eigen::VectorXd::Zero(force_size(at.system()))};
}

void add_parameters(Linearisation& at, std::span<const Parameter> all, const Eigen::VectorXd& change, Derivative& sum) {
    for (Eigen::Index k = 0; k < change.size(); ++k) {
        if (change[k] != 0) add_to(derivative(at, all[static_cast<std::size_t>(k)]), change[k], sum);
    }
}

void add_tets(const Linearisation& at, const TetDerivatives& change, Derivative& sum) {
    const Elements& elements = at.system().model().elements();
    Eigen::VectorXd force = Eigen::VectorXd::Zero(at.state().x.size());
    if (change.constants.size() > 0) {
        add_law_force(elements, change.constants, at.state().x, force);
        if (const auto damped = damped_step(at)) add_damping_law_force(*damped, change.constants, force);
    }
    if (change.density.size() > 0)
        add_density_force(elements, masses_at(at.system().model().description(), at.controls(), at.state().x),
                          change.density, force);
    const Eigen::VectorXd free = at.system().restrict_to_free(force);
    sum.equations.head(free.size()) += free;
    sum.forces.head(force.size()) += force;
}

/// (actuators) change of their measures at rest with the rest positions.
Eigen::VectorXd rest_measures(const Equilibrium& system, const Eigen::VectorXd& motion) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.actuators().size()));
    for (Eigen::Index a = 0; motion.size() > 0 && a < change.size(); ++a)
        change[a] = rest_measure_gradient(system, static_cast<std::size_t>(a)).dot(motion);
    return change;
}

double change_of(Linearisation& at, const Slope& of, const Change& answer, const Derivative& by) {
    const Quantity whole = at.with_forces(of.state);
    return whole.derivative(answer) + whole.by_forces.dot(by.forces.head(whole.by_forces.size()));
}

}  // namespace

void add(const Variation& change, Variation& sum) {
    const auto add_part = [](const auto& from, auto& to) {
        if (from.size() == 0) return;
        if (to.size() == 0)
            to = from;
        else
            to += from;
    };
    add_part(change.inputs, sum.inputs);
    add_part(change.parameters, sum.parameters);
    add_part(change.tets.constants, sum.tets.constants);
    add_part(change.tets.density, sum.tets.density);
    add_part(change.rest, sum.rest);
    add_part(change.guides, sum.guides);
    add_part(change.numbers, sum.numbers);
}

Eigen::VectorXd wanted_by_rest(const Linearisation& at) {
    const Description& d = at.system().model().description();
    const std::vector<Parameter> all = inputs(at);
    Eigen::VectorXd rates = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(at.system().actuators().size()));
    for (std::size_t a = 0; a < at.system().actuators().size(); ++a) {
        const Parameter& input = all[a];
        const double offset = a < d.cables.size() ? d.cables[a].target.offset_at(at.controls().time)
                              : input.kind == Parameter::Kind::volume
                                  ? d.chambers[a - d.cables.size()].target.offset_at(at.controls().time)
                                  : 0;
        const double share = (input.value - offset) / at.system().actuators()[a].rest_measure();
        const bool changes = a < d.cables.size() ? d.cables[a].target.kind == CableTarget::Kind::shortening_m
                                                 : input.kind == Parameter::Kind::volume &&
                                                       d.chambers[a - d.cables.size()].target.kind ==
                                                           ChamberTarget::Kind::volume_change_m3;
        using Kind = Parameter::Kind;
        if (input.kind == Kind::length || input.kind == Kind::volume || input.kind == Kind::gas)
            rates[static_cast<Eigen::Index>(a)] = changes ? 1 : share;
    }
    return rates;
}

Result<Variation> gradient(Linearisation& at, const Slope& of, const By& by) {
    const Result<Adjoint> adjoint = at.adjoint(of.state);
    if (!adjoint) return tl::unexpected(adjoint.error());
    return gradient(at, *adjoint, of, by);
}

Variation gradient(Linearisation& at, const Adjoint& adjoint, const Slope& of, const By& by) {
    Variation result;
    if (by.inputs) {
        const std::vector<Parameter> all = inputs(at);
        result.inputs = derivatives(at, adjoint, all);
    }
    TetDerivatives tets;
    if (by.parameters || by.tets) tets = tet_derivatives(at, adjoint);
    if (by.parameters) {
        const std::vector<Parameter> all = parameters(at);
        result.parameters = derivatives(at, adjoint, all, tets);
        add_direct(of, all, result.parameters);
    }
    if (by.tets) result.tets = std::move(tets);
    if (!by.numbers.empty()) {
        result.numbers = worth_of_numbers(at, adjoint, by.numbers);
        if (of.by_numbers.size() > 0) result.numbers += of.by_numbers;
    }
    if (!by.rest && by.guides.empty()) return result;
    const Eigen::VectorXd by_measure = by_rest_measure(at, adjoint, of);
    if (by.rest) result.rest = by_rest_positions(at, adjoint, of, by_measure);
    if (!by.guides.empty()) result.guides = guide_gradient(at, adjoint, of, by_measure, by.guides);
    return result;
}

Derivative derivative(Linearisation& at, const Variation& with) {
    const Eigen::VectorXd of_rest = rest_measures(at.system(), with.rest);
    Eigen::VectorXd wanted = with.inputs;
    if (with.rest.size() > 0) {
        if (wanted.size() == 0) wanted = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(inputs(at).size()));
        wanted.head(of_rest.size()) += wanted_by_rest(at).cwiseProduct(of_rest);
    }
    Derivative by = no_derivative(at);
    add_parameters(at, inputs(at), wanted, by);
    add_parameters(at, parameters(at), with.parameters, by);
    add_tets(at, with.tets, by);
    if (with.rest.size() > 0) add_to(derivative_by_rest(at, with.rest), 1, by);
    return by;
}

Result<Eigen::VectorXd> changes(Linearisation& at, std::span<const Slope> of, const Variation& with) {
    const Derivative by = derivative(at, with);
    const Result<Change> answer = at.response(by);
    if (!answer) return tl::unexpected(answer.error());
    return changes(at, of, with, by, *answer);
}

Eigen::VectorXd changes(Linearisation& at, std::span<const Slope> of, const Variation& with, const Derivative& by,
                        const Change& answer) {
    const std::vector<Parameter> all = parameters(at);
    const Eigen::VectorXd of_rest = rest_measures(at.system(), with.rest);
    Eigen::VectorXd result(static_cast<Eigen::Index>(of.size()));
    for (std::size_t k = 0; k < of.size(); ++k) {
        double& change = result[static_cast<Eigen::Index>(k)];
        change = change_of(at, of[k], answer, by);
        if (of[k].by_rest.size() > 0 && with.rest.size() > 0) change += of[k].by_rest.dot(with.rest);
        for (const Slope::ByMeasure& own : of[k].by_measures)
            change += own.at_rest * of_rest[static_cast<Eigen::Index>(own.actuator)];
        if (with.parameters.size() == 0) continue;
        Eigen::VectorXd direct = Eigen::VectorXd::Zero(with.parameters.size());
        add_direct(of[k], all, direct);
        change += direct.dot(with.parameters);
    }
    return result;
}

}  // namespace pliant::sim

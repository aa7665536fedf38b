#include "simulation/linearisation/linearisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "base/linalg/sparse.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/linearisation/contact_forces.hpp"
#include "simulation/linearisation/element_derivatives.hpp"
#include "simulation/solver/corner_nesting.hpp"
#include "simulation/solver/tangent_inverse.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

/// Name in messages: cable "left".
std::string name_of(const Description& d, std::size_t actuator) {
    const std::size_t chambers = d.cables.size(), pressures = chambers + d.chambers.size();
    if (actuator < chambers) return fmt::format("cable \"{}\"", d.cables[actuator].name);
    if (actuator < pressures) return fmt::format("chamber \"{}\"", d.chambers[actuator - chambers].name);
    return fmt::format("load \"{}\"", d.pressures[actuator - pressures].name);
}

/// The layout with the state's contact coupling.
TangentLayout layout_at(const Equilibrium& system, const State& state, const Controls& controls, TangentNodes nodes) {
    return system.lay_out_tangent(system.contact_cliques(state, controls, nodes), nodes);
}

/// True if the pattern couples all nodes of each clique.
bool holds(const linalg::SymmetricPattern& pattern, const std::vector<std::vector<int>>& cliques) {
    for (const std::vector<int>& clique : cliques) {
        for (const int i : clique) {
            for (const int j : clique) {
                if (j >= 0 && i >= j && !pattern.holds(i, j)) return false;
            }
        }
    }
    return true;
}

struct Parts {
    std::vector<double> symmetric, skew;
};

Parts assembled(const Equilibrium& system, const State& state, const Controls& controls, const TangentLayout& layout) {
    Parts parts;
    parts.symmetric.assign(layout.pattern.entries(), 0.0);
    system.add_tangent(state, controls, layout, parts.symmetric, false);
    if (layout.nodes == TangentNodes::free && !system.has_skew() && !system.has_torques() &&
        system.model().elements().has_energy())
        return parts;
    parts.skew.assign(layout.pattern.entries(), 0.0);
    system.add_skew(state, controls, layout, parts.skew);
    const auto is_zero = [](double entry) { return entry == 0; };
    if (std::ranges::all_of(parts.skew, is_zero)) parts.skew.clear();
    return parts;
}

}  // namespace

Quantity marker_coordinate(const Equilibrium& system, std::size_t marker, const Vec3& direction) {
    const Model& model = system.model();
    const Attachment& point = model.description().markers[marker].point;
    Quantity quantity{Eigen::VectorXd::Zero(3 * model.node_count()),
                      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.actuators().size()))};
    for (std::size_t k = 0; k < point.nodes.size(); ++k)
        quantity.by_positions.segment<3>(3 * point.nodes[k]) += point.weights[k] * linalg::vector(direction);
    return quantity;
}

Quantity multiplier_of(const Equilibrium& system, std::size_t actuator) {
    Quantity quantity{Eigen::VectorXd::Zero(3 * system.model().node_count()),
                      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.actuators().size()))};
    quantity.by_multipliers[static_cast<Eigen::Index>(actuator)] = 1;
    return quantity;
}

/// The tangent over all nodes, with the forces and constraints of the unknown multipliers.
struct Linearisation::Whole {
    TangentLayout layout;
    Parts tangent;
    Eigen::MatrixXd constraints;  ///< (3n, solved)
};

KnownPattern known_pattern(const Equilibrium& system, const FactoredLaplacian& laplacian, const SolverMemory* memory) {
    const auto& alone = laplacian.tangent_layout();
    const bool on_levels = !system.has_skew() && levels_are_quicker(alone->pattern, false, laplacian.work());
    if (memory != nullptr && memory->touching && memory->layout) return {memory->layout, memory->analysis, on_levels};
    return {alone, on_levels ? nullptr : laplacian.analysis(), on_levels};
}

Result<Linearisation> Linearisation::create(const Equilibrium& system, const State& state, const Controls& controls,
                                            const KnownPattern& known, double residual) {
    if (system.model().description().fluid)
        return input_error("a robot in a [fluid] has no linearisation: gradients and the inverse know no drag");
    if (controls.inertia && controls.inertia->scheme() == Scheme::conserving)
        return input_error("a step with integrator = \"energy-conserving\" has no linearisation; use \"bdf2\"");
    const Evaluation evaluation = system.evaluate(state, controls);
    if (!evaluation.possible()) return failure("a state that {} has no linearisation", name(evaluation.flaw));
    Linearisation made;
    made.system_ = &system;
    made.state_ = {state.x, evaluation.multiplier};
    made.controls_ = controls;
    made.find_unknowns();
    made.assemble(known);
    made.matrix_->wanted_residual = residual;
    return made;
}

void Linearisation::find_unknowns() {
    const auto& actuators = system_->actuators();
    slack_.assign(actuators.size(), false);
    for (std::size_t a = 0; a < actuators.size(); ++a) {
        if (controls_.drives[a].kind == Drive::Kind::multiplier) continue;
        solved_.push_back(a);
        slack_[a] = actuators[a].only_pulls() && !(state_.multiplier[static_cast<Eigen::Index>(a)] > 0);
    }
}

bool Linearisation::is_slack(std::size_t actuator) const {
    return slack_[actuator];
}

void Linearisation::assemble(const KnownPattern& known) {
    matrix_ = std::make_shared<LinearSystem>();
    LinearSystem& A = *matrix_;
    if (known.layout && holds(known.layout->pattern, system_->contact_cliques(state_, controls_))) {
        A.layout = known.layout;
        A.analysis = known.analysis;
    } else {
        A.layout = std::make_shared<const TangentLayout>(layout_at(*system_, state_, controls_, TangentNodes::free));
    }
    A.on_levels = known.on_levels;
    if (A.on_levels) A.corners = nest_in_corners(system_->model());
    A.positions = system_->free_positions(state_.x);
    A.rollers = system_->rollers();
    Parts parts = assembled(*system_, state_, controls_, *A.layout);
    A.symmetric = std::move(parts.symmetric);
    A.skew = std::move(parts.skew);
    const auto count = static_cast<Eigen::Index>(solved_.size());
    A.forces = A.constraints = Eigen::MatrixXd::Zero(3 * system_->model().free_count(), count);
    A.compliance = Eigen::VectorXd::Zero(count);
    for (Eigen::Index k = 0; k < count; ++k) {
        const std::size_t a = solved_[static_cast<std::size_t>(k)];
        const Actuator& actuator = system_->actuators()[a];
        A.multipliers.push_back(name_of(system_->model().description(), a));
        Eigen::VectorXd full = Eigen::VectorXd::Zero(state_.x.size());
        actuator.add_gradient(view(state_.x), 1, view(full), controls_.shares[a]);
        A.forces.col(k) = system_->restrict_to_free(full);
        set_constraint(A, static_cast<std::size_t>(k));
    }
}

/// The row of the k-th unknown multiplier.
void Linearisation::set_constraint(LinearSystem& A, std::size_t k) const {
    const std::size_t a = solved_[k];
    const auto at = static_cast<Eigen::Index>(k);
    A.constraints.col(at).setZero();
    A.compliance[at] = slack_[a] ? 1 : 0;
    if (slack_[a]) return;
    Eigen::VectorXd full = Eigen::VectorXd::Zero(state_.x.size());
    system_->actuators()[a].add_measure_gradient(view(state_.x), 1, view(full), controls_.shares[a]);
    A.constraints.col(at) = system_->restrict_to_free(full);
    if (controls_.drives[a].kind == Drive::Kind::gas)
        A.compliance[at] =
            -system_->gas_compliance(controls_.drives[a], state_.multiplier[static_cast<Eigen::Index>(a)]);
}

void Linearisation::tighten(const std::vector<std::size_t>& cables) {
    auto tight = std::make_shared<LinearSystem>(*matrix_);
    for (std::size_t k = 0; k < solved_.size(); ++k) {
        const std::size_t a = solved_[k];
        if (!slack_[a] || std::ranges::find(cables, a) == cables.end()) continue;
        slack_[a] = false;
        // So small that it adds nothing to K.
        state_.multiplier[static_cast<Eigen::Index>(a)] = std::numeric_limits<double>::min();
        set_constraint(*tight, k);
    }
    set_constraints(std::move(tight));
}

void Linearisation::slacken(const std::vector<std::size_t>& cables) {
    auto loose = std::make_shared<LinearSystem>(*matrix_);
    for (std::size_t k = 0; k < solved_.size(); ++k) {
        const std::size_t a = solved_[k];
        if (!system_->actuators()[a].only_pulls() || std::ranges::find(cables, a) == cables.end()) continue;
        slack_[a] = true;
        set_constraint(*loose, k);
    }
    set_constraints(std::move(loose));
}

/// Takes a matrix that differs only in its constraints.
void Linearisation::set_constraints(std::shared_ptr<LinearSystem> changed) {
    // A copy of this linearisation still needs a solver that it shares.
    solver_ = solver_.use_count() == 1 ? std::make_shared<SystemSolver>(*changed, std::move(*solver_)) : nullptr;
    matrix_ = std::move(changed);
    whole_ = nullptr;
}

Eigen::VectorXd Linearisation::equations(const Equilibrium& system, const State& state,
                                         const Controls& controls) const {
    const double ambient = system.model().description().ambient_pressure_Pa;
    Controls given = controls;
    Eigen::VectorXd rows(static_cast<Eigen::Index>(solved_.size()));
    for (std::size_t k = 0; k < solved_.size(); ++k) {
        const std::size_t a = solved_[k];
        const double m = state.multiplier[static_cast<Eigen::Index>(a)];
        const double wanted = controls.drives[a].kind == Drive::Kind::gas ? controls.drives[a].value / (ambient - m)
                                                                          : controls.drives[a].value;
        rows[static_cast<Eigen::Index>(k)] =
            slack_[a] ? m : system.actuators()[a].measure(view(state.x), controls.shares[a]) - wanted;
        given.drives[a] = {Drive::Kind::multiplier, m};
    }
    const Evaluation evaluation = system.evaluate(state, given);
    if (!evaluation.possible()) return Eigen::VectorXd::Constant(size(), std::numeric_limits<double>::quiet_NaN());
    Eigen::VectorXd all(size());
    all << system_->restrict_to_free(evaluation.out_of_balance), rows;
    return all;
}

Change Linearisation::change_of(const Eigen::VectorXd& unknowns) const {
    Change change{Eigen::VectorXd::Zero(state_.x.size()), Eigen::VectorXd::Zero(state_.multiplier.size())};
    const Eigen::Index n = matrix_->free_size();
    system_->add_free(unknowns.head(n), 1, change.positions);
    for (std::size_t k = 0; k < solved_.size(); ++k)
        change.multipliers[static_cast<Eigen::Index>(solved_[k])] = unknowns[n + static_cast<Eigen::Index>(k)];
    return change;
}

Eigen::VectorXd Linearisation::unknowns_of(const Change& change) const {
    Eigen::VectorXd unknowns(size());
    const Eigen::Index n = matrix_->free_size();
    unknowns.head(n) = system_->restrict_to_free(change.positions);
    for (std::size_t k = 0; k < solved_.size(); ++k)
        unknowns[n + static_cast<Eigen::Index>(k)] = change.multipliers[static_cast<Eigen::Index>(solved_[k])];
    return unknowns;
}

SystemSolver& Linearisation::solver() {
    if (!solver_) solver_ = std::make_shared<SystemSolver>(*matrix_);
    return *solver_;
}

const Linearisation::Whole& Linearisation::whole() {
    if (whole_) return *whole_;
    auto whole = std::make_shared<Whole>();
    whole->layout = layout_at(*system_, state_, controls_, TangentNodes::all);
    whole->tangent = assembled(*system_, state_, controls_, whole->layout);
    whole->constraints = Eigen::MatrixXd::Zero(state_.x.size(), static_cast<Eigen::Index>(solved_.size()));
    for (std::size_t k = 0; k < solved_.size(); ++k) {
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(state_.x.size());
        const std::size_t a = solved_[k];
        if (!slack_[a])
            system_->actuators()[a].add_measure_gradient(view(state_.x), 1, view(gradient), controls_.shares[a]);
        whole->constraints.col(static_cast<Eigen::Index>(k)) = gradient;
    }
    whole_ = std::move(whole);
    return *whole_;
}

void Linearisation::add_stiffness(const Eigen::VectorXd& v, Side side, Eigen::VectorXd& result) {
    const Whole& all = whole();
    linalg::add_product(all.layout.pattern, all.tangent.symmetric, view(v), 1, view(result));
    if (!all.tangent.skew.empty())
        add_skew_product(all.layout.pattern, all.tangent.skew, v, side == Side::direct ? 1 : -1, result);
}

Eigen::VectorXd Linearisation::equations_of_motion(const Eigen::VectorXd& motion) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(motion.size());
    add_stiffness(motion, Side::direct, force);
    Eigen::VectorXd rows(size());
    rows << system_->restrict_to_free(force), whole().constraints.transpose() * motion;
    return rows;
}

Eigen::VectorXd Linearisation::motion_weights(const Eigen::VectorXd& weights) {
    const Eigen::Index n = matrix_->free_size();
    Eigen::VectorXd full = Eigen::VectorXd::Zero(state_.x.size());
    system_->add_free(weights.head(n), 1, full);
    Eigen::VectorXd result = whole().constraints * weights.tail(weights.size() - n);
    add_stiffness(full, Side::transposed, result);
    return result;
}

/// Inertia and gap elements couple the nodes of tets, and laws without an energy have a skew part on them.
bool Linearisation::is_tets_and_more() const {
    const auto has_gaps = [](const Actuator& actuator) { return actuator.gaps() != nullptr; };
    return !controls_.inertia && system_->model().elements().has_energy() &&
           std::ranges::none_of(system_->actuators(), has_gaps);
}

bool Linearisation::has_more_than_tets() const {
    return !system_->actuators().empty() || !system_->plates().empty() || !system_->springs().empty() ||
           !system_->objects().empty() || !system_->joints().empty() ||
           system_->model().contact(controls_.met) != nullptr;
}

Eigen::VectorXd Linearisation::held_motion_weights(const Eigen::VectorXd& weights) {
    const Model& model = system_->model();
    std::vector<bool> held(static_cast<std::size_t>(model.node_count()));
    for (std::size_t node = 0; node < held.size(); ++node) held[node] = model.held().is_fixed(static_cast<int>(node));
    for (const HeldNodes::Roller& roller : model.held().rollers()) held[static_cast<std::size_t>(roller.node)] = true;
    Eigen::VectorXd result;
    if (whole_ || !is_tets_and_more()) {
        result = motion_weights(weights);
    } else {
        const Eigen::Index n = matrix_->free_size();
        Eigen::VectorXd full = Eigen::VectorXd::Zero(state_.x.size());
        system_->add_free(weights.head(n), 1, full);
        result = Eigen::VectorXd::Zero(full.size());
        add_tangent_product(model.elements(), held, state_.x, full, result);
        for (std::size_t k = 0; k < solved_.size(); ++k) {
            const std::size_t a = solved_[k];
            if (!slack_[a])
                system_->actuators()[a].add_measure_gradient(view(state_.x), weights[n + static_cast<Eigen::Index>(k)],
                                                             view(result), controls_.shares[a]);
        }
        if (has_more_than_tets()) add_stiffness_beside_tets(full, result);
    }
    for (std::size_t node = 0; node < held.size(); ++node) {
        if (!held[node]) result.segment<3>(3 * static_cast<Eigen::Index>(node)).setZero();
    }
    return result;
}

/// K^T v without the contributions of tets and inertia.
void Linearisation::add_stiffness_beside_tets(const Eigen::VectorXd& v, Eigen::VectorXd& result) const {
    const TangentLayout layout =
        system_->lay_out_tangent_beside_tets(system_->contact_cliques(state_, controls_, TangentNodes::all));
    std::vector<double> symmetric(layout.pattern.entries(), 0.0), skew(layout.pattern.entries(), 0.0);
    system_->add_tangent_beside_tets(state_, controls_, layout, symmetric, false);
    system_->add_skew(state_, controls_, layout, skew);
    linalg::add_product(layout.pattern, symmetric, view(v), 1, view(result));
    add_skew_product(layout.pattern, skew, v, -1, result);
}

Change Linearisation::response_of(const Eigen::VectorXd& solved, const Derivative& by) const {
    Change change = change_of(-solved);
    change.positions += by.direct.positions;
    change.multipliers += by.direct.multipliers;
    return change;
}

Result<Change> Linearisation::response(const Derivative& by) {
    const Result<Eigen::VectorXd> answer = solve(by.equations);
    if (!answer) return tl::unexpected(answer.error());
    return response_of(*answer, by);
}

Result<std::vector<Change>> Linearisation::responses(const std::vector<Derivative>& by) {
    Eigen::MatrixXd columns(size(), static_cast<Eigen::Index>(by.size()));
    for (std::size_t k = 0; k < by.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = by[k].equations;
    const Result<Eigen::MatrixXd> answer = solver().solve_all(columns, Side::direct);
    if (!answer) return tl::unexpected(answer.error());
    std::vector<Change> changes;
    for (std::size_t k = 0; k < by.size(); ++k)
        changes.push_back(response_of(answer->col(static_cast<Eigen::Index>(k)), by[k]));
    return changes;
}

Quantity Linearisation::with_forces(const Quantity& quantity) {
    if (quantity.by_forces.size() == 0) return quantity;
    Quantity whole_one = quantity;
    const Eigen::VectorXd robot = quantity.by_forces.head(state_.x.size());
    add_stiffness(robot, Side::transposed, whole_one.by_positions);
    for (std::size_t a = 0; a < system_->actuators().size(); ++a) {
        Eigen::VectorXd unit = Eigen::VectorXd::Zero(state_.x.size());
        system_->actuators()[a].add_gradient(view(state_.x), 1, view(unit), controls_.shares[a]);
        whole_one.by_multipliers[static_cast<Eigen::Index>(a)] += unit.dot(robot);
    }
    if (quantity.by_forces.size() == robot.size()) return whole_one;
    Eigen::VectorXd obstacles = quantity.by_forces;
    obstacles.head(robot.size()).setZero();  // they are part of the stiffness
    whole_one.by_positions +=
        contact_stiffness_times(*system_, state_, controls_, obstacles).head(whole_one.by_positions.size());
    return whole_one;
}

Eigen::VectorXd Linearisation::force_weights(const Adjoint& adjoint) const {
    Eigen::VectorXd weights = adjoint.quantity.by_forces;
    if (weights.size() == 0) weights = Eigen::VectorXd::Zero(state_.x.size());
    weights.head(state_.x.size()) -= change_of(adjoint.weights).positions;
    return weights;
}

Result<Adjoint> Linearisation::adjoint(const Quantity& asked) {
    const Quantity quantity = with_forces(asked);
    Result<Eigen::VectorXd> weights = solve_transposed(unknowns_of({quantity.by_positions, quantity.by_multipliers}));
    if (!weights) return tl::unexpected(weights.error());
    return Adjoint{quantity, std::move(*weights)};
}

Result<std::vector<Adjoint>> Linearisation::adjoints(const std::vector<Quantity>& quantities) {
    std::vector<Adjoint> adjoints;
    Eigen::MatrixXd columns(size(), static_cast<Eigen::Index>(quantities.size()));
    for (const Quantity& asked : quantities) {
        adjoints.push_back({with_forces(asked), {}});
        const Quantity& quantity = adjoints.back().quantity;
        columns.col(static_cast<Eigen::Index>(adjoints.size() - 1)) =
            unknowns_of({quantity.by_positions, quantity.by_multipliers});
    }
    const Result<Eigen::MatrixXd> weights = solver().solve_all(columns, Side::transposed);
    if (!weights) return tl::unexpected(weights.error());
    for (std::size_t k = 0; k < adjoints.size(); ++k) adjoints[k].weights = weights->col(static_cast<Eigen::Index>(k));
    return adjoints;
}

}  // namespace pliant::sim

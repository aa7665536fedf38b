#include "simulation/inverse/sensitivity.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/solver/body_rotation.hpp"

namespace pliant::sim::inverse {
namespace {

constexpr double already_solved = 1e-9;  // what remains of a unit direction after removing known ones

}  // namespace

Result<Sensitivity> Sensitivity::create(const Stepper& stepper, const InputSpace& space, const RobotState& robot) {
    constexpr double residual = 1e-5;  // the step is verified by a solve in any case
    const KnownPattern known = known_pattern(stepper.system(), stepper.laplacian(), robot.memory.get());
    Result<Linearisation> at =
        Linearisation::create(stepper.system(), robot.now.state, robot.controls, known, residual);
    if (!at) return tl::unexpected(at.error());
    Sensitivity made(std::move(*at));
    made.by_ = space.derivatives(made.at_);
    return made;
}

void Sensitivity::tighten(const InputSpace& space, const std::vector<std::size_t>& cables) {
    at_.tighten(cables);
    by_ = space.derivatives(at_);
}

void Sensitivity::slacken(const InputSpace& space, const std::vector<std::size_t>& cables) {
    at_.slacken(cables);
    by_ = space.derivatives(at_);
}

Eigen::VectorXd Sensitivity::release(const std::vector<std::size_t>& cables, const State& now) {
    released_.reset();
    if (cables.empty()) return Eigen::VectorXd::Zero(rows_.by_inputs.rows());
    Change sum = no_change();
    const std::vector<Change> by_tension = responses_to_tensions(cables);
    for (std::size_t k = 0; k < by_tension.size(); ++k) {
        const double tension = now.multiplier[static_cast<Eigen::Index>(cables[k])];
        sum.positions -= tension * by_tension[k].positions;
        sum.multipliers -= tension * by_tension[k].multipliers;
    }
    released_ = std::move(sum);
    return rows_of(*released_);
}

/// Of the state to each tension of slack cables, as if it were prescribed; empty on an error.
std::vector<Change> Sensitivity::responses_to_tensions(const std::vector<std::size_t>& cables) {
    std::vector<Derivative> by;
    for (const std::size_t a : cables) {
        Change one = no_change();
        one.multipliers[static_cast<Eigen::Index>(a)] = 1;
        by.push_back({-at_.unknowns_of(one), no_change()});
    }
    Result<std::vector<Change>> changes = at_.responses(by);
    if (changes) return std::move(*changes);
    status_ = tl::unexpected(changes.error());
    return {};
}

Change Sensitivity::no_change() const {
    return {Eigen::VectorXd::Zero(at_.state().x.size()), Eigen::VectorXd::Zero(at_.state().multiplier.size())};
}

Eigen::VectorXd Sensitivity::rows_of(const Change& change) const {
    return rows_.by_positions * change.positions + rows_.by_multipliers * change.multipliers;
}

void Sensitivity::use(RowGradients rows) {
    rows_ = std::move(rows);
    learnt_.clear();
    direct_.clear();
    transposed_.clear();
    changes_.clear();
    begun_ = false;
}

/// Solves for all inputs or all residuals, where they are few.
void Sensitivity::solve_few() {
    if (std::exchange(begun_, true)) return;
    const Eigen::Index inputs = rows_.by_inputs.cols(), rows = rows_.by_inputs.rows();
    if (inputs <= std::min(rows, most_at_once) || drive_constraints())
        solve_for_inputs();
    else if (rows <= most_at_once)
        solve_for_rows();
}

/// True if no input acts on nodes directly: the responses are then combinations of those to the multipliers, which are
/// known.
bool Sensitivity::drive_constraints() const {
    const Eigen::Index motions = at_.size() - static_cast<Eigen::Index>(at_.solved().size());
    return std::ranges::all_of(by_, [&](const Derivative& by) { return by.equations.head(motions).isZero(0); });
}

void Sensitivity::solve_for_inputs() {
    const Eigen::Index count = rows_.by_inputs.cols();
    if (!drive_constraints()) solutions_ += static_cast<int>(count);
    Result<std::vector<Change>> changes = at_.responses(by_);
    if (!changes) {
        status_ = tl::unexpected(changes.error());
        return;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(count, i);
        changes_.push_back(std::move((*changes)[static_cast<std::size_t>(i)]));
        direct_.push_back({unit, product_of(unit, changes_.back())});
    }
}

void Sensitivity::solve_for_rows() {
    const Eigen::Index count = rows_.by_inputs.rows();
    std::vector<Quantity> quantities;
    for (Eigen::Index r = 0; r < count; ++r) quantities.push_back(quantity(Eigen::VectorXd::Unit(count, r)));
    solutions_ += static_cast<int>(count);
    const Result<std::vector<Adjoint>> adjoints = at_.adjoints(quantities);
    if (!adjoints) {
        status_ = tl::unexpected(adjoints.error());
        return;
    }
    for (Eigen::Index r = 0; r < count; ++r) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(count, r);
        transposed_.push_back({unit, product_of(unit, (*adjoints)[static_cast<std::size_t>(r)])});
    }
}

/// Product with v; `solve` is only called for the part outside the known directions.
template <class Solve>
Eigen::VectorXd Sensitivity::product(std::vector<Known>& known, const Eigen::VectorXd& v, Eigen::Index size,
                                     const Solve& solve) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(size), rest = v;
    for (int pass = 0; pass < 2; ++pass) {  // twice, because of rounding
        for (const Known& one : known) {
            const double share = one.direction.dot(rest);
            rest -= share * one.direction;
            result += share * one.product;
        }
    }
    const double left = rest.norm();
    if (!(left > already_solved * v.norm())) return result;
    known.push_back({rest / left, solve(Eigen::VectorXd(rest / left))});
    return result + left * known.back().product;
}

Eigen::VectorXd Sensitivity::direct_product(const Eigen::VectorXd& inputs) {
    return product(direct_, inputs, rows_.by_inputs.rows(),
                   [&](const Eigen::VectorXd& direction) { return solved_product(direction); });
}

Eigen::VectorXd Sensitivity::multiply(const Eigen::VectorXd& inputs) {
    solve_few();
    const Eigen::Index rows = rows_.by_inputs.rows();
    Eigen::VectorXd result(rows);
    if (knows_rows() && !knows_inputs()) {
        for (Eigen::Index r = 0; r < rows; ++r)
            result[r] = transposed_[static_cast<std::size_t>(r)].product.dot(inputs);
    } else {
        result = direct_product(inputs);
    }
    for (const Learnt& more : learnt_) result += more.rows * more.inputs.dot(inputs);
    return result;
}

Derivative Sensitivity::derivative(const Eigen::VectorXd& direction) const {
    Derivative by = by_.front();
    by.equations *= direction[0];
    by.direct.positions *= direction[0];
    by.direct.multipliers *= direction[0];
    for (Eigen::Index i = 1; i < direction.size(); ++i) {
        if (direction[i] == 0) continue;
        const Derivative& one = by_[static_cast<std::size_t>(i)];
        by.equations += direction[i] * one.equations;
        by.direct.positions += direction[i] * one.direct.positions;
        by.direct.multipliers += direction[i] * one.direct.multipliers;
    }
    return by;
}

Eigen::VectorXd Sensitivity::solved_product(const Eigen::VectorXd& direction) {
    ++solutions_;
    Result<Change> change = at_.response(derivative(direction));
    if (!change) {
        status_ = tl::unexpected(change.error());
        const Eigen::VectorXd& x = at_.state().x;
        changes_.push_back({Eigen::VectorXd::Zero(x.size()), Eigen::VectorXd::Zero(at_.state().multiplier.size())});
        return Eigen::VectorXd::Zero(rows_.by_inputs.rows());
    }
    changes_.push_back(*std::move(change));
    return product_of(direction, changes_.back());
}

Eigen::VectorXd Sensitivity::product_of(const Eigen::VectorXd& direction, const Change& change) const {
    return rows_.by_inputs * direction + rows_of(change);
}

/// Of the state, with these inputs and as cables let go.
Change Sensitivity::change_along(const Eigen::VectorXd& inputs) {
    (void)direct_product(inputs);  // the direction is known from here on
    Change sum = released_ ? *released_ : no_change();
    for (std::size_t k = 0; k < direct_.size(); ++k) {
        const double share = direct_[k].direction.dot(inputs);
        sum.positions += share * changes_[k].positions;
        sum.multipliers += share * changes_[k].multipliers;
    }
    return sum;
}

Eigen::VectorXd Sensitivity::expected_multipliers(const State& now, const Eigen::VectorXd& inputs) {
    return now.multiplier + change_along(inputs).multipliers;
}

State Sensitivity::expected(const Stepper& stepper, const State& now, const Eigen::VectorXd& inputs) {
    const Equilibrium& system = stepper.system();
    const Change change = change_along(inputs);
    State next{now.x, now.multiplier + change.multipliers};
    Eigen::MatrixXd turned = system.restrict_to_free(change.positions);
    if (now.x != at_.state().x) {
        BodyRotation rotation(system, stepper.laplacian());
        rotation.begin(at_.state().x);
        rotation.follow(now.x);
        rotation.push_forward_motions(turned);
    }
    Eigen::VectorXd end = now.x;
    system.add_free(turned.col(0), 1, end);
    next.x = stepper.laplacian().rotate(system, {.now = now.x.data(), .end = end.data()});
    for (std::size_t a = 0; a < system.actuators().size(); ++a) {
        double& multiplier = next.multiplier[static_cast<Eigen::Index>(a)];
        if (system.actuators()[a].only_pulls()) multiplier = std::max(multiplier, 0.0);
    }
    return next;
}

Quantity Sensitivity::quantity(const Eigen::VectorXd& rows) const {
    return {rows_.by_positions.transpose() * rows, rows_.by_multipliers.transpose() * rows};
}

std::optional<Adjoint> Sensitivity::adjoint(const Eigen::VectorXd& rows) {
    ++solutions_;
    Result<Adjoint> adjoint = at_.adjoint(quantity(rows));
    if (adjoint) return std::move(*adjoint);
    status_ = tl::unexpected(adjoint.error());
    return std::nullopt;
}

Eigen::VectorXd Sensitivity::product_of(const Eigen::VectorXd& rows, const Adjoint& adjoint) const {
    Eigen::VectorXd by_inputs = rows_.by_inputs.transpose() * rows;
    for (Eigen::Index i = 0; i < by_inputs.size(); ++i)
        by_inputs[i] += adjoint.derivative(by_[static_cast<std::size_t>(i)]);
    return by_inputs;
}

Eigen::VectorXd Sensitivity::multiply_transposed(const Eigen::VectorXd& rows) {
    solve_few();
    const Eigen::Index size = rows_.by_inputs.cols();
    Eigen::VectorXd result(size);
    if (knows_inputs() && !knows_rows()) {
        for (Eigen::Index i = 0; i < size; ++i) result[i] = direct_[static_cast<std::size_t>(i)].product.dot(rows);
    } else {
        result = product(transposed_, rows, size, [&](const Eigen::VectorXd& direction) {
            const std::optional<Adjoint> solved = adjoint(direction);
            return solved ? product_of(direction, *solved) : Eigen::VectorXd(Eigen::VectorXd::Zero(size));
        });
    }
    for (const Learnt& more : learnt_) result += more.inputs * more.rows.dot(rows);
    return result;
}

Eigen::VectorXd Sensitivity::by_tensions(const Eigen::VectorXd& rows, const std::vector<std::size_t>& cables) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(cables.size()));
    const std::vector<Change> by_tension = responses_to_tensions(cables);
    for (std::size_t k = 0; k < by_tension.size(); ++k)
        result[static_cast<Eigen::Index>(k)] = rows.dot(rows_of(by_tension[k]));
    return result;
}

Eigen::VectorXd Sensitivity::rows_by_tension(std::size_t cable) {
    const std::vector<Change> by_tension = responses_to_tensions({cable});
    return by_tension.empty() ? Eigen::VectorXd(Eigen::VectorXd::Zero(rows_.by_inputs.rows())) : rows_of(by_tension[0]);
}

void Sensitivity::learn(const Eigen::VectorXd& inputs, const Eigen::VectorXd& miss) {
    const double square = inputs.squaredNorm();
    if (square > 0) learnt_.push_back({miss / square, inputs});
}

}  // namespace pliant::sim::inverse

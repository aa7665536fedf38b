#include "simulation/run/stability.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/core/parallel.hpp"
#include "base/linalg/dense.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/corner_nesting.hpp"

namespace pliant::sim {
namespace {

constexpr int looks_with_one_metric = 8;
constexpr int first_steps = 12;     // iterations of the first check, which has no initial guess
constexpr int usual_steps = 2;      // iterations of later checks
constexpr double soft = 0.3;        // a ratio below this is computed more accurately
constexpr double settled = 0.98;    // stops when an iteration leaves more than this of the ratio
constexpr double unstable = -2e-3;  // a ratio below this is neither rounding nor an effect of the residual
constexpr int halvings = 4;
constexpr double most_of_it = 0.6;  // of a motion; with square-root growth a quarter would be left after as many
                                    // halvings

using linalg::view;

/// Fixed pseudo-random numbers between -1 and 1, so that no mode of a robot is orthogonal to them.
Eigen::VectorXd scattered(Eigen::Index size) {
    Eigen::VectorXd v(size);
    std::uint64_t seed = 0x9E3779B97F4A7C15ULL;
    for (double& value : v) {
        seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
        value = static_cast<double>(static_cast<std::int64_t>(seed)) * 0x1p-63;
    }
    return v;
}

double largest_motion(const Eigen::VectorXd& v) {
    double most = 0;
    for (Eigen::Index i = 0; i + 2 < v.size(); i += 3) most = std::max(most, v.segment<3>(i).norm());
    return most;
}

}  // namespace

bool Stability::is_applicable() const {
    return system_->conservative() && system_->model().description().growths.empty() &&
           system_->model().free_count() > 0;
}

std::optional<Eigen::VectorXd> Stability::falling_motion(const State& state, const Controls& controls) {
    if (!is_applicable() || !system_->contact_cliques(state, controls).empty()) return {};
    assemble(state, controls, false, stiffness_);
    const bool first = inverse_ == nullptr;
    if (first && !take_metric(state, controls)) return {};
    collect_constraints(state, controls);
    begin();
    const int least = first ? first_steps : usual_steps;
    for (int step = 0; ratio_ >= unstable; ++step) {
        const double before = ratio_;
        if (!improve()) break;
        if (step + 1 >= least && (ratio_ > soft || ratio_ > settled * before || step >= 2 * first_steps)) break;
    }
    // Near the limit of stability rounding may make an indefinite tangent pass as a metric.
    if (++age_ >= looks_with_one_metric && ratio_ > soft && take_metric(state, controls)) age_ = 0;
    const double scale = largest_motion(v_);
    if (ratio_ >= unstable || !(scale > 0)) return {};
    return v_ / scale;
}

void Stability::assemble(const State& state, const Controls& controls, bool project,
                         AlignedArray<double>& values) const {
    values.resize(layout_->pattern.entries());
    parallel_clear(values.span());
    system_->add_tangent(state, controls, *layout_, values.span(), project);
}

/// Uses the current tangent as metric if it is positive definite; else keeps the old one or, initially, takes its
/// positive projection.
bool Stability::take_metric(const State& state, const Controls& controls) {
    const Eigen::VectorXd positions = system_->free_positions(state.x);
    // Only a factor finds every negative direction of a metric: levels serve where it would be far too large. In double
    // precision: in single, tangents a little beyond the limit of stability pass as positive definite.
    auto inverse = levels_are_quicker(layout_->pattern, false, laplacian_->work())
                       ? make_levels_inverse(layout_->pattern, nest_in_corners(system_->model()))
                       : make_direct_inverse(laplacian_->analysis(), true);
    AlignedArray<double> values(stiffness_.size());
    std::ranges::copy(stiffness_.span(), values.span().begin());
    if (!inverse->set(values.span(), positions, TangentInverse::Effort::usual)) {
        if (inverse_) return false;
        assemble(state, controls, true, values);
        if (!inverse->set(values.span(), positions, TangentInverse::Effort::all)) return false;
    }
    inverse_ = std::move(inverse);
    metric_ = std::move(values);
    return true;
}

void Stability::collect_constraints(const State& state, const Controls& controls) {
    const auto& actuators = system_->actuators();
    std::vector<Eigen::VectorXd> fixed, gas;
    for (std::size_t a = 0; a < actuators.size(); ++a) {
        const Drive& drive = controls.drives[a];
        const double multiplier = state.multiplier[static_cast<Eigen::Index>(a)];
        const bool slack = actuators[a].only_pulls() && !(multiplier > 0);
        if (drive.kind == Drive::Kind::multiplier || slack) continue;
        Eigen::VectorXd full = Eigen::VectorXd::Zero(state.x.size());
        const bool sealed = drive.kind == Drive::Kind::gas;
        const double scale = sealed ? 1 / std::sqrt(system_->gas_compliance(drive, multiplier)) : 1;
        actuators[a].add_gradient(view(state.x), scale, view(full), controls.shares[a]);
        (sealed ? gas : fixed).push_back(system_->restrict_to_free(full));
    }
    const auto columns = [&](const std::vector<Eigen::VectorXd>& list) {
        Eigen::MatrixXd matrix(3 * system_->model().free_count(), static_cast<Eigen::Index>(list.size()));
        for (std::size_t k = 0; k < list.size(); ++k) matrix.col(static_cast<Eigen::Index>(k)) = list[k];
        return matrix;
    };
    fixed_ = columns(fixed);
    gas_ = columns(gas);
    answers_ = fixed_;
    if (answers_.cols() > 0) solve(answers_);
}

void Stability::solve(Eigen::MatrixXd& columns) {
    // Any result is a usable direction: the ratios tell how good it is.
    (void)inverse_->solve(columns, 0.05);
}

Eigen::VectorXd Stability::stiffness_times(const Eigen::VectorXd& v) const {
    Eigen::VectorXd result = gas_ * (gas_.transpose() * v);
    linalg::add_product(layout_->pattern, stiffness_.span(), view(v), 1, view(result));
    return result;
}

Eigen::VectorXd Stability::metric_times(const Eigen::VectorXd& v) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(v.size());
    linalg::add_product(layout_->pattern, metric_.span(), view(v), 1, view(result));
    return result;
}

/// Removes the components that would change a prescribed length or volume, with the smallest change in the norm of M.
void Stability::keep_constraints(Eigen::VectorXd& v) const {
    if (fixed_.cols() == 0) return;
    const Eigen::MatrixXd S = fixed_.transpose() * answers_;
    for (int twice = 0; twice < 2; ++twice) v -= answers_ * linalg::shortest_least_squares(S, fixed_.transpose() * v);
}

/// Initialises with the softest motion of the last check, or a random one, projected for this state.
void Stability::begin() {
    if (v_.size() == 0) {
        Eigen::MatrixXd column = scattered(3 * system_->model().free_count());
        solve(column);
        v_ = column;
    }
    keep_constraints(v_);
    p_ = {};
    take(v_, metric_times(v_), stiffness_times(v_));
}

/// Sets the motion, normalised in the norm of M.
void Stability::take(const Eigen::VectorXd& v, const Eigen::VectorXd& Mv, const Eigen::VectorXd& Kv) {
    const double square = v.dot(Mv);
    const double length = square > 0 ? std::sqrt(square) : v.norm();
    // M is not positive there, because of rounding. The sign of K still decides.
    ratio_ = square > 0 ? v.dot(Kv) / square : std::copysign(1.0, v.dot(Kv));
    Eigen::VectorXd motion = v / length;
    Kv_ = Kv / length;
    Mv_ = Mv / length;
    v_ = std::move(motion);
}

/// Minimises over the span of the motion, its preconditioned residual and its last change. False: no improvement.
bool Stability::improve() {
    Eigen::MatrixXd column = Kv_ - ratio_ * Mv_;
    solve(column);
    Eigen::VectorXd w = column;
    keep_constraints(w);
    w -= v_ * Mv_.dot(w);
    Eigen::VectorXd Mw = metric_times(w);
    const double square = w.dot(Mw);
    Eigen::VectorXd Kw = stiffness_times(w);
    if (square < 0 && w.dot(Kw) < 0) return take(w, Mw, Kw), true;
    if (!(square > 1e-24) || !std::isfinite(square)) return false;
    for (Eigen::VectorXd* x : {&w, &Mw, &Kw}) *x /= std::sqrt(square);

    const Eigen::Index count = p_.size() > 0 ? 3 : 2;
    const std::array<const Eigen::VectorXd*, 3> x = {&v_, &w, &p_}, Kx = {&Kv_, &Kw, &Kp_}, Mx = {&Mv_, &Mw, &Mp_};
    Eigen::MatrixXd K(count, count), M(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index j = 0; j < count; ++j) {
            K(i, j) = x[static_cast<std::size_t>(std::max(i, j))]->dot(*Kx[static_cast<std::size_t>(std::min(i, j))]);
            M(i, j) = x[static_cast<std::size_t>(std::max(i, j))]->dot(*Mx[static_cast<std::size_t>(std::min(i, j))]);
        }
    }
    // The last change may be linearly dependent on the other two.
    const Eigen::Index used = count == 3 && linalg::symmetric_eigenpairs(M).values[0] < 1e-8 ? 2 : count;
    const auto eigen = linalg::generalized_eigenpairs(K.topLeftCorner(used, used), M.topLeftCorner(used, used));
    if (!eigen || !(eigen->values[0] < ratio_)) return false;
    const Eigen::VectorXd share = eigen->vectors.col(0);
    const auto change = [&](const auto& list) {
        Eigen::VectorXd sum = share[1] * *list[1];
        if (used == 3) sum += share[2] * *list[2];
        return sum;
    };
    Eigen::VectorXd p = change(x), Kp = change(Kx), Mp = change(Mx);
    v_ = share[0] * v_ + p;
    Kv_ = share[0] * Kv_ + Kp;
    Mv_ = share[0] * Mv_ + Mp;
    ratio_ = eigen->values[0];
    const double length = std::sqrt(std::max(p.dot(Mp), 1e-300));
    p_ = p / length;
    Kp_ = Kp / length;
    Mp_ = Mp / length;
    return true;
}

bool is_jump(Moment before, Moment after, const std::function<bool(double time, State& state)>& solve) {
    const auto distance = [](const Moment& a, const Moment& b) { return (b.state.x - a.state.x).norm(); };
    const double whole = distance(before, after);
    for (int k = 0; k < halvings; ++k) {
        Moment middle{0.5 * (before.along + after.along), before.state};
        if (!solve(middle.along, middle.state)) return false;
        (distance(before, middle) > distance(middle, after) ? after : before) = std::move(middle);
        if (!(distance(before, after) > most_of_it * whole)) return false;
    }
    return true;
}

}  // namespace pliant::sim

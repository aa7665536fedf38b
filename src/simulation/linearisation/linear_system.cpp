#include "simulation/linearisation/linear_system.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/linalg/dense.hpp"
#include "base/linalg/gmres.hpp"
#include "base/linalg/sparse.hpp"
#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

constexpr double allowed_beside_wanted = 10;
constexpr double rounding = 4e-15;        // of |A| |x|: rounding error of storing x and multiplying with it
constexpr double inner_tolerance = 1e-9;  // of one round of GMRES; further rounds refine it
constexpr int most_rounds = 8, most_products = 200;
// With two levels: relative error of x in the norm of K, for each round, or at once if less accuracy is needed.
// Residuals are larger than that; a solve whose residual exceeds the second number has failed.
constexpr double round_tolerance = 1e-4, round_residual = 1e-3;
constexpr double least_tolerance = 1e-6, tolerance_beside_residual = 10, residual_beside_tolerance = 1000;
constexpr int level_rounds = 2, level_limit = 200;
constexpr double column_residual = 1e-11;      // of the columns of the Schur complement
constexpr double columns_beside_wanted = 0.1;  // likewise, where responses are combinations of them
constexpr double off_at_most = 0.1;        // relative error of a fast factor's answer for the vector that it amplifies
                                           // most
constexpr double singular = 1e-14;         // smallest over largest singular value, in balanced units
constexpr double redundant = 1e-11;        // pivots of the Schur complement
constexpr double nearly_redundant = 1e-3;  // likewise, of one in single precision
constexpr double first_shift = 1e-7, shift_growth = 8, largest_shift = 10;  // relative to the diagonal

using linalg::view;

/// Mean size of the diagonal, N/m.
double mean_diagonal(const LinearSystem& system) {
    const linalg::SymmetricPattern& p = system.layout->pattern;
    double sum = 0;
    for (int j = 0; j < p.nodes; ++j) {
        const double* block = system.symmetric.data() + 9 * static_cast<std::size_t>(p.node_start[j]);
        sum += std::fabs(block[0]) + std::fabs(block[4]) + std::fabs(block[8]);
    }
    return sum > 0 ? sum / (3 * p.nodes) : 1;
}

/// `size` over the norm of each column; `size` where that is zero.
Eigen::VectorXd balance(const Eigen::MatrixXd& columns, double size) {
    Eigen::VectorXd scale(columns.cols());
    for (Eigen::Index k = 0; k < columns.cols(); ++k) {
        const double norm = columns.col(k).norm();
        scale[k] = norm > 0 ? size / norm : size;
    }
    return scale;
}

/// A fixed vector of random signs, to test a matrix with.
Eigen::VectorXd some_vector(Eigen::Index size) {
    Eigen::VectorXd v(size);
    unsigned state = 1;
    for (double& entry : v) {
        state = 1664525U * state + 1013904223U;
        entry = static_cast<double>(state) / 4294967296.0 - 0.5;
    }
    return v / v.norm();
}

}  // namespace

struct SystemSolver::WholeFactor {
    explicit WholeFactor(const Eigen::SparseMatrix<double>& matrix) : lu(matrix) {}
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b, Side side) {  // Eigen does not promise const
        if (side == Side::direct) return lu.solve(b);
        return lu.transpose().solve(b);
    }
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu;
};

void add_skew_product(const linalg::SymmetricPattern& p, const std::vector<double>& values, const Eigen::VectorXd& v,
                      double factor, Eigen::VectorXd& result) {
    for (int j = 0; j < p.nodes; ++j) {
        for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k) {
            const int i = p.node_row[k];
            const Eigen::Map<const Eigen::Matrix3d> block(values.data() + 9 * static_cast<std::size_t>(k));
            result.segment<3>(3 * i) += factor * block * v.segment<3>(3 * j);
            if (i != j) result.segment<3>(3 * j) -= factor * block.transpose() * v.segment<3>(3 * i);
        }
    }
}

void LinearSystem::leave_out_held(Eigen::VectorXd& v) const {
    for (const FreeRoller& roller : rollers)
        v.segment<3>(3 * roller.free) = (roller.may_move * v.segment<3>(3 * roller.free)).eval();
}

Eigen::VectorXd LinearSystem::multiply(const Eigen::VectorXd& v, Side side) const {
    const Eigen::Index n = free_size(), m = forces.cols();
    Eigen::VectorXd motion = v.head(n);
    leave_out_held(motion);
    const Eigen::VectorXd multiplier = v.tail(m);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(n);
    linalg::add_product(layout->pattern, symmetric, view(std::as_const(motion)), 1, view(force));
    if (!skew.empty()) add_skew_product(layout->pattern, skew, motion, side == Side::direct ? 1 : -1, force);
    force += (side == Side::direct ? forces : constraints) * multiplier;
    leave_out_held(force);
    Eigen::VectorXd result(n + m);
    result << force,
        (side == Side::direct ? constraints : forces).transpose() * motion + compliance.cwiseProduct(multiplier);
    return result;
}

SystemSolver::~SystemSolver() = default;

SystemSolver::SystemSolver(const LinearSystem& system) : system_(&system) {
    stiffness_ = mean_diagonal(system);
    const Eigen::Index count = system.forces.cols();
    column_ = balance(system.forces, stiffness_);
    row_ = balance(system.constraints, stiffness_);
    for (Eigen::Index k = 0; k < count; ++k) {  // no constraint other than on the multiplier itself
        if (system.constraints.col(k).isZero(0) && system.compliance[k] != 0)
            row_[k] = stiffness_ / std::fabs(system.compliance[k] * column_[k]);
    }
    forces_ = system.forces * column_.asDiagonal();
    constraints_ = system.constraints * row_.asDiagonal();
    compliance_ = row_.cwiseProduct(system.compliance).cwiseProduct(column_);
}

SystemSolver::SystemSolver(const LinearSystem& system, SystemSolver&& other) : SystemSolver(system) {
    if (!other.exact_ || (other.method_ != Method::levels && other.method_ != Method::single_)) return;
    taken_over_ = other.method_;
    factor_ = std::move(other.factor_);
    levels_ = std::move(other.levels_);
    from_forces_ = std::move(other.from_forces_);
    accuracy_ = other.accuracy_;
}

/// Factorises K if it is positive definite; else K with its diagonal increased as far as necessary. False: that fails
/// too.
bool SystemSolver::factorise() {
    linalg::Cholesky& made = factor(linalg::Precision::double_);
    exact_ = made.factorise(system_->symmetric);
    if (exact_) return true;
    const linalg::SymmetricPattern& p = system_->layout->pattern;
    for (double shift = first_shift; shift < largest_shift; shift *= shift_growth) {
        std::vector<double> values = system_->symmetric;
        for (int j = 0; j < p.nodes; ++j) {
            double* block = values.data() + 9 * static_cast<std::size_t>(p.node_start[j]);
            const double size = (std::fabs(block[0]) + std::fabs(block[4]) + std::fabs(block[8])) / 3;
            for (int c = 0; c < 3; ++c) block[4 * c] += shift * std::max(size, 1e-9 * stiffness_);
        }
        if (made.factorise(values)) return true;
    }
    return false;
}

linalg::Cholesky& SystemSolver::factor(linalg::Precision precision) {
    if (!factor_ && system_->analysis)
        factor_ = std::make_unique<linalg::Cholesky>(system_->analysis, 3, precision);
    else if (!factor_)
        factor_ = std::make_unique<linalg::Cholesky>(system_->layout->pattern, precision);
    factor_->use(precision);
    return *factor_;
}

/// Columns (3 free, k) <- K^-1 columns, with the accuracy of the preconditioner; with two levels to level_tolerance()
/// in the norm of K. False: not achieved.
bool SystemSolver::apply_body(Eigen::MatrixXd& columns) const {
    const auto count = static_cast<int>(columns.cols());
    if (levels_)
        return levels_->solve(view(columns), count, level_tolerance(), level_limit) ==
               linalg::TwoLevel::Outcome::solved;
    factor_->solve(view(columns), count);
    return true;
}

/// K^-1 of the right-hand sides, to residuals of `wanted` times theirs; begins at `columns`. False: the fast methods
/// cannot achieve that.
bool SystemSolver::solve_body(const Eigen::MatrixXd& right, double wanted, Eigen::MatrixXd& columns) const {
    Eigen::MatrixXd residual = right;
    const auto take_residual = [&](Eigen::Index k) {
        const Eigen::VectorXd x = columns.col(k);
        Eigen::VectorXd rest = right.col(k);
        linalg::add_product(system_->layout->pattern, system_->symmetric, view(x), -1, view(rest));
        residual.col(k) = rest;
    };
    const auto find_open = [&] {
        std::vector<Eigen::Index> open;
        for (Eigen::Index k = 0; k < right.cols(); ++k) {
            if (!(residual.col(k).norm() <= wanted * right.col(k).norm())) open.push_back(k);
        }
        return open;
    };
    if (!columns.isZero(0)) {
        for (Eigen::Index k = 0; k < right.cols(); ++k) take_residual(k);
    }
    const int rounds = levels_ ? level_rounds : most_rounds;
    std::vector<Eigen::Index> open = find_open();
    for (int round = 0; round < rounds && !open.empty(); ++round, open = find_open()) {
        Eigen::MatrixXd step = residual(Eigen::all, open);  // several columns cost little more than one
        if (!apply_body(step)) return false;
        columns(Eigen::all, open) += step;
        for (const Eigen::Index k : open) take_residual(k);
    }
    return levels_ || open.empty();
}

/// Since the preconditioner replaces K anyway, the columns of the Schur complement need no more accuracy than that,
/// unless actuators are so nearly redundant that rounding hides it. False: only double precision can tell.
bool SystemSolver::take_schur_complement() {
    if (method_ == Method::single_ && take_schur_complement(Columns::rough, nearly_redundant)) return true;
    return take_schur_complement(Columns::fine, redundant);
}

/// For responses to changes of the constraints alone, which are combinations of these columns.
void SystemSolver::improve_columns() {
    if (method_ == Method::single_ && accuracy_ < Columns::wanted)
        (void)take_schur_complement(Columns::wanted, nearly_redundant);
}

/// K^-1 B and K^-1 C. A constraint that is the gradient of what its force acts on has the force's column; the
/// constraint of a slack cable has none.
bool SystemSolver::solve_columns(Columns accuracy) {
    const auto solve = [&](const Eigen::MatrixXd& right, Eigen::MatrixXd& columns) {
        if (method_ == Method::double_ || accuracy == Columns::rough) {
            columns = right;
            return apply_body(columns);
        }
        const double wanted =
            accuracy == Columns::fine ? column_residual : columns_beside_wanted * system_->wanted_residual;
        return solve_body(right, wanted, columns);
    };
    if (accuracy_ < accuracy) {
        if (accuracy_ == Columns::none) from_forces_ = Eigen::MatrixXd::Zero(forces_.rows(), forces_.cols());
        if (!solve(forces_, from_forces_)) {
            accuracy_ = Columns::none;
            return false;
        }
        accuracy_ = accuracy;
    }
    from_constraints_ = from_forces_;
    bool known = true;
    for (Eigen::Index k = 0; k < forces_.cols(); ++k) {
        if (system_->constraints.col(k).isZero(0))
            from_constraints_.col(k).setZero();
        else
            known = known && system_->constraints.col(k) == system_->forces.col(k);
    }
    if (known) return true;
    from_constraints_ = Eigen::MatrixXd::Zero(forces_.rows(), forces_.cols());
    return solve(constraints_, from_constraints_);
}

bool SystemSolver::take_schur_complement(Columns accuracy, double threshold) {
    if (!solve_columns(accuracy)) return false;
    Eigen::MatrixXd S = -constraints_.transpose() * from_forces_;
    S.diagonal() += compliance_;
    schur_inverse_ = schur_null_ = Eigen::MatrixXd(S.rows(), 0);
    if (S.size() == 0) return true;
    // For stiff and soft actuators together: balanced once more, so that each is judged on its own scale.
    Eigen::VectorXd scale = S.diagonal().cwiseAbs().cwiseSqrt();
    for (double& s : scale) s = s > 0 ? 1 / s : 1;
    const Eigen::MatrixXd balanced = scale.asDiagonal() * S * scale.asDiagonal();
    const auto [inverse, rank] = linalg::pseudo_inverse_and_rank(balanced, threshold);
    schur_inverse_ = scale.asDiagonal() * inverse * scale.asDiagonal();
    if (rank == S.cols()) return true;
    if (method_ != Method::double_) return false;
    const Eigen::MatrixXd kept = inverse * balanced;
    schur_null_ = Eigen::MatrixXd::Identity(S.cols(), S.cols()) - kept;
    return true;
}

/// Chooses the fastest method that is accurate enough for this matrix.
void SystemSolver::begin() {
    if (system_->on_levels && system_->skew.empty() && begin_quickly(Method::levels)) return;
    levels_.reset();
    // Rounding errors of single precision cannot be told from a skew part.
    if (system_->skew.empty() && begin_quickly(Method::single_)) return;
    begin_surely();
}

bool SystemSolver::begin_quickly(Method method) {
    method_ = method;
    if (std::exchange(taken_over_, Method::none) != method) {
        accuracy_ = Columns::none;
        if (!make_quickly(method)) return false;
    }
    exact_ = true;
    // Conjugate gradients detect by themselves that they do not converge.
    return take_schur_complement() && (levels_ || is_content() || is_far_from_singular());
}

bool SystemSolver::make_quickly(Method method) {
    if (method == Method::levels) {
        const linalg::SymmetricPattern& pattern = system_->layout->pattern;
        levels_ = system_->corners ? std::make_unique<linalg::TwoLevel>(pattern, *system_->corners)
                                   : std::make_unique<linalg::TwoLevel>(pattern);
        return levels_->set(system_->symmetric, view(system_->positions));
    }
    const bool definite = factor(linalg::Precision::single_).factorise(system_->symmetric);
    factor_->release_work_space();
    return definite;
}

void SystemSolver::begin_surely() {
    method_ = Method::double_;
    accuracy_ = Columns::none;
    const bool begun = factorise();
    factor_->release_work_space();
    if (begun) (void)take_schur_complement();
    singular_ = !begun || (!is_content() && is_singular());
    if (singular_ && schur_null_.cols() == 0) {
        take_whole_factor();
        singular_ = whole_ == nullptr || is_singular();
    }
}

/// Tests the preconditioner on the vector that it amplifies most: for a nearly singular matrix it is not an inverse.
bool SystemSolver::is_far_from_singular() const {
    Eigen::VectorXd v = some_vector(system_->size());
    system_->leave_out_held(v);
    const Eigen::VectorXd once = precondition(v, Side::direct);
    const Eigen::VectorXd back = multiply(precondition(once, Side::direct), Side::direct) - once;
    return back.norm() < off_at_most * once.norm();
}

/// With a loose target residual, the solves themselves show whether they succeed.
bool SystemSolver::is_content() const {
    return system_->wanted_residual > inner_tolerance;
}

/// Error of a two-level solve, in the norm of K.
double SystemSolver::level_tolerance() const {
    if (!is_content()) return round_tolerance;
    return std::max(least_tolerance, tolerance_beside_residual * system_->wanted_residual);
}

/// Relative to the right-hand side: beyond it a solve has failed.
double SystemSolver::allowed_residual() const {
    if (!levels_) return allowed_beside_wanted * system_->wanted_residual;
    return is_content() ? residual_beside_tolerance * level_tolerance() : round_residual;
}

Status SystemSolver::prepare() {
    if (method_ == Method::none) begin();
    if (!singular_) return {};
    return failure(
        "the tangent of this state is singular: it stands at a limit point or at a bifurcation, or a part of the robot "
        "can move without a force; a state a little before or after it has a solution");
}

/// Slow and memory-intensive, but works for any matrix that is not singular.
void SystemSolver::take_whole_factor() {
    const linalg::SymmetricPattern& p = system_->layout->pattern;
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int i, int j, const Eigen::Matrix3d& block) {
        for (int c = 0; c < 3; ++c) {
            for (int r = 0; r < 3; ++r) entries.emplace_back(3 * i + r, 3 * j + c, block(r, c));
        }
    };
    std::vector<Eigen::Matrix3d> may_move(static_cast<std::size_t>(p.nodes), Eigen::Matrix3d::Identity());
    for (const FreeRoller& roller : system_->rollers) may_move[static_cast<std::size_t>(roller.free)] = roller.may_move;
    for (int j = 0; j < p.nodes; ++j) {
        for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k) {
            const std::size_t at = 9 * static_cast<std::size_t>(k);
            const int i = p.node_row[k];
            const Eigen::Matrix3d symmetric = Eigen::Map<const Eigen::Matrix3d>(system_->symmetric.data() + at);
            Eigen::Matrix3d skew = Eigen::Matrix3d::Zero();
            if (!system_->skew.empty())
                skew = may_move[static_cast<std::size_t>(i)] *
                       Eigen::Map<const Eigen::Matrix3d>(system_->skew.data() + at) *
                       may_move[static_cast<std::size_t>(j)];
            add(i, j, symmetric + skew);
            if (i != j) add(j, i, (symmetric - skew).transpose());
        }
    }
    const int n = static_cast<int>(forces_.rows()), m = static_cast<int>(forces_.cols());
    for (int k = 0; k < m; ++k) {
        for (int i = 0; i < n; ++i) {
            if (forces_(i, k) != 0) entries.emplace_back(i, n + k, forces_(i, k));
            if (constraints_(i, k) != 0) entries.emplace_back(n + k, i, constraints_(i, k));
        }
        entries.emplace_back(n + k, n + k, compliance_[k]);
    }
    Eigen::SparseMatrix<double> matrix(n + m, n + m);
    matrix.setFromTriplets(entries.begin(), entries.end());
    auto factor = std::make_shared<WholeFactor>(matrix);
    whole_ = factor->lu.info() == Eigen::Success ? std::move(factor) : nullptr;
}

Eigen::VectorXd SystemSolver::multiply(const Eigen::VectorXd& v, Side side) const {
    const Eigen::Index m = forces_.cols();
    const bool direct = side == Side::direct;
    Eigen::VectorXd scaled = v;
    scaled.tail(m).array() *= (direct ? column_ : row_).array();
    scaled = system_->multiply(scaled, side);
    scaled.tail(m).array() *= (direct ? row_ : column_).array();
    return scaled;
}

Eigen::MatrixXd SystemSolver::precondition(const Eigen::MatrixXd& columns, Side side) const {
    const Eigen::Index n = forces_.rows(), m = forces_.cols();
    const bool direct = side == Side::direct;
    Eigen::MatrixXd result(n + m, columns.cols());
    if (whole_) {
        for (Eigen::Index k = 0; k < columns.cols(); ++k) result.col(k) = whole_->solve(columns.col(k), side);
        return result;
    }
    Eigen::MatrixXd motion = columns.topRows(n);
    if (!motion.isZero(0)) (void)apply_body(motion);  // a failure shows in the residual
    const Eigen::MatrixXd left = columns.bottomRows(m) - (direct ? constraints_ : forces_).transpose() * motion;
    const Eigen::MatrixXd multiplier =
        direct ? Eigen::MatrixXd(schur_inverse_ * left) : Eigen::MatrixXd(schur_inverse_.transpose() * left);
    motion -= (direct ? from_forces_ : from_constraints_) * multiplier;
    result.topRows(n) = motion;
    result.bottomRows(m) = multiplier;
    return result;
}

/// The rounding error of x as a residual of b - A x.
double SystemSolver::rounding_of(const Eigen::VectorXd& x, Side side) const {
    const Eigen::Index n = forces_.rows(), m = forces_.cols();
    std::vector<double> sizes(system_->symmetric.size());
    for (std::size_t k = 0; k < sizes.size(); ++k) {
        sizes[k] = std::fabs(system_->symmetric[k]);
        if (!system_->skew.empty()) sizes[k] += std::fabs(system_->skew[k]);
    }
    const bool direct = side == Side::direct;
    const Eigen::VectorXd motion = x.head(n).cwiseAbs(), multiplier = x.tail(m).cwiseAbs();
    Eigen::VectorXd force = (direct ? forces_ : constraints_).cwiseAbs() * multiplier;
    linalg::add_product(system_->layout->pattern, sizes, view(motion), 1, view(force));
    const Eigen::VectorXd rest = (direct ? constraints_ : forces_).cwiseAbs().transpose() * motion +
                                 compliance_.cwiseAbs().cwiseProduct(multiplier);
    return rounding * std::hypot(force.norm(), rest.norm());
}

/// Correction of x for a residual: by the preconditioner or, if that is not the inverse, by GMRES with it.
Eigen::VectorXd SystemSolver::correction(const Eigen::VectorXd& residual, double wanted, Side side) const {
    if (exact_ && system_->skew.empty()) return precondition(residual, side);
    const double left = residual.norm();
    const auto product = [&](const Eigen::VectorXd& v) { return multiply(precondition(v, side), side); };
    const Eigen::VectorXd step =
        linalg::gmres(product, residual / left, std::max(inner_tolerance, 0.3 * wanted / left), most_products);
    return left * precondition(step, side);
}

/// x in balanced units; empty on failure. `first`: what precondition() gives for b; null: not known.
std::optional<Eigen::VectorXd> SystemSolver::refine(const Eigen::VectorXd& b, Side side,
                                                    const Eigen::VectorXd* first) const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size()), residual = b;
    double left = b.norm();
    const double wanted = system_->wanted_residual * left, allowed = allowed_residual() * left;
    const double enough = levels_ && is_content() ? allowed : wanted;
    const int rounds = levels_ ? level_rounds : most_rounds;
    for (int round = 0; round < rounds && left > enough; ++round) {
        const bool is_known = round == 0 && first != nullptr;
        const Eigen::VectorXd next = is_known ? *first : Eigen::VectorXd(x + correction(residual, wanted, side));
        const Eigen::VectorXd rest = b - multiply(next, side);
        if (!(rest.norm() < left)) break;
        const bool slow = rest.norm() > 0.5 * left;
        x = next;
        residual = rest;
        left = rest.norm();
        if (slow) break;
    }
    if (!(left <= allowed) && !(left <= rounding_of(x, side))) return std::nullopt;
    return x;
}

/// By a step of inverse iteration with A^T A, which shows how large a solution can be relative to the right-hand side.
bool SystemSolver::is_singular() const {
    const Eigen::Index m = forces_.cols();
    Eigen::VectorXd v = some_vector(system_->size());
    system_->leave_out_held(v);
    if (schur_null_.cols() > 0) v.tail(m) -= (schur_null_ * v.tail(m)).eval();
    const auto once = refine(v / v.norm(), Side::direct);
    if (!once) return true;
    const auto twice = refine(*once / once->norm(), Side::transposed);
    return !twice || !(twice->norm() * stiffness_ * singular < 1);
}

/// The error for constraints that cannot all be met.
Error SystemSolver::redundancy() const {
    std::string names;
    int count = 0;
    const double largest = schur_null_.cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < schur_null_.rows(); ++k) {
        if (!(schur_null_.row(k).cwiseAbs().maxCoeff() > 1e-6 * largest)) continue;
        names += (count++ == 0 ? "" : ", ") + system_->multipliers[static_cast<std::size_t>(k)];
    }
    if (count == 1) return {Cause::failed, names + " moves nothing and cannot be given another length or volume"};
    return {Cause::failed, names + " have the same effect but different targets, which cannot be met at once"};
}

/// In balanced units, without what rollers hold.
Eigen::MatrixXd SystemSolver::balanced(const Eigen::MatrixXd& columns, Side side) const {
    Eigen::MatrixXd scaled = columns;
    for (Eigen::Index k = 0; k < columns.cols(); ++k) {
        Eigen::VectorXd column = columns.col(k);
        system_->leave_out_held(column);
        column.tail(forces_.cols()).array() *= (side == Side::direct ? row_ : column_).array();
        scaled.col(k) = column;
    }
    return scaled;
}

Result<Eigen::VectorXd> SystemSolver::solve(const Eigen::VectorXd& b, Side side) {
    if (Status status = prepare(); !status) return tl::unexpected(status.error());
    return solve_balanced(balanced(b, side), side, nullptr);
}

Result<Eigen::MatrixXd> SystemSolver::solve_all(const Eigen::MatrixXd& columns, Side side) {
    if (Status status = prepare(); !status) return tl::unexpected(status.error());
    const Eigen::MatrixXd right = balanced(columns, side);
    if (right.topRows(forces_.rows()).isZero(0)) improve_columns();
    Eigen::MatrixXd firsts, result(columns.rows(), columns.cols());
    const Method begun = method_;
    if (exact_ && system_->skew.empty() && columns.cols() > 1) firsts = precondition(right, side);
    for (Eigen::Index k = 0; k < columns.cols(); ++k) {
        const bool is_known = firsts.size() > 0 && method_ == begun;
        const Eigen::VectorXd first = is_known ? Eigen::VectorXd(firsts.col(k)) : Eigen::VectorXd();
        auto x = solve_balanced(right.col(k), side, is_known ? &first : nullptr);
        if (!x) return tl::unexpected(x.error());
        result.col(k) = *x;
    }
    return result;
}

Result<Eigen::VectorXd> SystemSolver::solve_balanced(const Eigen::VectorXd& b, Side side,
                                                     const Eigen::VectorXd* first) {
    std::optional<Eigen::VectorXd> x = refine(b, side, first);
    if (!x && method_ != Method::double_) {
        levels_.reset();
        begin_surely();
        if (Status status = prepare(); !status) return tl::unexpected(status.error());
        return solve_balanced(b, side, nullptr);
    }
    if (!x && schur_null_.cols() > 0) return tl::unexpected(redundancy());
    if (!x)
        return failure(
            "the tangent of this state is too near to a singular one to be solved with: it stands near a "
            "limit point or a bifurcation");
    x->tail(forces_.cols()).array() *= (side == Side::direct ? column_ : row_).array();
    return std::move(*x);
}

}  // namespace pliant::sim

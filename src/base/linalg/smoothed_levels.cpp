#include "base/linalg/smoothed_levels.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/core/parallel.hpp"
#include "base/linalg/coarse_space.hpp"
#include "base/linalg/dense.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t smoothing_grain = 4096;  // nodes per parallel piece
constexpr int degree = 2;                      // of the smoothing polynomial
constexpr float smoothed_part = 0.06F;  // lower end of the part of the spectrum that is smoothed, of its upper end
constexpr int powers = 12;
constexpr int lanczos_steps = 6;
constexpr float safety_of_powers = 1.15F, safety_of_lanczos = 1.05F;  // both approach from below

/// A start vector with a component of every eigenvector: pseudo-random numbers.
void fill_randomly(Interleaved<float>& v, std::size_t size) {
    unsigned seed = 1;
    for (std::size_t i = 0; i < size; ++i) {
        seed = seed * 1664525U + 1013904223U;
        v[i] = static_cast<float>(seed >> 8) / static_cast<float>(1U << 24) - 0.5F;
    }
}

}  // namespace

SmoothedLevels::SmoothedLevels(const SymmetricPattern& pattern, SymmetricBlocks matrix,
                               std::unique_ptr<CoarseLevel> space, std::unique_ptr<CoarseSolver> coarse, Kind kind)
    : size_(static_cast<std::size_t>(pattern.size())),
      kind_(kind),
      matrix_(std::move(matrix)),
      space_(std::move(space)),
      coarse_(std::move(coarse)),
      inverse_diagonal_(9 * static_cast<std::size_t>(pattern.nodes)),
      coarse_size_(static_cast<std::size_t>(space_->pattern().size())) {
    top_.resize(size_);
    set_columns(1);
}

/// Room for `count` columns; the contents are set by their users.
void SmoothedLevels::set_columns(std::size_t count) {
    columns_ = count;
    for (Rough* v : {&side_, &correction_, &step_, &rest_}) v->resize(count * size_);
    if (count > 1) one_.resize(size_);
    coarse_side_.resize(count * coarse_size_);
}

void SmoothedLevels::take(std::span<const double> values, std::span<const double> positions) {
    matrix_.set(values);
    positions_.assign(positions.begin(), positions.end());
}

void SmoothedLevels::move_towards(std::span<const double> values, double share) {
    matrix_.move_towards(values, share);
}

bool SmoothedLevels::prepare(Reuse reuse) {
    turned_ = built_;  // whatever happens, until there is a coarse level of this matrix
    if (!invert_diagonal()) return false;
    set_columns(1);
    if (built_ && reuse == Reuse::turned && space_->turn(positions_)) {
        raise_largest();
        return true;
    }
    if (built_ && reuse == Reuse::kept && space_->turn_back()) {
        largest_ = largest_of_base_;
        turned_ = false;
        return true;
    }
    find_largest();
    return set_coarse(reuse);
}

/// Makes the coarse level for the present matrix and positions.
bool SmoothedLevels::set_coarse(Reuse reuse) {
    space_->set({matrix_, positions_, inverse_diagonal_.data(), 4.0F / 3 / upper()});
    turned_ = false;
    built_ = coarse_->set(space_->values(), space_->positions(), reuse);
    return built_;
}

bool SmoothedLevels::build() {
    if (!turned_) return coarse_->build();
    find_largest();
    return set_coarse(Reuse::none);
}

bool SmoothedLevels::invert_diagonal() {
    std::vector<char> definite(size_ / 3);
    parallel_for(size_ / 3, smoothing_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Matrix3d block = matrix_.diagonal(static_cast<int>(i));
            Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
            double determinant = 0;
            bool invertible = false;
            block.computeInverseAndDetWithCheck(inverse, determinant, invertible, 0);
            // Sylvester's criterion: the leading minors are positive. The second is inverse(2, 2) times the third.
            definite[i] = block(0, 0) > 0 && determinant > 0 && inverse(2, 2) > 0 ? 1 : 0;
            Eigen::Map<Eigen::Matrix3f>(inverse_diagonal_.data() + 9 * i) = inverse.cast<float>();
        }
    });
    return std::all_of(definite.begin(), definite.end(), [](char d) { return d != 0; });
}

void SmoothedLevels::apply_inverse_diagonal(const Rough& from, Rough& to) const {
    parallel_for(size_ / 3, smoothing_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Map<const Eigen::Matrix3f> inverse(inverse_diagonal_.data() + 9 * i);
            Eigen::Map<Eigen::Vector3f>(to.data() + 3 * i).noalias() =
                inverse * Eigen::Map<const Eigen::Vector3f>(from.data() + 3 * i);
        }
    });
}

void SmoothedLevels::find_largest() {
    if (kind_ == Kind::groups)
        find_largest_by_powers();
    else
        find_largest_by_lanczos();
}

/// Power iteration with D^-1 A, in the inner product of D. Independent of earlier matrices.
void SmoothedLevels::find_largest_by_powers() {
    fill_randomly(top_, size_);
    for (int k = 0; k < powers; ++k) {
        largest_ = step_of_powers();
        for_numbers(size_, [&](std::size_t i) { top_[i] = step_[i] / -largest_; });
    }
    largest_of_base_ = largest_;
}

/// The eigenvalue for a matrix near that of the coarse level.
void SmoothedLevels::raise_largest() {
    largest_ = std::max(largest_of_base_, step_of_powers());
}

/// step <- -D^-1 A top; returns its length, which is that of the eigenvalue once top has length 1.
float SmoothedLevels::step_of_powers() {
    std::fill_n(side_.data(), size_, 0.0F);
    std::copy_n(top_.data(), size_, correction_.data());
    advance(correction_, Start::where_it_is, 0, 1);
    return static_cast<float>(std::sqrt(dot(step_, step_, size_)));
}

/// Lanczos with D^-1 A, in the inner product of D, plus the error that it knows of: where a surface begins to wrinkle,
/// one eigenvalue lies far beyond the others, and powers would take dozens of products to find it. Independent of
/// earlier matrices.
void SmoothedLevels::find_largest_by_lanczos() {
    // The vectors v of the basis are orthonormal in D. correction: v; rest: A v; top: D v; side: D times the v before.
    Eigen::MatrixXd projected = Eigen::MatrixXd::Zero(lanczos_steps, lanczos_steps);
    fill_randomly(top_, size_);
    std::fill_n(side_.data(), size_, 0.0F);
    apply_inverse_diagonal(top_, correction_);
    double norm = std::sqrt(dot(top_, correction_, size_));
    int steps = 0;
    while (steps < lanczos_steps && norm > 0) {
        const float shrink = static_cast<float>(1 / norm), before = steps > 0 ? static_cast<float>(norm) : 0.0F;
        for_numbers(size_, [&](std::size_t i) {
            top_[i] *= shrink;
            correction_[i] *= shrink;
        });
        matrix_.multiply(correction_.data(), rest_.data());
        const double own = dot(correction_, rest_, size_);
        for_numbers(size_, [&](std::size_t i) {
            const float now = top_[i];
            top_[i] = rest_[i] - static_cast<float>(own) * now - before * side_[i];
            side_[i] = now;
        });
        apply_inverse_diagonal(top_, correction_);
        norm = std::sqrt(std::max(dot(top_, correction_, size_), 0.0));
        projected(steps, steps) = own;
        if (++steps < lanczos_steps) projected(steps, steps - 1) = norm;
    }
    if (steps == 0) return;
    const Eigenpairs pairs = symmetric_eigenpairs(projected.topLeftCorner(steps, steps));
    largest_ = static_cast<float>(pairs.values[steps - 1] + norm * std::fabs(pairs.vectors(steps - 1, steps - 1)));
}

float SmoothedLevels::upper() const {
    return (kind_ == Kind::groups ? safety_of_powers : safety_of_lanczos) * largest_;
}

/// x <- x + p(D^-1 A) D^-1 (side - A x), p the Chebyshev polynomial for the upper part of the spectrum
/// (Adams, Brezina, Hu and Tuminaro 2003).
void SmoothedLevels::smoothe(Rough& x, Start start) {
    const float upper = this->upper(), lower = smoothed_part * upper;
    const float middle = (upper + lower) / 2, half = (upper - lower) / 2;
    float rho = half / middle;
    for (int k = 0; k < degree; ++k) {
        if (k == 0) {
            advance(x, start, 0, 1 / middle);
            continue;
        }
        const float next = 1 / (2 * middle / half - rho);
        advance(x, Start::where_it_is, next * rho, 2 * next / half);
        rho = next;
    }
}

/// step <- keep step + share D^-1 (side - A x); x <- x + step. In one pass per node, whose numbers are all read before
/// any is written: arrays on huge pages may have addresses that are equal in their lower bits, so that the processor
/// mistakes a load for one that depends on a store, and stalls.
void SmoothedLevels::advance(Rough& x, Start start, float keep, float share) {
    if (columns_ == 1)
        advance_columns<1>(x, start, keep, share);
    else
        advance_columns<most_columns>(x, start, keep, share);
}

template <std::size_t count>
void SmoothedLevels::advance_columns(Rough& x, Start start, float keep, float share) {
    using Block = Eigen::Matrix<float, count, 3>;  // one per column: numbers of a component are contiguous
    using At = Eigen::Map<Block>;
    const bool from_zero = start == Start::zero;
    if (!from_zero) matrix_.multiply(x.data(), rest_.data(), static_cast<int>(count));
    parallel_for(size_ / 3, smoothing_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t at = 3 * count * i;
            Block left = At(side_.data() + at), now = Block::Zero(), go = Block::Zero();
            if (!from_zero) {
                left -= At(rest_.data() + at);
                now = At(x.data() + at);
            }
            if (keep != 0) go = keep * At(step_.data() + at);
            // The inverse of a diagonal block is symmetric.
            const Eigen::Map<const Eigen::Matrix3f> inverse(inverse_diagonal_.data() + 9 * i);
            for (int c = 0; c < 3; ++c) {
                const Eigen::Matrix<float, count, 1> sum =
                    left.col(0) * inverse(c, 0) + left.col(1) * inverse(c, 1) + left.col(2) * inverse(c, 2);
                go.col(c) += share * sum;
            }
            now += go;
            At(step_.data() + at) = go;
            At(x.data() + at) = now;
        }
    });
}

/// Correction on the coarse level for the remainder of `side`, in `rest`.
void SmoothedLevels::correct() {
    for (std::size_t c = 0; c < columns_; ++c) {
        Rough& fine = columns_ == 1 ? rest_ : one_;
        if (columns_ > 1) for_numbers(size_, [&](std::size_t i) { one_[i] = rest_[columns_ * i + c]; });
        space_->restrict(fine.data(), coarse_side_.data() + c * coarse_size_);
    }
    coarse_->solve({coarse_side_.data(), columns_ * coarse_size_}, static_cast<int>(columns_));
    for (std::size_t c = 0; c < columns_; ++c) {
        const double* from = coarse_side_.data() + c * coarse_size_;
        if (columns_ == 1) {
            space_->add_prolonged(from, correction_.data());
            continue;
        }
        for_numbers(size_, [&](std::size_t i) { one_[i] = 0; });
        space_->add_prolonged(from, one_.data());
        for_numbers(size_, [&](std::size_t i) { correction_[columns_ * i + c] += one_[i]; });
    }
}

const Interleaved<float>& SmoothedLevels::apply(const Interleaved<double>& right, std::size_t columns) {
    set_columns(columns);
    const std::size_t all = columns * size_;
    for_numbers(all, [&](std::size_t i) { side_[i] = static_cast<float>(right[i]); });
    smoothe(correction_, Start::zero);
    matrix_.multiply(correction_.data(), rest_.data(), static_cast<int>(columns));
    for_numbers(all, [&](std::size_t i) { rest_[i] = side_[i] - rest_[i]; });
    correct();
    smoothe(correction_, Start::where_it_is);
    return correction_;
}

SmoothedLevels levels_on_groups(const SymmetricPattern& pattern) {
    SymmetricBlocks blocks(pattern);
    auto groups = std::make_unique<CoarseSpace>(blocks);
    auto factor = make_factored_solver(groups->pattern());
    return {pattern, std::move(blocks), std::move(groups), std::move(factor), SmoothedLevels::Kind::groups};
}

SmoothedLevels levels_on_corners(const SymmetricPattern& pattern, Nesting corners, int most_factored) {
    auto space = std::make_unique<NestedSpace>(pattern, std::move(corners));
    auto coarse = space->pattern().nodes > most_factored ? make_grouped_solver(space->pattern())
                                                         : make_factored_solver(space->pattern());
    return {pattern, SymmetricBlocks(pattern), std::move(space), std::move(coarse), SmoothedLevels::Kind::corners};
}

}  // namespace pliant::linalg

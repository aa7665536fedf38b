#include "base/linalg/two_level.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/core/parallel.hpp"
#include "base/linalg/block_rows.hpp"
#include "base/linalg/cholesky.hpp"
#include "base/linalg/coarse_space.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t grain = 4096;     // numbers per parallel piece
constexpr int degree = 2;               // of the smoothing polynomial
constexpr float smoothed_part = 0.06F;  // lower end of the part of the spectrum that is smoothed, of its upper end
constexpr int first_powers = 12, later_powers = 1;
constexpr int powers_of_corners = 6;  // always the same number: results of earlier solves must not change them
/// Cost of making a coarse level, in iterations (measured), and the number of iterations after which its quality shows.
constexpr double price_of_coarse = 7;
constexpr int iterations_to_judge = 4;
constexpr float safety_of_groups = 1.15F, safety_of_corners = 1.25F;  // power iteration approaches from below

constexpr std::size_t most_columns = 2;  // solved for together: each number of the matrix is read for both

/// Numbers of all nodes, those of several columns interleaved, followed by two that are read but not used.
template <class Real>
class Numbers {
public:
    void resize(std::size_t size) {
        if (values_.size() == size + 2) return;
        values_.resize(size + 2);
        std::fill_n(values_.data(), size + 2, Real(0));
    }
    [[nodiscard]] Real* data() const { return values_.data(); }
    [[nodiscard]] Real& operator[](std::size_t i) const { return values_[i]; }

private:
    AlignedArray<Real> values_;
};
using Vector = Numbers<double>;  ///< of the iteration
using Rough = Numbers<float>;    ///< of its preconditioner

using PerColumn = std::array<double, most_columns>;

template <class Body>
void for_numbers(std::size_t size, const Body& body) {
    parallel_for(size, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
    });
}

}  // namespace

struct TwoLevel::State {
    enum class Kind { groups, corners };
    State(const SymmetricPattern& pattern, BlockRows rows, std::unique_ptr<CoarseLevel> level, Kind of)
        : size(static_cast<std::size_t>(pattern.size())),
          kind(of),
          matrix(std::move(rows)),
          space(std::move(level)),
          safety(kind == Kind::groups ? safety_of_groups : safety_of_corners),
          coarse(space->pattern(), Precision::single_),
          inverse_diagonal(9 * static_cast<std::size_t>(pattern.nodes)),
          coarse_size(static_cast<std::size_t>(space->pattern().size())) {
        top.resize(size);
        set_columns(1);
    }

    /// Room for `count` columns; the contents are set by their users.
    void set_columns(std::size_t count) {
        columns = count;
        for (Vector* v : {&residual, &direction, &product, &solution}) v->resize(count * size);
        for (Rough* v : {&side, &correction, &step, &rest}) v->resize(count * size);
        if (count > 1) one.resize(size);
        coarse_side.resize(count * coarse_size);
    }
    template <class A, class B>
    [[nodiscard]] double dot(const Numbers<A>& a, const Numbers<B>& b, std::size_t column) const {
        return parallel_sum(size, grain, [&](std::size_t begin, std::size_t end) {
            double sum = 0;
            for (std::size_t i = begin * columns + column; i < end * columns; i += columns)
                sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
            return sum;
        });
    }

    [[nodiscard]] bool invert_diagonal();
    void find_largest();
    enum class Start { zero, where_it_is };
    void smoothe(Rough& x, Start start);
    void advance(Rough& x, Start start, float keep, float share);
    template <std::size_t count>
    void advance_columns(Rough& x, Start start, float keep, float share);
    void correct();
    void precondition();
    [[nodiscard]] bool build();
    [[nodiscard]] bool is_outdated(int spent, double begun, double now, double enough) const;
    [[nodiscard]] Outcome iterate(double tolerance, PerColumn& enough, int limit);
    [[nodiscard]] Outcome solve(double* right_hand_sides, std::size_t count, double tolerance, int limit);

    std::size_t size;
    Kind kind;
    std::size_t columns = 1;
    BlockRows matrix;
    std::unique_ptr<CoarseLevel> space;
    float safety;
    Cholesky coarse;
    AlignedArray<float> inverse_diagonal;
    std::size_t coarse_size;
    std::vector<double> coarse_side;  ///< (columns, coarse unknowns)
    Rough top;                        ///< approximate eigenvector of D^-1 A for the largest eigenvalue
    float largest = 0;
    bool powered = false;
    Vector residual, direction, product, solution;
    Rough side, correction, step, rest;
    Rough one;                       ///< work space for a single column
    std::span<const double> values;  ///< of the matrix, during set()
    std::vector<double> positions;   ///< current node positions
    bool built = false;              ///< the coarse level exists,
    bool turned = false;             ///< but was made for an earlier state
    /// Reduction of the squared error per iteration with an up-to-date coarse level, as a logarithm: four to five
    /// iterations per digit, until measured.
    double usual_gain = 1;
    int iterations = 0;
};

bool TwoLevel::State::invert_diagonal() {
    std::vector<char> definite(size / 3);
    parallel_for(size / 3, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Matrix3d block = matrix.diagonal(static_cast<int>(i));
            const Eigen::LLT<Eigen::Matrix3d> llt(block);
            definite[i] = llt.info() == Eigen::Success ? 1 : 0;
            Eigen::Map<Eigen::Matrix3f>(inverse_diagonal.data() + 9 * i) = block.inverse().cast<float>();
        }
    });
    return std::all_of(definite.begin(), definite.end(), [](char d) { return d != 0; });
}

/// Power iteration with D^-1 A, in the inner product of D.
void TwoLevel::State::find_largest() {
    set_columns(1);
    const bool goes_on = powered && kind == Kind::groups;
    const int powers = goes_on ? later_powers : kind == Kind::groups ? first_powers : powers_of_corners;
    if (!goes_on) {
        largest = 0;
        // A start vector with a component of every eigenvector: pseudo-random numbers.
        unsigned seed = 1;
        for (std::size_t i = 0; i < size; ++i) {
            seed = seed * 1664525U + 1013904223U;
            top[i] = static_cast<float>(seed >> 8) / static_cast<float>(1U << 24) - 0.5F;
        }
    }
    std::fill_n(side.data(), size, 0.0F);
    for (int k = 0; k < powers; ++k) {
        std::copy_n(top.data(), size, correction.data());
        advance(correction, Start::where_it_is, 0, 1);  // step: -D^-1 A top
        const double squared = dot(step, step, 0);
        largest = std::max(goes_on ? largest : 0, static_cast<float>(std::sqrt(squared / dot(top, top, 0))));
        const float shrink = static_cast<float>(-1 / std::sqrt(squared));
        for_numbers(size, [&](std::size_t i) { top[i] = shrink * step[i]; });
    }
    powered = true;
}

/// x <- x + p(D^-1 A) D^-1 (side - A x), p the Chebyshev polynomial for the upper part of the spectrum
/// (Adams, Brezina, Hu and Tuminaro 2003).
void TwoLevel::State::smoothe(Rough& x, Start start) {
    const float upper = safety * largest, lower = smoothed_part * upper;
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
void TwoLevel::State::advance(Rough& x, Start start, float keep, float share) {
    if (columns == 1)
        advance_columns<1>(x, start, keep, share);
    else
        advance_columns<most_columns>(x, start, keep, share);
}

template <std::size_t count>
void TwoLevel::State::advance_columns(Rough& x, Start start, float keep, float share) {
    using Block = Eigen::Matrix<float, count, 3>;  // one per column: numbers of a component are contiguous
    using At = Eigen::Map<Block>;
    const bool from_zero = start == Start::zero;
    if (!from_zero) matrix.multiply(x.data(), rest.data(), static_cast<int>(count));
    parallel_for(size / 3, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t at = 3 * count * i;
            Block left = At(side.data() + at), now = Block::Zero(), go = Block::Zero();
            if (!from_zero) {
                left -= At(rest.data() + at);
                now = At(x.data() + at);
            }
            if (keep != 0) go = keep * At(step.data() + at);
            // The inverse of a diagonal block is symmetric.
            const Eigen::Map<const Eigen::Matrix3f> inverse(inverse_diagonal.data() + 9 * i);
            for (int c = 0; c < 3; ++c) {
                const Eigen::Matrix<float, count, 1> sum =
                    left.col(0) * inverse(c, 0) + left.col(1) * inverse(c, 1) + left.col(2) * inverse(c, 2);
                go.col(c) += share * sum;
            }
            now += go;
            At(step.data() + at) = go;
            At(x.data() + at) = now;
        }
    });
}

/// Correction on the coarse level for the remainder of `side`, in `rest`.
void TwoLevel::State::correct() {
    for (std::size_t c = 0; c < columns; ++c) {
        Rough& fine = columns == 1 ? rest : one;
        if (columns > 1) for_numbers(size, [&](std::size_t i) { one[i] = rest[columns * i + c]; });
        space->restrict(fine.data(), coarse_side.data() + c * coarse_size);
    }
    coarse.solve({coarse_side.data(), columns * coarse_size}, static_cast<int>(columns));
    for (std::size_t c = 0; c < columns; ++c) {
        const double* from = coarse_side.data() + c * coarse_size;
        if (columns == 1) {
            space->add_prolonged(from, correction.data());
            continue;
        }
        for_numbers(size, [&](std::size_t i) { one[i] = 0; });
        space->add_prolonged(from, one.data());
        for_numbers(size, [&](std::size_t i) { correction[columns * i + c] += one[i]; });
    }
}

/// correction <- approximately A^-1 residual: smooth, correct on the coarse level, smooth; symmetric.
void TwoLevel::State::precondition() {
    const std::size_t all = columns * size;
    for_numbers(all, [&](std::size_t i) { side[i] = static_cast<float>(residual[i]); });
    smoothe(correction, Start::zero);
    matrix.multiply(correction.data(), rest.data(), static_cast<int>(columns));
    for_numbers(all, [&](std::size_t i) { rest[i] = side[i] - rest[i]; });
    correct();
    smoothe(correction, Start::where_it_is);
}

/// Builds the coarse level for the present matrix and positions.
bool TwoLevel::State::build() {
    space->set({matrix, values, positions, inverse_diagonal.data(), 4.0F / 3 / (safety * largest)});
    turned = false;
    if (kind == Kind::corners && coarse.precision() == Precision::double_) coarse.use(Precision::single_);
    // A body that bends easily may be too ill-conditioned for single precision; once it is, it stays in double, with
    // groups.
    built = coarse.factorise(space->values());
    if (!built && coarse.precision() == Precision::single_) {
        coarse.use(Precision::double_);
        built = coarse.factorise(space->values());
    }
    coarse.release_work_space();
    return built;
}

/// True if a new coarse level would pay: the present one reduced the squared error from `begun` to `now`, and is to
/// reduce it to `enough`.
bool TwoLevel::State::is_outdated(int spent, double begun, double now, double enough) const {
    if (!turned || spent < iterations_to_judge) return false;
    const double gain = std::log(begun / now) / spent, to_go = std::log(now / enough);
    return gain <= 0 || to_go / gain > to_go / usual_gain + price_of_coarse;
}

/// Iterates from `solution` and `residual` until the squared error of each column, in the norm of the preconditioner,
/// is at most `enough`; 0: to be set from the first one. A converged column is not changed any more.
TwoLevel::Outcome TwoLevel::State::iterate(double tolerance, PerColumn& enough, int limit) {
    const std::size_t all = columns * size;
    precondition();
    for_numbers(all, [&](std::size_t i) { direction[i] = correction[i]; });
    PerColumn left{}, begun{};
    std::array<bool, most_columns> done{};
    for (std::size_t c = 0; c < columns; ++c) {
        begun[c] = left[c] = dot(residual, correction, c);
        if (!(left[c] >= 0)) return Outcome::slow;
        if (enough[c] == 0)
            enough[c] = tolerance * tolerance * left[c];
        else
            done[c] = left[c] <= enough[c];
        done[c] = done[c] || left[c] == 0;  // converged from the start
    }
    const auto all_done = [&] { return std::all_of(done.begin(), done.begin() + columns, [](bool d) { return d; }); };
    for (int k = 1; k <= limit && !all_done(); ++k) {
        matrix.multiply(direction.data(), product.data(), static_cast<int>(columns));
        PerColumn advance{}, keep{};
        for (std::size_t c = 0; c < columns; ++c) {
            if (done[c]) continue;
            ++iterations;
            const double curvature = dot(direction, product, c);
            if (!(curvature > 0)) return Outcome::indefinite;
            advance[c] = left[c] / curvature;
        }
        for_numbers(size, [&](std::size_t i) {
            for (std::size_t c = 0; c < columns; ++c) {
                solution[columns * i + c] += advance[c] * direction[columns * i + c];
                residual[columns * i + c] -= advance[c] * product[columns * i + c];
            }
        });
        precondition();
        for (std::size_t c = 0; c < columns; ++c) {
            if (done[c]) continue;
            const double now = dot(residual, correction, c);
            if (now <= enough[c] && now >= 0) {
                if (!turned && now > 0) usual_gain = std::log(begun[c] / now) / k;
                done[c] = true;
                continue;
            }
            if (!(now > 0) || is_outdated(k, begun[c], now, enough[c])) return Outcome::slow;
            keep[c] = now / left[c];
            left[c] = now;
        }
        for_numbers(size, [&](std::size_t i) {
            for (std::size_t c = 0; c < columns; ++c) {
                if (!done[c])
                    direction[columns * i + c] = correction[columns * i + c] + keep[c] * direction[columns * i + c];
            }
        });
    }
    return all_done() ? Outcome::solved : Outcome::slow;
}

TwoLevel::Outcome TwoLevel::State::solve(double* b, std::size_t count, double tolerance, int limit) {
    set_columns(count);
    PerColumn scale{}, enough{};  // forces may be of any magnitude; single precision is not
    for (std::size_t c = 0; c < count; ++c) {
        const double* column = b + c * size;
        for (std::size_t i = 0; i < size; ++i) scale[c] = std::max(scale[c], std::fabs(column[i]));
        for_numbers(size, [&](std::size_t i) {
            residual[count * i + c] = scale[c] > 0 ? column[i] / scale[c] : 0;
            solution[count * i + c] = 0;
        });
    }
    if (std::all_of(scale.begin(), scale.end(), [](double s) { return s == 0; })) return Outcome::solved;
    Outcome outcome = iterate(tolerance, enough, limit);
    if (outcome == Outcome::slow && turned) {
        outcome = build() ? iterate(tolerance, enough, limit) : Outcome::indefinite;
    }
    for (std::size_t c = 0; c < count; ++c)
        for_numbers(size, [&](std::size_t i) { b[c * size + i] = scale[c] * solution[count * i + c]; });
    return outcome;
}

TwoLevel::TwoLevel(const SymmetricPattern& pattern) {
    BlockRows rows(pattern);
    auto level = std::make_unique<CoarseSpace>(rows);
    state_ = std::make_unique<State>(pattern, std::move(rows), std::move(level), State::Kind::groups);
}
TwoLevel::TwoLevel(const SymmetricPattern& pattern, Nesting corners)
    : state_(std::make_unique<State>(pattern, BlockRows(pattern),
                                     std::make_unique<NestedSpace>(pattern, std::move(corners)),
                                     State::Kind::corners)) {}
TwoLevel::TwoLevel(TwoLevel&&) noexcept = default;
TwoLevel& TwoLevel::operator=(TwoLevel&&) noexcept = default;
TwoLevel::~TwoLevel() = default;

bool TwoLevel::set(std::span<const double> values, std::span<const double> positions) {
    State& s = *state_;
    s.matrix.set(values);
    s.values = values;
    s.positions.assign(positions.begin(), positions.end());
    if (!s.invert_diagonal()) return false;
    s.find_largest();
    if (!s.built || !s.space->turn(positions)) return s.build();
    s.turned = true;
    return true;
}

TwoLevel::Outcome TwoLevel::solve(std::span<double> right_hand_sides, int columns, double tolerance, int limit) {
    state_->iterations = 0;
    Outcome worst = Outcome::solved;
    const auto all = static_cast<std::size_t>(columns);
    for (std::size_t c = 0; c < all && worst != Outcome::indefinite; c += most_columns) {
        const std::size_t count = std::min(most_columns, all - c);
        const Outcome outcome = state_->solve(right_hand_sides.data() + c * state_->size, count, tolerance, limit);
        if (outcome != Outcome::solved) worst = outcome;
    }
    return worst;
}

int TwoLevel::iterations() const {
    return state_->iterations;
}

}  // namespace pliant::linalg

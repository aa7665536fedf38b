#include "base/linalg/two_level.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/core/parallel.hpp"
#include "base/linalg/block_rows.hpp"
#include "base/linalg/cholesky.hpp"
#include "base/linalg/coarse_space.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t grain = 4096;     // numbers that one core takes at a time
constexpr int degree = 2;               // of the polynomial that smooths
constexpr float smoothed_part = 0.06F;  // of the spectrum, from the top; the rest is for the coarse level
constexpr int first_powers = 12, later_powers = 1;
/// Iterations that a coarse level costs to make (measured), and after how many it shows how good one is.
constexpr double price_of_coarse = 7;
constexpr int iterations_to_judge = 4;
constexpr float safety = 1.15F;  // powers come from below

/// Numbers of all nodes, with one more that is read but does not count.
template <class Real>
class Numbers {
public:
    explicit Numbers(std::size_t size) : values_(size + 1), size_(size) {
        std::fill_n(values_.data(), size + 1, Real(0));
    }
    [[nodiscard]] Real* data() const { return values_.data(); }
    [[nodiscard]] Real& operator[](std::size_t i) const { return values_[i]; }
    [[nodiscard]] std::size_t size() const { return size_; }

private:
    AlignedArray<Real> values_;
    std::size_t size_;
};
using Vector = Numbers<double>;  ///< of the iteration
using Rough = Numbers<float>;    ///< of its preconditioner

template <class A, class B>
double dot(const Numbers<A>& a, const Numbers<B>& b) {
    return parallel_sum(a.size(), grain, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
        return sum;
    });
}

template <class Body>
void for_numbers(std::size_t size, const Body& body) {
    parallel_for(size, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
    });
}

}  // namespace

struct TwoLevel::State {
    explicit State(const SymmetricPattern& pattern)
        : size(static_cast<std::size_t>(pattern.size())),
          matrix(pattern),
          space(matrix),
          coarse(space.pattern(), Precision::single_),
          inverse_diagonal(9 * static_cast<std::size_t>(pattern.nodes)),
          coarse_side(static_cast<std::size_t>(space.pattern().size())),
          top(size),
          residual(size),
          direction(size),
          product(size),
          solution(size),
          side(size),
          correction(size),
          step(size),
          rest(size) {}

    [[nodiscard]] bool invert_diagonal();
    void find_largest();
    enum class Start { zero, where_it_is };
    void smoothe(Rough& x, Start start);
    void advance(Rough& x, Start start, float keep, float share);
    void precondition();
    [[nodiscard]] bool build();
    [[nodiscard]] bool is_outdated(int spent, double begun, double now, double enough) const;
    [[nodiscard]] Outcome iterate(double tolerance, double& enough, int limit);
    [[nodiscard]] Outcome solve(double* right_hand_side, double tolerance, int limit);

    std::size_t size;
    BlockRows matrix;
    CoarseSpace space;
    Cholesky coarse;
    AlignedArray<float> inverse_diagonal;
    std::vector<double> coarse_side;
    Rough top;  ///< eigenvector of D^-1 A with the largest eigenvalue, roughly
    float largest = 0;
    bool powered = false;
    Vector residual, direction, product, solution;
    Rough side, correction, step, rest;
    std::vector<double> positions;  ///< of the nodes, now
    bool built = false;             ///< the coarse level is there,
    bool turned = false;            ///< but of an earlier state
    /// Of the squared error, by an iteration with one of the present state, as a logarithm: four to five a digit, until
    /// one has shown.
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

/// Powers of D^-1 A, in the inner product of D.
void TwoLevel::State::find_largest() {
    if (!powered) {
        // Anything that has a share of every eigenvector: numbers without a pattern.
        unsigned seed = 1;
        for (std::size_t i = 0; i < size; ++i) {
            seed = seed * 1664525U + 1013904223U;
            top[i] = static_cast<float>(seed >> 8) / static_cast<float>(1U << 24) - 0.5F;
        }
    }
    std::fill_n(side.data(), size, 0.0F);
    for (int k = 0; k < (powered ? later_powers : first_powers); ++k) {
        std::copy_n(top.data(), size, correction.data());
        advance(correction, Start::where_it_is, 0, 1);  // step: -D^-1 A top
        largest = std::max(powered ? largest : 0, static_cast<float>(std::sqrt(dot(step, step) / dot(top, top))));
        const float shrink = static_cast<float>(-1 / std::sqrt(dot(step, step)));
        for_numbers(size, [&](std::size_t i) { top[i] = shrink * step[i]; });
    }
    powered = true;
}

/// x <- x + p(D^-1 A) D^-1 (side - A x), p the Chebyshev polynomial of the upper part of the spectrum
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

/// step <- keep step + share D^-1 (side - A x); x <- x + step. In one pass for each node, its numbers read before any
/// is written: arrays on big pages lie so that a processor takes the one for the other, and waits.
void TwoLevel::State::advance(Rough& x, Start start, float keep, float share) {
    using Three = Eigen::Map<Eigen::Vector3f>;
    const bool from_zero = start == Start::zero;
    if (!from_zero) matrix.multiply(x.data(), rest.data());
    parallel_for(size / 3, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Eigen::Vector3f left = Three(side.data() + 3 * i), now = Eigen::Vector3f::Zero(), go = now;
            if (!from_zero) {
                left -= Three(rest.data() + 3 * i);
                now = Three(x.data() + 3 * i);
            }
            if (keep != 0) go = keep * Three(step.data() + 3 * i);
            go += share * (Eigen::Map<const Eigen::Matrix3f>(inverse_diagonal.data() + 9 * i) * left).eval();
            now += go;
            Three(step.data() + 3 * i) = go;
            Three(x.data() + 3 * i) = now;
        }
    });
}

/// correction <- about A^-1 residual: smooth, correct on the coarse level, smooth; symmetric.
void TwoLevel::State::precondition() {
    for_numbers(size, [&](std::size_t i) { side[i] = static_cast<float>(residual[i]); });
    smoothe(correction, Start::zero);
    matrix.multiply(correction.data(), rest.data());
    for_numbers(size, [&](std::size_t i) { rest[i] = side[i] - rest[i]; });
    space.restrict(rest.data(), coarse_side.data());
    coarse.solve(coarse_side, 1);
    space.add_prolonged(coarse_side.data(), correction.data());
    smoothe(correction, Start::where_it_is);
}

/// Coarse level of the matrix and the positions at hand.
bool TwoLevel::State::build() {
    space.set(matrix, positions, inverse_diagonal.data(), 4.0F / 3 / (safety * largest));
    turned = false;
    // What bends easily may be too much for single precision; once is enough to know.
    built = coarse.factorise(space.values());
    if (!built && coarse.precision() == Precision::single_) {
        coarse.use(Precision::double_);
        built = coarse.factorise(space.values());
    }
    coarse.release_work_space();
    return built;
}

/// True if a coarse level of the present state would pay: the one at hand brought the squared error from `begun` to
/// `now` and is to bring it to `enough`.
bool TwoLevel::State::is_outdated(int spent, double begun, double now, double enough) const {
    if (!turned || spent < iterations_to_judge) return false;
    const double gain = std::log(begun / now) / spent, to_go = std::log(now / enough);
    return gain <= 0 || to_go / gain > to_go / usual_gain + price_of_coarse;
}

/// From where `solution` and `residual` are; `enough` of the squared error, as the preconditioner measures it, is left
/// at the end. 0: the first one shall set it.
TwoLevel::Outcome TwoLevel::State::iterate(double tolerance, double& enough, int limit) {
    precondition();
    for_numbers(size, [&](std::size_t i) { direction[i] = correction[i]; });
    double left = dot(residual, correction);
    if (enough == 0) enough = tolerance * tolerance * left;
    if (!(left > 0)) return Outcome::slow;
    const double begun = left;
    for (int k = 1; k <= limit; ++k) {
        ++iterations;
        matrix.multiply(direction.data(), product.data());
        const double curvature = dot(direction, product);
        if (!(curvature > 0)) return Outcome::indefinite;
        const double advance = left / curvature;
        for_numbers(size, [&](std::size_t i) {
            solution[i] += advance * direction[i];
            residual[i] -= advance * product[i];
        });
        precondition();
        const double now = dot(residual, correction);
        if (now <= enough && now >= 0) {
            if (!turned) usual_gain = std::log(begun / now) / k;
            return Outcome::solved;
        }
        if (!(now > 0) || is_outdated(k, begun, now, enough)) return Outcome::slow;
        const double keep = now / left;
        for_numbers(size, [&](std::size_t i) { direction[i] = correction[i] + keep * direction[i]; });
        left = now;
    }
    return Outcome::slow;
}

TwoLevel::Outcome TwoLevel::State::solve(double* b, double tolerance, int limit) {
    double scale = 0;  // forces may be of any size; single precision is not
    for (std::size_t i = 0; i < size; ++i) scale = std::max(scale, std::fabs(b[i]));
    if (scale == 0) return Outcome::solved;
    for_numbers(size, [&](std::size_t i) {
        residual[i] = b[i] / scale;
        solution[i] = 0;
    });
    double enough = 0;
    Outcome outcome = iterate(tolerance, enough, limit);
    if (outcome == Outcome::slow && turned) outcome = build() ? iterate(tolerance, enough, limit) : Outcome::indefinite;
    for_numbers(size, [&](std::size_t i) { b[i] = scale * solution[i]; });
    return outcome;
}

TwoLevel::TwoLevel(const SymmetricPattern& pattern) : state_(std::make_unique<State>(pattern)) {}
TwoLevel::TwoLevel(TwoLevel&&) noexcept = default;
TwoLevel& TwoLevel::operator=(TwoLevel&&) noexcept = default;
TwoLevel::~TwoLevel() = default;

bool TwoLevel::set(std::span<const double> values, std::span<const double> positions) {
    State& s = *state_;
    s.matrix.set(values);
    s.positions.assign(positions.begin(), positions.end());
    if (!s.invert_diagonal()) return false;
    s.find_largest();
    if (!s.built) return s.build();
    s.space.turn(positions);
    s.turned = true;
    return true;
}

TwoLevel::Outcome TwoLevel::solve(std::span<double> right_hand_sides, int columns, double tolerance, int limit) {
    state_->iterations = 0;
    Outcome worst = Outcome::solved;
    for (int c = 0; c < columns && worst != Outcome::indefinite; ++c) {
        const Outcome outcome =
            state_->solve(right_hand_sides.data() + static_cast<std::size_t>(c) * state_->size, tolerance, limit);
        if (outcome != Outcome::solved) worst = outcome;
    }
    return worst;
}

int TwoLevel::iterations() const {
    return state_->iterations;
}

}  // namespace pliant::linalg

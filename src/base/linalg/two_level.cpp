#include "base/linalg/two_level.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/linalg/coarse_quality.hpp"
#include "base/linalg/projected_gradients.hpp"
#include "base/linalg/smoothed_levels.hpp"

namespace pliant::linalg {
namespace {

using PerColumn = std::array<double, most_columns>;

}  // namespace

struct TwoLevel::State {
    explicit State(SmoothedLevels of) : levels(std::move(of)), size(levels.size()) {}

    /// Room for `count` columns; the contents are set by their users.
    void set_columns(std::size_t count) {
        columns = count;
        for (Interleaved<double>* v : {&residual, &direction, &product, &solution}) v->resize(count * size);
    }
    [[nodiscard]] Outcome iterate(double tolerance, PerColumn& enough, int limit);
    [[nodiscard]] Outcome solve(double* right_hand_sides, std::size_t count, double tolerance, int limit);

    SmoothedLevels levels;
    std::size_t size;
    std::size_t columns = 1;
    Interleaved<double> residual, direction, product, solution;
    CoarseQuality quality;
    int iterations = 0;
};

/// Iterates from `solution` and `residual` until the squared error of each column, in the norm of the preconditioner,
/// is at most `enough`; 0: to be set from the first one. A converged column is not changed any more.
TwoLevel::Outcome TwoLevel::State::iterate(double tolerance, PerColumn& enough, int limit) {
    const std::size_t all = columns * size;
    const Interleaved<float>& correction = levels.apply(residual, columns);
    for_numbers(all, [&](std::size_t i) { direction[i] = correction[i]; });
    PerColumn left{}, begun{};
    std::array<bool, most_columns> done{};
    for (std::size_t c = 0; c < columns; ++c) {
        begun[c] = left[c] = dot(residual, correction, size, columns, c);
        if (!(left[c] >= 0)) return Outcome::slow;
        if (enough[c] == 0)
            enough[c] = tolerance * tolerance * left[c];
        else
            done[c] = left[c] <= enough[c];
        done[c] = done[c] || left[c] == 0;  // converged from the start
    }
    const auto all_done = [&] { return std::all_of(done.begin(), done.begin() + columns, [](bool d) { return d; }); };
    for (int k = 1; k <= limit && !all_done(); ++k) {
        levels.matrix().multiply(direction.data(), product.data(), static_cast<int>(columns));
        PerColumn advance{}, keep{};
        for (std::size_t c = 0; c < columns; ++c) {
            if (done[c]) continue;
            ++iterations;
            const double curvature = dot(direction, product, size, columns, c);
            if (!(curvature > 0)) return Outcome::indefinite;
            advance[c] = left[c] / curvature;
        }
        for_numbers(size, [&](std::size_t i) {
            for (std::size_t c = 0; c < columns; ++c) {
                solution[columns * i + c] += advance[c] * direction[columns * i + c];
                residual[columns * i + c] -= advance[c] * product[columns * i + c];
            }
        });
        (void)levels.apply(residual, columns);  // correction
        for (std::size_t c = 0; c < columns; ++c) {
            if (done[c]) continue;
            const double now = dot(residual, correction, size, columns, c);
            if (now <= enough[c] && now >= 0) {
                if (!levels.is_turned() && now > 0) quality.learn(k, begun[c], now);
                done[c] = true;
                continue;
            }
            if (!(now > 0)) return Outcome::slow;
            if (levels.is_turned() && quality.is_outdated(k, begun[c], now, enough[c])) return Outcome::slow;
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
    if (outcome == Outcome::slow && levels.is_turned()) {
        outcome = levels.build() ? iterate(tolerance, enough, limit) : Outcome::indefinite;
    }
    for (std::size_t c = 0; c < count; ++c)
        for_numbers(size, [&](std::size_t i) { b[c * size + i] = scale[c] * solution[count * i + c]; });
    return outcome;
}

TwoLevel::TwoLevel(const SymmetricPattern& pattern) : state_(std::make_unique<State>(levels_on_groups(pattern))) {}
TwoLevel::TwoLevel(const SymmetricPattern& pattern, Nesting corners, int most_factored)
    : state_(std::make_unique<State>(levels_on_corners(pattern, std::move(corners), most_factored))) {}
TwoLevel::TwoLevel(TwoLevel&&) noexcept = default;
TwoLevel& TwoLevel::operator=(TwoLevel&&) noexcept = default;
TwoLevel::~TwoLevel() = default;

bool TwoLevel::set(std::span<const double> values, std::span<const double> positions) {
    take(values, positions);
    return prepare(Reuse::turned);
}

void TwoLevel::take(std::span<const double> values, std::span<const double> positions) {
    state_->levels.take(values, positions);
}

void TwoLevel::move_towards(std::span<const double> values, double share) {
    state_->levels.move_towards(values, share);
}

bool TwoLevel::prepare(Reuse reuse) {
    return state_->levels.prepare(reuse);
}

bool TwoLevel::is_turned() const {
    return state_->levels.is_turned();
}

double TwoLevel::usual_gain() const {
    return state_->quality.usual_gain();
}

void TwoLevel::set_usual_gain(double gain) {
    state_->quality = CoarseQuality(gain);
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

TwoLevel::Outcome TwoLevel::solve_constrained(std::span<double> right_hand_side, const Constraints& constraints,
                                              std::span<double> multipliers, double tolerance, int limit) {
    State& s = *state_;
    s.iterations = 0;
    const auto once = [&] {
        return project_gradients(s.levels, s.quality, right_hand_side, constraints, multipliers, tolerance, limit,
                                 s.iterations);
    };
    const Outcome outcome = once();
    if (outcome != Outcome::slow || !s.levels.is_turned()) return outcome;
    return s.levels.build() ? once() : Outcome::indefinite;
}

int TwoLevel::iterations() const {
    return state_->iterations;
}

}  // namespace pliant::linalg

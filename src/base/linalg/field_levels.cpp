#include "base/linalg/field_levels.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/core/parallel.hpp"
#include "base/linalg/aggregates.hpp"
#include "base/linalg/cholesky.hpp"
#include "base/linalg/interleaved.hpp"
#include "base/linalg/scalar_rows.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t nodes_per_sum = 4096;  // in a parallel piece
constexpr int few_nodes = 20000;             // these are factorised
constexpr int most_iterations = 100;         // some ten do

// With each row divided by the sum of its magnitudes, no eigenvalue is above 1, and damping below 2 is stable.
constexpr float smoothing = 1.8F;
constexpr float smoothing_of_groups = 4.0F / 3;

/// Three components of a node and a zero, which the processor takes at once.
using Numbers = AlignedArray<float>;
using At = Eigen::Map<Eigen::Array4f, Eigen::Aligned16>;

At at(const Numbers& field, std::size_t node) {
    return At(field.data() + 4 * node);
}

/// Of one level, (nodes, 4).
struct Fields {
    explicit Fields(std::size_t nodes) : side(4 * nodes), x(4 * nodes), rest(4 * nodes) {}
    Numbers side, x, rest;
};

struct Level {
    explicit Level(ScalarRows of) : matrix(std::move(of)), inverse_sums(matrix.inverse_absolute_sums()) {}
    [[nodiscard]] std::size_t nodes() const { return matrix.rows(); }

    void multiply(const Numbers& from, Numbers& to) const {
        for_numbers(nodes(), [&](std::size_t i) { at(to, i) = matrix.row_product(i, from.data()); });
    }
    /// One step of Jacobi's iteration for the side, from x = 0 and from where x is.
    void smoothe_from_zero(Fields& of) const {
        for_numbers(nodes(), [&](std::size_t i) { at(of.x, i) = smoothing * inverse_sums[i] * at(of.side, i); });
    }
    void smoothe(Fields& of) const {
        multiply(of.x, of.rest);
        for_numbers(nodes(), [&](std::size_t i) {
            at(of.x, i) += smoothing * inverse_sums[i] * (at(of.side, i) - at(of.rest, i));
        });
    }

    ScalarRows matrix;
    Numbers inverse_sums;                  ///< (nodes) of the magnitudes in each row
    ScalarRows prolongation, restriction;  ///< to and from the next level
};

/// (1 - smoothing D^-1 A) times the constants on groups of neighbours, D the sums of magnitudes in the rows of A.
ScalarRows smoothed_groups(const Level& level) {
    const Aggregates groups = take_neighbourhoods({level.matrix.start(), level.matrix.columns()});
    return ScalarRows::make(static_cast<int>(level.nodes()), groups.count, [&](int i, auto& put) {
        const auto [columns, values] = level.matrix.row(static_cast<std::size_t>(i));
        const float share = smoothing_of_groups * level.inverse_sums[static_cast<std::size_t>(i)];
        put(groups.of_node[static_cast<std::size_t>(i)], 1.0);
        for (std::size_t k = 0; k < columns.size(); ++k)
            put(groups.of_node[static_cast<std::size_t>(columns[k])], static_cast<double>(-share * values[k]));
    });
}

/// Each node as the mean of its ends.
ScalarRows nested(const Nesting& corners) {
    return ScalarRows::make(static_cast<int>(corners.ends.size()), corners.coarse_nodes, [&](int i, auto& put) {
        for (const int end : corners.ends[static_cast<std::size_t>(i)]) {
            if (end >= 0) put(end, 0.5);
        }
    });
}

std::vector<double> sums_of_rows(const SymmetricPattern& pattern, std::span<const double> values) {
    std::vector<double> sums(static_cast<std::size_t>(pattern.nodes), 0.0);
    const std::vector<double> ones(sums.size(), 1.0);
    add_product(pattern, values, ones, 1, sums);
    return sums;
}

}  // namespace

struct FieldLevels::State {
    State(const SymmetricPattern& pattern, std::span<const double> values, const Nesting* corners)
        : row_sums(sums_of_rows(pattern, values)) {
        levels.emplace_back(ScalarRows::of(pattern, values));
        while (levels.back().nodes() > few_nodes) {
            Level& level = levels.back();
            level.prolongation = corners != nullptr && levels.size() == 1 ? nested(*corners) : smoothed_groups(level);
            level.restriction = level.prolongation.transposed();
            if (level.restriction.rows() > level.nodes() / 2) break;  // hardly any nodes are neighbours
            levels.emplace_back(coarse_product(level.restriction, level.matrix, level.prolongation));
        }
        const auto [last_pattern, last_values] = levels.back().matrix.lower_triangle();
        last = std::make_unique<Cholesky>(last_pattern, Precision::single_);
        if (!last->factorise(last_values)) {
            last->use(Precision::double_);
            [[maybe_unused]] const bool done = last->factorise(last_values);
        }
        last->release_work_space();
    }

    std::vector<double> row_sums;  ///< of the matrix before it was rounded
    std::vector<Level> levels;
    std::unique_ptr<Cholesky> last;

    /// Work space of the solutions under way, which may be several at once.
    std::mutex lending;
    std::vector<std::unique_ptr<Solution>> idle;
};

/// One solution at a time.
class FieldLevels::Solution {
public:
    explicit Solution(const State& state) : levels_(state.levels), last_(*state.last), row_sums_(state.row_sums) {
        for (const Level& level : levels_) fields_.emplace_back(level.nodes());
        last_side_.resize(3 * levels_.back().nodes());
        for (Interleaved<double>* field : {&residual_, &direction_, &product_})
            field->resize(3 * levels_.front().nodes());
    }
    /// In place; returns the number of iterations.
    int find(double* field, double tolerance);

private:
    /// M^-1 of the side of a level, in its x.
    void apply(std::size_t at_level);
    void solve_last(Fields& of);
    /// M^-1 residual, in the first x; returns the product of both.
    double precondition();
    /// Row i of the matrix times the direction. By differences from the node's own motion, of which the row sum is
    /// left: a rounded matrix would hold a body that moves as a whole.
    [[nodiscard]] Eigen::Array3d force(std::size_t i) const;

    const std::vector<Level>& levels_;
    const Cholesky& last_;
    const std::vector<double>& row_sums_;
    std::vector<Fields> fields_;     ///< (levels)
    std::vector<double> last_side_;  ///< (nodes of the last level, 3)
    Interleaved<double> residual_, direction_, product_;
};

void FieldLevels::Solution::apply(std::size_t at_level) {
    const Level& level = levels_[at_level];
    Fields& own = fields_[at_level];
    if (at_level + 1 == levels_.size()) return solve_last(own);
    Fields& next = fields_[at_level + 1];
    level.smoothe_from_zero(own);
    level.multiply(own.x, own.rest);
    for_numbers(level.nodes(), [&](std::size_t i) { at(own.rest, i) = at(own.side, i) - at(own.rest, i); });
    for_numbers(level.restriction.rows(),
                [&](std::size_t c) { at(next.side, c) = level.restriction.row_product(c, own.rest.data()); });
    apply(at_level + 1);
    for_numbers(level.nodes(),
                [&](std::size_t i) { at(own.x, i) += level.prolongation.row_product(i, next.x.data()); });
    level.smoothe(own);
}

void FieldLevels::Solution::solve_last(Fields& of) {
    const std::size_t nodes = levels_.back().nodes();
    for (std::size_t i = 0; i < nodes; ++i)
        for (std::size_t k = 0; k < 3; ++k) last_side_[3 * i + k] = static_cast<double>(of.side[4 * i + k]);
    last_.solve_fields(last_side_, 1);
    for (std::size_t i = 0; i < nodes; ++i) {
        for (std::size_t k = 0; k < 3; ++k) of.x[4 * i + k] = static_cast<float>(last_side_[3 * i + k]);
        of.x[4 * i + 3] = 0;
    }
}

double FieldLevels::Solution::precondition() {
    Fields& first = fields_.front();
    const std::size_t nodes = levels_.front().nodes();
    for_numbers(nodes, [&](std::size_t i) {
        const double* from = residual_.data() + 3 * i;
        at(first.side, i) =
            Eigen::Array4f(static_cast<float>(from[0]), static_cast<float>(from[1]), static_cast<float>(from[2]), 0.0F);
    });
    apply(0);
    return parallel_sum(nodes, nodes_per_sum, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = 0; k < 3; ++k) sum += residual_[3 * i + k] * static_cast<double>(first.x[4 * i + k]);
        return sum;
    });
}

Eigen::Array3d FieldLevels::Solution::force(std::size_t i) const {
    const auto motion = [&](std::size_t node) {
        return Eigen::Map<const Eigen::Array3d>(direction_.data() + 3 * node);
    };
    const auto [columns, values] = levels_.front().matrix.row(i);
    const Eigen::Array3d own = motion(i);
    Eigen::Array3d sum = row_sums_[i] * own;
    for (std::size_t k = 0; k < columns.size(); ++k)
        sum += static_cast<double>(values[k]) * (motion(static_cast<std::size_t>(columns[k])) - own);
    return sum;
}

int FieldLevels::Solution::find(double* field, double tolerance) {
    const Numbers& correction = fields_.front().x;
    const std::size_t nodes = levels_.front().nodes(), size = 3 * nodes;
    for_numbers(size, [&](std::size_t i) {
        residual_[i] = field[i];
        field[i] = 0;
        direction_[i] = 0;
    });
    double left = precondition(), keep = 0;
    const double enough = tolerance * tolerance * left;
    int iterations = 0;
    while (left > enough && iterations < most_iterations) {
        ++iterations;
        for_numbers(nodes, [&](std::size_t i) {
            for (std::size_t k = 0; k < 3; ++k)
                direction_[3 * i + k] = static_cast<double>(correction[4 * i + k]) + keep * direction_[3 * i + k];
        });
        for_numbers(nodes, [&](std::size_t i) { Eigen::Map<Eigen::Array3d>(product_.data() + 3 * i) = force(i); });
        const double curvature = dot(direction_, product_, size);
        if (!(curvature > 0)) break;
        const double advance = left / curvature;
        for_numbers(size, [&](std::size_t i) {
            field[i] += advance * direction_[i];
            residual_[i] -= advance * product_[i];
        });
        const double before = std::exchange(left, precondition());
        keep = left / before;
    }
    return iterations;
}

FieldLevels::FieldLevels(const SymmetricPattern& pattern, std::span<const double> values, const Nesting* corners)
    : state_(std::make_unique<State>(pattern, values, corners)) {}
FieldLevels::FieldLevels(FieldLevels&&) noexcept = default;
FieldLevels& FieldLevels::operator=(FieldLevels&&) noexcept = default;
FieldLevels::~FieldLevels() = default;

int FieldLevels::solve(std::span<double> fields, int count, double tolerance) const {
    std::unique_ptr<Solution> solution;
    {
        const std::lock_guard lock(state_->lending);
        if (!state_->idle.empty()) {
            solution = std::move(state_->idle.back());
            state_->idle.pop_back();
        }
    }
    if (!solution) solution = std::make_unique<Solution>(*state_);
    int most = 0;
    const std::size_t size = 3 * state_->levels.front().nodes();
    for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
        most = std::max(most, solution->find(fields.data() + c * size, tolerance));
    const std::lock_guard lock(state_->lending);
    state_->idle.push_back(std::move(solution));
    return most;
}

}  // namespace pliant::linalg

#include "base/linalg/coarse_solver.hpp"

#include <cstddef>

#include "base/linalg/cholesky.hpp"
#include "base/linalg/smoothed_levels.hpp"

namespace pliant::linalg {
namespace {

/// A body that bends easily may be too ill-conditioned for single precision.
class FactoredSolver final : public CoarseSolver {
public:
    explicit FactoredSolver(const SymmetricPattern& pattern)
        : factor_(pattern, Precision::single_), is_large_(pattern.nodes > most_kept) {}

    [[nodiscard]] bool set(std::span<const double> values, std::span<const double>, Reuse) override {
        if (factor_.precision() == Precision::double_) factor_.use(Precision::single_);
        bool found = factor_.factorise(values);
        if (!found) {
            factor_.use(Precision::double_);
            found = factor_.factorise(values);
        }
        if (is_large_) factor_.release_work_space();
        return found;
    }
    void solve(std::span<double> right_hand_sides, int columns) override { factor_.solve(right_hand_sides, columns); }

private:
    static constexpr int most_kept = 5000;  // mapping work space of fewer nodes again takes longer than it is worth

    Cholesky factor_;
    bool is_large_;
};

class GroupedSolver final : public CoarseSolver {
public:
    explicit GroupedSolver(const SymmetricPattern& pattern) : levels_(levels_on_groups(pattern)) {}

    [[nodiscard]] bool set(std::span<const double> values, std::span<const double> positions, Reuse reuse) override {
        levels_.take(values, positions);
        return levels_.prepare(reuse);
    }
    void solve(std::span<double> right_hand_sides, int columns) override {
        const std::size_t size = levels_.size(), count = static_cast<std::size_t>(columns);
        right_.resize(count * size);
        for_numbers(size, [&](std::size_t i) {
            for (std::size_t k = 0; k < count; ++k) right_[count * i + k] = right_hand_sides[k * size + i];
        });
        const Interleaved<float>& found = levels_.apply(right_, count);
        for_numbers(size, [&](std::size_t i) {
            for (std::size_t k = 0; k < count; ++k)
                right_hand_sides[k * size + i] = static_cast<double>(found[count * i + k]);
        });
    }
    [[nodiscard]] bool is_turned() const override { return levels_.is_turned(); }
    [[nodiscard]] bool build() override { return levels_.build(); }

private:
    SmoothedLevels levels_;
    Interleaved<double> right_;
};

}  // namespace

std::unique_ptr<CoarseSolver> make_factored_solver(const SymmetricPattern& pattern) {
    return std::make_unique<FactoredSolver>(pattern);
}

std::unique_ptr<CoarseSolver> make_grouped_solver(const SymmetricPattern& pattern) {
    return std::make_unique<GroupedSolver>(pattern);
}

}  // namespace pliant::linalg

#include "base/linalg/cholesky.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <variant>
#include <vector>

#include "base/linalg/factor.hpp"

namespace pliant::linalg {
namespace {

using AnyFactor = std::variant<Factor<float>, Factor<double>>;

AnyFactor make_factor(const std::shared_ptr<const Analysis>& analysis, int block, Precision precision) {
    if (precision == Precision::single_) return Factor<float>(analysis, block);
    return Factor<double>(analysis, block);
}

double dot(std::span<const double> a, std::span<const double> b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// a += factor b
void add(std::span<double> a, double factor, std::span<const double> b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += factor * b[i];
}

}  // namespace

struct Cholesky::State {
    std::shared_ptr<const Analysis> analysis;
    SymmetricPattern pattern;  ///< of the analysis, with its block size
    AnyFactor factor;

    [[nodiscard]] const FrontLayout& layout() const {
        return std::visit([](const auto& f) -> const FrontLayout& { return f.layout(); }, factor);
    }
};

Cholesky::Cholesky(const SymmetricPattern& pattern, Precision precision)
    : Cholesky(analyse(pattern), pattern.block, precision) {}

Cholesky::Cholesky(std::shared_ptr<const Analysis> analysis, int block, Precision precision) {
    AnyFactor factor = make_factor(analysis, block, precision);
    SymmetricPattern pattern = analysis->pattern;
    pattern.block = block;
    state_ = std::make_unique<State>(State{std::move(analysis), std::move(pattern), std::move(factor)});
}

Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;
Cholesky::~Cholesky() = default;

void Cholesky::use(Precision precision) {
    state_->factor = make_factor(state_->analysis, state_->pattern.block, precision);
}

Precision Cholesky::precision() const {
    return std::holds_alternative<Factor<float>>(state_->factor) ? Precision::single_ : Precision::double_;
}

bool Cholesky::factorise(std::span<const double> values) {
    assert(values.size() == state_->pattern.entries());
    return std::visit([&](auto& factor) { return factor.factorise(values); }, state_->factor);
}

void Cholesky::release_work_space() {
    std::visit([](auto& factor) { factor.release_work_space(); }, state_->factor);
}

void Cholesky::solve(std::span<double> right_hand_sides, int columns) const {
    const auto n = static_cast<std::size_t>(state_->pattern.size());
    assert(right_hand_sides.size() == n * static_cast<std::size_t>(columns));
    constexpr int together = 4;
    for (int c = 0; c < columns && n > 0; c += together) {
        double* first = right_hand_sides.data() + static_cast<std::size_t>(c) * n;
        std::visit([&](const auto& factor) { factor.solve(first, std::min(together, columns - c)); }, state_->factor);
    }
}

void Cholesky::solve_fields(std::span<double> fields, int count) const {
    assert(state_->pattern.block == 1);
    const std::size_t n = 3 * static_cast<std::size_t>(state_->pattern.size());
    assert(fields.size() == n * static_cast<std::size_t>(count));
    constexpr int together = 2;
    for (int c = 0; c < count && n > 0; c += together) {
        double* first = fields.data() + static_cast<std::size_t>(c) * n;
        std::visit([&](const auto& factor) { factor.solve_fields(first, std::min(together, count - c)); },
                   state_->factor);
    }
}

void Cholesky::inverse_part(std::span<const int> unknowns, std::span<double> result) const {
    assert(result.size() == unknowns.size() * unknowns.size());
    std::visit([&](const auto& factor) { factor.inverse_part(unknowns, result.data()); }, state_->factor);
}

std::optional<double> Cholesky::solve_and_refine(std::span<const double> values, std::span<double> right_hand_sides,
                                                 int columns, double tolerance, int limit) const {
    const SymmetricPattern& pattern = state_->pattern;
    const auto n = static_cast<std::size_t>(pattern.size());
    const auto column = [n](std::span<double> all, int c) { return all.subspan(static_cast<std::size_t>(c) * n, n); };
    std::vector<double> residual(right_hand_sides.begin(), right_hand_sides.end());
    std::vector<double> direction = residual;
    solve(direction, columns);
    std::vector<double> product(residual.size());
    std::vector<double> left(static_cast<std::size_t>(columns));  // squared error of each column, in the norm of the
                                                                  // factor
    for (int c = 0; c < columns; ++c) left[c] = dot(column(residual, c), column(direction, c));
    const std::vector<double> whole = left;
    std::fill(right_hand_sides.begin(), right_hand_sides.end(), 0.0);
    double first = 0;
    for (int iteration = 0;; ++iteration) {
        std::fill(product.begin(), product.end(), 0.0);
        for (int c = 0; c < columns; ++c) {
            add_product(pattern, values, column(direction, c), 1, column(product, c));
            const double curvature = dot(column(direction, c), column(product, c));
            const double step = curvature > 0 ? left[c] / curvature : 0;
            add(column(right_hand_sides, c), step, column(direction, c));
            add(column(residual, c), -step, column(product, c));
        }
        product = residual;
        solve(product, columns);
        double worst = 0;  // squared
        for (int c = 0; c < columns; ++c) {
            const double now = dot(column(residual, c), column(product, c));
            if (now > worst * whole[c]) worst = now / whole[c];
            const double keep = left[c] > 0 ? now / left[c] : 0;
            for (std::size_t i = 0; i < n; ++i) direction[c * n + i] = product[c * n + i] + keep * direction[c * n + i];
            left[c] = now;
        }
        if (iteration == 0) first = std::sqrt(worst);
        if (worst <= tolerance * tolerance) return first;
        if (iteration == limit) return std::nullopt;
    }
}

double Cholesky::factor_entries() const {
    return static_cast<double>(state_->layout().panel.back());
}

double Cholesky::factor_work() const {
    return state_->layout().work;
}

const std::shared_ptr<const Analysis>& Cholesky::analysis() const {
    return state_->analysis;
}

}  // namespace pliant::linalg

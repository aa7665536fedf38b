#include "printing/machine/cleaning_data.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::machine {
namespace {

constexpr std::array<CleaningTest, 4> tests = {{
    {"spray", 15, {0.99, 0.92, 0.97, 0.91}, 0},
    {"ultrasound", 15, {0.27, 0.08, 0.30, 0.57}, 0.27},
    {"ultrasound", 120, {0.40, 0.67, 0.40, 0.89}, 0.57},
    {"cloth", 0, {0.12, 0.07, 0.69, 0.27}, 0.37},
}};

/// The time constant for which a law removes in `short_s` the fraction `share` of what it removes in `long_s`; by
/// bisection, since that fraction decreases with the constant.
double tau_through(double short_s, double long_s, double share) {
    double low = short_s / 50, high = 50 * long_s;
    for (int i = 0; i < 200; ++i) {
        const double tau = (low + high) / 2;
        (std::expm1(-short_s / tau) / std::expm1(-long_s / tau) > share ? low : high) = tau;
    }
    return (low + high) / 2;
}

}  // namespace

std::span<const CleaningTest> cleaning_tests() {
    return tests;
}

double CleaningLaw::removed(double seconds) const {
    return reach * -std::expm1(-std::max(0.0, seconds) / tau_s);
}

CleaningLaw cleaning_law(CleaningMethod method) {
    if (method == CleaningMethod::spray) return {1, -tests[0].seconds / std::log(1 - tests[0].mean())};
    const double tau = tau_through(tests[1].seconds, tests[2].seconds, tests[1].mean() / tests[2].mean());
    return {tests[2].mean() / -std::expm1(-tests[2].seconds / tau), tau};
}

}  // namespace pliant::machine

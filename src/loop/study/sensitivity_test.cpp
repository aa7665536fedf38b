#include "loop/study/sensitivity.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "loop/study/design.hpp"

using namespace pliant;
using namespace pliant::study;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double a = 7, b = 0.1;

/// T. Ishigami, T. Homma (1990): sin x + a sin^2 y + b z^4 sin x, each in (-pi, pi).
double ishigami(double x, double y, double z) {
    return std::sin(x) + a * std::sin(y) * std::sin(y) + b * std::pow(z, 4) * std::sin(x);
}

std::vector<double> ishigami_values(std::size_t samples, std::uint64_t seed) {
    const auto points = saltelli_points(samples, 3, seed);
    std::vector<double> values;
    for (std::size_t i = 0; i < points.size(); i += 3) {
        const auto angle = [&](std::size_t k) { return pi * (2 * points[i + k] - 1); };
        values.push_back(ishigami(angle(0), angle(1), angle(2)));
    }
    return values;
}

// The closed forms, from the integrals of the function over the cube.
const double variance_x = 0.5 * std::pow(1 + b * std::pow(pi, 4) / 5, 2);
const double variance_y = a * a / 8;
const double variance_xz = 8 * b * b * std::pow(pi, 8) / 225;
const double variance = variance_x + variance_y + variance_xz;

}  // namespace

TEST_CASE("the Ishigami function's indices are those of its closed form") {
    const Sensitivity found = sobol_indices(ishigami_values(4096, 1), 3);
    REQUIRE(found.keys.size() == 3);
    CHECK(found.samples == 4096);
    // Scrambled Sobol points integrate this function with an error of about 1/n; 1 % of the variance is far above the
    // observed error.
    CHECK(found.variance == near(variance, {.relative = 0.01}));
    const double first[] = {variance_x / variance, variance_y / variance, 0};
    const double total[] = {(variance_x + variance_xz) / variance, variance_y / variance, variance_xz / variance};
    for (int k = 0; k < 3; ++k) {
        CHECK(found.keys[k].first.value == near(first[k], {.absolute = 0.01}));
        CHECK(found.keys[k].total.value == near(total[k], {.absolute = 0.01}));
        for (const auto& [index, truth] : {std::pair{found.keys[k].first, first[k]}, {found.keys[k].total, total[k]}}) {
            CHECK(index.low <= index.value);
            CHECK(index.value <= index.high);
            CHECK((index.low <= truth && truth <= index.high));
        }
    }
}

TEST_CASE("intervals narrow with the square root of the number of samples, and hold the true value") {
    int held = 0, asked = 0;
    double width_few = 0, width_many = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Sensitivity few = sobol_indices(ishigami_values(256, seed), 3, 200, seed);
        const Index index = few.keys[1].total;
        width_few += index.high - index.low;
        held += index.low <= variance_y / variance && variance_y / variance <= index.high ? 1 : 0;
        ++asked;
        const Index more = sobol_indices(ishigami_values(4096, seed), 3, 200, seed).keys[1].total;
        width_many += more.high - more.low;
    }
    CHECK(held >= asked - 3);  // 95 %, and Sobol points do better than the random ones that intervals are made for
    CHECK(width_few / width_many == near(4, {.relative = 0.3}));
}

TEST_CASE("for a sum, first and total indices are equal, and are the shares of its variance") {
    const auto points = saltelli_points(1024, 2, 3);
    std::vector<double> values;
    for (std::size_t i = 0; i < points.size(); i += 2) values.push_back(1000 + 3 * points[i] + points[i + 1]);
    const Sensitivity found = sobol_indices(values, 2);
    REQUIRE(found.keys.size() == 2);
    CHECK(found.keys[0].first.value == near(0.9, {.absolute = 0.005}));
    CHECK(found.keys[0].total.value == near(0.9, {.absolute = 0.005}));
    CHECK(found.keys[1].total.value == near(0.1, {.absolute = 0.005}));
}

TEST_CASE("samples with a failed row are left out; a constant result has no indices") {
    auto values = ishigami_values(512, 2);
    values[7] = std::nan("");
    values[5 * 100] = std::nan("");
    CHECK(sobol_indices(values, 3).samples == 510);
    CHECK(sobol_indices(std::vector<double>(5 * 64, 0.1), 3).keys.empty());
    CHECK(sobol_indices(std::vector<double>(5 * 64, std::nan("")), 3).samples == 0);
}

#include "simulation/calibrate/ratio.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::calibrate;

namespace {

/// Takes down the shares that it is told, and cancels at one.
class Shares final : public Progress {
public:
    explicit Shares(double last) : last_(last) {}
    void advance(std::string_view, double share) override { at.push_back(share); }
    [[nodiscard]] bool cancelled() const override { return !at.empty() && at.back() >= last_; }
    std::vector<double> at;

private:
    double last_;
};

RatioOptions coarse() {
    RatioOptions options;
    options.cells = {12, 2, 2};
    return options;
}

}  // namespace

TEST_CASE("equal materials: the interface of a long bar moves half as far as its end") {
    Progress silent;
    RatioOptions options = coarse();
    const auto u = reference_displacement_mm(options, 1, silent);
    REQUIRE(u);
    CHECK(*u == near(15, {.relative = 1e-4}));
    const auto R = match_shape_parameter(options, 15, 2, silent);
    REQUIRE(R);
    CHECK(*R == near(1, {.relative = 1e-6}));
}

TEST_CASE("the matched shape parameter gives the displacement that was asked for") {
    Progress silent;
    const RatioOptions options = coarse();
    const auto R = match_shape_parameter(options, 6, 3, silent);
    REQUIRE(R);
    const auto u = blend_displacement_mm(options, *R, silent);
    REQUIRE(u);
    CHECK(*u == near(6, {.relative = 2e-5}));
    CHECK_FALSE(
        match_shape_parameter(options, 16, 3, silent));  // more than half: the soft part would have to be stiffer
}

TEST_CASE("a long bar at small strain and Poisson ratio 0 follows the small-strain map") {
    Progress silent;
    // The uniaxial stiffness of the blend is 3 w a / (2 + a): w and 3 w a / (2 + a) for the two halves, so the ratio of
    // their stretches is known.
    RatioOptions options = coarse();
    options.strain = 1e-3;
    const double R = 4;
    const auto u = blend_displacement_mm(options, R, silent);
    REQUIRE(u);
    const double soft = 3 / (2 * R + 1);
    // The clamped ends and the interface restrain lateral contraction, unlike in ideal bars.
    CHECK(*u == near(0.1 * soft / (1 + soft), {.relative = 0.04}));
}

TEST_CASE("the interface may lie anywhere: cells are stretched to end at it") {
    Progress silent;
    RatioOptions options = coarse();
    for (const double interface : {0.3, 0.7}) {
        options.interface = interface;
        options.cells[0] = 20;  // a boundary of cells is there
        const auto exact = reference_displacement_mm(options, 4, silent);
        REQUIRE(exact);
        options.cells[0] = 24;  // 7.2 and 16.8 cells
        CHECK(*reference_displacement_mm(options, 4, silent) / *exact == near(1, {.relative = 1e-2}));
    }
    // Without stretched cells the result would jump from one boundary to the next.
    options.interface = 0.26;
    const double a = *reference_displacement_mm(options, 4, silent);
    options.interface = 0.28;
    const double b = *reference_displacement_mm(options, 4, silent);
    CHECK(b / a > 1.04);
}

TEST_CASE("three ratios give a curve through their points") {
    RatioOptions options = coarse();
    options.ratios = {1, 2, 4};
    Progress silent;
    const auto result = calibrate_ratio(options, silent);
    REQUIRE_MESSAGE(result, (result ? "" : result.error().message));
    REQUIRE(result->rows.size() == 3);
    REQUIRE(result->curve);
    for (const RatioRow& row : result->rows) {
        const auto& c = *result->curve;
        const double on_curve = (c[0] * row.material_ratio + c[1]) * row.material_ratio + c[2];
        CHECK(on_curve == near(row.shape_parameter, {.relative = 1e-12}));
    }
    CHECK(ratio_csv(*result).find("material_ratio,interface_mm") == 0);
    CHECK(ratio_json(*result, options).find("\"curve\"") != std::string::npos);
    CHECK(ratio_text(*result).find("T3.8") != std::string::npos);
}

TEST_CASE("invalid options are refused") {
    Progress silent;
    RatioOptions options = coarse();
    CHECK_FALSE(calibrate_ratio(options, silent));
    options.ratios = {0.5};
    CHECK_FALSE(calibrate_ratio(options, silent));
    options.ratios = {2};
    options.poisson_ratio = 0.5;
    CHECK_FALSE(calibrate_ratio(options, silent));
    options.poisson_ratio = 0.45;
    options.interface = 1;
    CHECK_FALSE(calibrate_ratio(options, silent));
    options.interface = 0.5;
    options.cells[0] = 1;  // no boundary between the ends
    CHECK_FALSE(calibrate_ratio(options, silent));
}

TEST_CASE("a bar of too many tets is refused before it is made, with one that is possible") {
    RatioOptions options;
    options.cells = {200, 60, 60};
    const Status refused = check_bar(options);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message == "--cells: 200,60,60 makes 4320000 tets, more than 1000000; 122,36,36 is possible");
    options.cells = {122, 36, 36};
    CHECK(check_bar(options));
}

TEST_CASE("a calibration tells how far it is within a ratio, and can be cancelled there") {
    RatioOptions options = coarse();
    options.ratios = {2};
    Shares seen(1e9);
    const auto whole = calibrate_ratio(options, seen);
    REQUIRE(whole);
    CHECK(seen.at.size() > 10);
    CHECK(std::is_sorted(seen.at.begin(), seen.at.end()));
    CHECK(seen.at.front() < 0.3);
    CHECK(seen.at.back() <= 1);
    for (const double share : {0.2, 0.5, 0.7}) {
        Shares impatient(share);
        const auto stopped = calibrate_ratio(options, impatient);
        REQUIRE_FALSE(stopped);
        CHECK(stopped.error().cause == Cause::cancelled);
        CHECK(impatient.at.size() < seen.at.size());
    }
}

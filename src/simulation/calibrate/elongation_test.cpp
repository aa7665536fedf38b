#include "simulation/calibrate/elongation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/near.hpp"
#include "simulation/calibrate/ratio.hpp"

using namespace pliant;
using namespace pliant::calibrate;

namespace {

/// Equilibrium of the joint of two incompressible neo-Hookean bars in series, by bisection on equal stress.
double joint_of(double ratio, double L, double L1, double dL) {
    double low = 0, high = dL;
    for (int i = 0; i < 200; ++i) {
        const double u = 0.5 * (low + high);
        const double a = 1 + u / L1, b = 1 + (dL - u) / (L - L1);
        (ratio * (a - 1 / (a * a)) < b - 1 / (b * b) ? low : high) = u;
    }
    return 0.5 * (low + high);
}

void check_elongation_problem(const std::string& text, const std::string& wanted) {
    const auto rows = parse_elongation_csv(text, "t.csv");
    REQUIRE_FALSE(rows);
    CHECK_MESSAGE(rows.error().message.find(wanted) != std::string::npos, "found \"", rows.error().message, "\"");
}

const std::string header = "length (mm),interface (mm),elongation (mm),joint (mm)\n";

}  // namespace

TEST_CASE("T3.7 is exact for springs, and for any ratio of moduli at small strain") {
    // Springs: E_A u / L1 = E_B (dL - u) / (L - L1).
    for (const double ratio : {0.2, 1.0, 3.75}) {
        const double L = 0.1, L1 = 0.03, dL = 0.02;
        const double u = dL / (1 + ratio * (L - L1) / L1);
        CHECK(evaluate({L, L1, dL, u})->linear / ratio == near(1, {.relative = 1e-12}));
        const double small = joint_of(ratio, L, L1, 1e-7);
        CHECK(evaluate({L, L1, 1e-7, small})->linear / ratio == near(1, {.relative = 1e-5}));
    }
}

TEST_CASE("at large strain the closed form gives the exact ratio, and the error of T3.7") {
    for (const double ratio : {0.3, 1.0, 2.0, 3.75, 10.0}) {
        for (const double L1 : {25.0, 50.0, 75.0}) {
            const auto row = evaluate({100, L1, 30, joint_of(ratio, 100, L1, 30)});
            REQUIRE(row);
            CHECK(row->neo_hookean / ratio == near(1, {.relative = 1e-9}));
            if (ratio > 1) CHECK(row->error() > 0);
            if (ratio < 1) CHECK(row->error() < 0);
        }
    }
    // By hand: 45 (a - 1/a^2) = 12 (b - 1/b^2) with a + b = 2.6 has a = 1.10286, so T3.7 gives (0.49714 / 0.10286).
    const auto row = evaluate({100, 50, 30, 5.143});
    CHECK(row->linear == near(4.833, {.relative = 1e-3}));
    CHECK(row->neo_hookean == near(3.745, {.relative = 1e-3}));
}

TEST_CASE("the joint of a simulated bar gives the ratio of its moduli within 1 %, because of the clamps") {
    Progress silent;
    RatioOptions options;
    options.cells = {24, 3, 3};
    const double joint_mm = reference_displacement_mm(options, 3.75, silent).value();
    CHECK(evaluate({0.1, 0.05, 0.03, joint_mm * 1e-3})->neo_hookean / 3.75 == near(1, {.relative = 0.01}));
}

TEST_CASE("the shape parameter is matched to a test, whichever part is held") {
    Progress silent;
    RatioOptions options;  // the bar that the match runs on
    options.cells = {12, 2, 2};
    options.strain = 0.2;
    const double joint_mm = blend_displacement_mm(options, 4, silent).value();
    const auto stiff_held = match_shape_parameter({1, 0.5, 0.2, joint_mm / 100}, silent, options.cells);
    REQUIRE_MESSAGE(stiff_held, (stiff_held ? "" : stiff_held.error().message));
    CHECK(*stiff_held / 4 == near(1, {.relative = 1e-3}));
    const auto soft_held = match_shape_parameter({1, 0.5, 0.2, 0.2 - joint_mm / 100}, silent, options.cells);
    REQUIRE(soft_held);
    CHECK(*soft_held / 4 == near(1, {.relative = 1e-3}));
    CHECK_FALSE(match_shape_parameter({1, 0.005, 0.2, 0.001}, silent, options.cells));  // no cell ends there
}

TEST_CASE("tables of tests are read in any unit of length") {
    const auto rows =
        parse_elongation_csv("Interface (cm);Length [mm];Joint (mm);Elongation (mm);who\n5;100;5.143;30;x\n", "t.csv");
    REQUIRE_MESSAGE(rows, (rows ? "" : rows.error().message));
    REQUIRE(rows->size() == 1);
    CHECK(rows->front().test.interface_m / 0.05 == near(1, {.relative = 1e-12}));
    CHECK(rows->front().linear == near(4.833, {.relative = 1e-3}));
    CHECK(elongation_text(*rows).find("4.833") != std::string::npos);
    CHECK(elongation_csv(*rows).find("100,50,30,5.143,4.83") != std::string::npos);
    const auto json = nlohmann::json::parse(elongation_json(*rows));
    CHECK(json["rows"][0]["joint_mm"].get<double>() == near(5.143, {.relative = 1e-12}));
    CHECK(json["half_width_95"] == 0);
    CHECK(json["shape_parameter_small_strain"].get<double>() == near((3 * 3.745 - 1) / 2, {.relative = 1e-3}));
}

TEST_CASE("several tests give a mean and its 95 % interval") {
    const auto rows = parse_elongation_csv(header + "100,50,0.002,0.0005\n100,50,0.002,0.0004\n", "t.csv");
    REQUIRE(rows);
    // Ratios 3 and 4 for springs, which bars match to 1e-4 at strains of 4e-5: mean 3.5, t(1) 12.706 times 0.5.
    const auto json = nlohmann::json::parse(elongation_json(*rows));
    CHECK(json["material_ratio"].get<double>() == near(3.5, {.relative = 1e-4}));
    CHECK(json["half_width_95"].get<double>() == near(6.353, {.relative = 2e-4}));
}

TEST_CASE("impossible tests are refused with their line") {
    check_elongation_problem("", "t.csv: is empty; the first line names the columns: length (mm)");
    check_elongation_problem("length (mm),interface (mm),joint (mm)\n1,2,3\n",
                             "t.csv:1: no column is named \"elongation\"");
    check_elongation_problem("length,interface (mm),elongation (mm),joint (mm)\n1,2,3,4\n", "length has no unit");
    check_elongation_problem("length (N),interface (mm),elongation (mm),joint (mm)\n1,2,3,4\n",
                             "t.csv:1: length: unknown unit \"N\"");
    check_elongation_problem(header + "100,50,30,5\n100,120,30,5\n",
                             "t.csv:3: interface: 120 mm is not within the bar");
    check_elongation_problem(header + "100,50,30,31\n", "joint: 31 mm is not possible");
    check_elongation_problem(header + "100,50,30,0\n", "joint: 0 mm is not possible");
    check_elongation_problem(header + "100,50,-30,-5\n", "elongation: -30 mm");
    check_elongation_problem(header + "0,0,30,5\n", "length: 0 mm");
    check_elongation_problem(header + "100,50,30,abc\n", "t.csv:2: joint \"abc\" is not a number");
}

TEST_CASE("the length is the column of that name, not another that begins with it") {
    const auto rows = parse_elongation_csv("length after test (mm)," + header + "130,100,50,30,5.14\n", "t.csv");
    REQUIRE_MESSAGE(rows, (rows ? "" : rows.error().message));
    CHECK((*rows)[0].test.length_m == near(0.1, {.relative = 1e-12}));
    check_elongation_problem(
        "length before (mm),length after (mm),interface (mm),elongation (mm),joint (mm)\n100,130,50,30,5.14\n",
        "could each be the length");
}

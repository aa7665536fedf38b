#include "simulation/calibrate/tensile_csv.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;
using calibrate::parse_tensile_csv;

namespace {

void check_problem(const std::string& text, const std::string& wanted) {
    const auto test = parse_tensile_csv(text, "test.csv");
    REQUIRE_FALSE(test);
    CHECK_MESSAGE(test.error().message.find(wanted) != std::string::npos, "found \"", test.error().message,
                  "\", wanted \"", wanted, "\"");
}

}  // namespace

TEST_CASE("a table of stretch and stress is read, with comments, blank lines and other columns") {
    const auto test = parse_tensile_csv("# a test\n\ntime (s),stretch,stress (MPa)\n0,1,0\n1, 1.5 ,0.25\r\n", "a.csv");
    REQUIRE(test);
    REQUIRE(test->stretch.size() == 2);
    CHECK(test->stretch[1] == 1.5);
    CHECK(test->stress_Pa[1] == near(0.25e6, {.relative = 1e-12}));
}

TEST_CASE("a table of strain in per cent is read, with semicolons, quotes, and true quantities beside") {
    const auto test = parse_tensile_csv(
        "\xEF\xBB\xBF\"Time (s)\";True Strain;True Stress (MPa);Engineering Strain (%);Engineering Stress [kPa]\n"
        "0.2;0.4;9;50;12.5\n",
        "a.csv");
    REQUIRE(test);
    CHECK(test->stretch[0] == near(1.5, {.relative = 1e-12}));
    CHECK(test->stress_Pa[0] == near(12500, {.relative = 1e-12}));
}

TEST_CASE("errors in a tensile table name the line") {
    check_problem("", "test.csv: is empty");
    check_problem("stretch,stress (MPa)\n", "no rows");
    check_problem("x,stress (MPa)\n1,2\n", "test.csv:1: no column is named \"stretch\"");
    check_problem("stretch,true stress (MPa)\n1,2\n", "not true stress");
    check_problem("stretch,stress\n1,2\n", "the stress has no unit");
    check_problem("stretch,stress (mPa)\n1,2\n", "unknown unit \"mPa\"");
    check_problem("strain (mm),stress (MPa)\n1,2\n", "unknown unit \"mm\" of strain");
    check_problem("stretch,stress (MPa)\n1,2\n1.1\n", "test.csv:3: 1 columns");
    check_problem("stretch,stress (MPa)\n1,2\n1.1,abc\n", "test.csv:3: stress \"abc\" is not a number");
    check_problem("stretch;stress (MPa)\n1,1;2\n", "write numbers with a decimal point");
    check_problem("stretch,stress (MPa)\n0,2\n", "test.csv:2: the stretch is 0");
    check_problem("strain,stress (MPa)\n-1.5,2\n", "the stretch is -0.5");
    check_problem("strain,stress (MPa)\n0,0\n5,0.05\n50,0.3\n",
                  "test.csv:4: a strain of 50 is 5000 %; name the column \"strain (%)\" if it is in percent, \"strain "
                  "(-)\" if not");
    CHECK(parse_tensile_csv("strain (-),stress (MPa)\n20,2\n", "a.csv"));
    check_problem("stretch,stress (MPa)\nnan,2\n", "is not a number");
    check_problem("stretch,stress (MPa)\n1e999,2\n", "is not a number");
}

TEST_CASE("a column is taken by its name, never a rate, and of several that could be meant none") {
    for (const char* const header :
         {"strain rate,strain,stress (MPa)", "strain rate (1/s),strain,stress (MPa)",
          "stress rate (MPa/s),nominal strain,stress (MPa)", "strainrate,calibrated strain,stress (MPa)"}) {
        const auto test = parse_tensile_csv(std::string(header) + "\n0.01,0.5,0.25\n", "a.csv");
        REQUIRE_MESSAGE(test, (test ? "" : test.error().message));
        CHECK(test->stretch[0] == near(1.5, {.relative = 1e-12}));
        CHECK(test->stress_Pa[0] == near(0.25e6, {.relative = 1e-12}));
    }
    const auto exact = parse_tensile_csv("strain in grips,strain,stress (MPa)\n0.1,0.5,0.25\n", "a.csv");
    REQUIRE(exact);
    CHECK(exact->stretch[0] == near(1.5, {.relative = 1e-12}));
    check_problem("strain rate,stress (MPa)\n1,2\n", "no column is named \"stretch\" or \"strain\"");
    check_problem("strain left,strain right,stress (MPa)\n1,1,2\n",
                  "test.csv:1: \"strain left\" and \"strain right\" could each be the strain");
    check_problem("stretch,stress (MPa),Stress (kPa)\n1,1,2\n", "\"stress (MPa)\" and \"Stress (kPa)\" could each be");
}

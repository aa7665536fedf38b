#include "presentation/print_report/plan_picture.hpp"

#include <doctest/doctest.h>

#include "presentation/draw/test_pixels.hpp"

using namespace pliant;
using namespace pliant::report;
using report::test::decode;
using report::test::Pixels;

namespace {

plan::Plan small_plan() {
    plan::Plan plan;
    plan.job = "finger";
    plan.printer = "tower";
    plan.layers = 10;
    plan.seconds = {100, 50, 25, 15, 10};
    plan.vats = {{0, 1, "soft", {0}, 1, 1, false, 0, 9, 0}, {3, 4, "firm", {1}, 1, 1, false, 2, 9, 0}};
    plan.order = {{0}, {0}, {0, 3}, {3, 0}, {0}, {}, {}, {}, {3}, {3}};
    return plan;
}

plan::SwapTimeline small_swap() {
    return {1,
            4,
            40,
            {plan::Device::carriage, plan::Device::pump, plan::Device::fans},
            {{plan::Device::carriage, 0, 10}, {plan::Device::pump, 10, 30}, {plan::Device::fans, 30, 40}}};
}

}  // namespace

TEST_CASE("consecutive layers of one vat form one run") {
    const plan::Plan plan = small_plan();
    CHECK(layer_runs(plan, 0) == std::vector<LayerRun>{{0, 4}});
    CHECK(layer_runs(plan, 3) == std::vector<LayerRun>{{2, 3}, {8, 9}});
    CHECK(layer_runs(plan, 1).empty());
}

TEST_CASE("the bars lie at their times and layers") {
    const Result<std::string> png = plan_picture(small_plan(), small_swap());
    REQUIRE(png);
    const Pixels p = decode(*png);
    REQUIRE(p.width == 1600);
    REQUIRE(p.height == 1000);
    // The charts run from x 220 to 1540, 1320 pixels. Time: half of it is swap, a quarter clean.
    CHECK(p.colour(230, 150) == p.colour(870, 150));
    CHECK(p.colour(870, 150) != p.colour(890, 150));
    CHECK(p.colour(890, 150) == p.colour(1200, 150));
    CHECK(p.colour(1200, 150) != p.colour(1220, 150));
    // Swap of 40 s, 33 pixels a second: rows of 44 pixels from y 282; the cleaning vat is the first, spray the second.
    const int carriage = 282 + 22, spray = 282 + 44 + 22;
    CHECK_FALSE(p.white(220 + 5 * 33 + 8, carriage));
    CHECK(p.white(220 + 12 * 33 + 8, carriage));
    CHECK(p.white(220 + 8 * 33 + 8, spray));
    CHECK_FALSE(p.white(220 + 20 * 33 + 8, spray));
    // Ten layers of 132 pixels, rows of 44 from y 642: the second vat prints layers 2, 3, 8 and 9.
    const int second = 642 + 44 + 22;
    for (int layer = 0; layer < 10; ++layer) {
        const bool printed = layer == 2 || layer == 3 || layer >= 8;
        CHECK(p.white(220 + 132 * layer + 66, second) == !printed);
    }
}

TEST_CASE("a plan without swaps or layers has a picture too") {
    plan::Plan plan;
    CHECK(plan_picture(plan, {}));
    plan.job.assign(300, 'x');
    plan.job.push_back('\xff');
    plan.layers = 1;
    plan.order = {{}};
    CHECK(plan_picture(plan, {}));
}

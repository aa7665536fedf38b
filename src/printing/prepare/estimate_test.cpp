#include "printing/prepare/estimate.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "printing/prepare/slice_job.hpp"
#include "printing/prepare/test_order.hpp"
#include "robot/file/robot_file.hpp"

using namespace pliant;
using namespace pliant::prepare;

namespace {

PrinterFile tower() {
    const std::string text = read_file("examples/printers/tower.toml").value();
    return {machine::parse_printer(text, "tower.toml").value(), text};
}

Drawing drawing(const char* file) {
    Progress silent;
    return drawing_of(robot::load_robot(file, {}).value(), silent).value();
}

Drawing blocks() {
    Drawing drawing = prepare::test::two_blocks();
    drawing.resin_of_material = {{"soft", "semi-flex"}, {"firm", "rigid-flex"}};
    return drawing;
}

}  // namespace

TEST_CASE("the estimate of prisms equals the plan of the sliced job") {
    const pliant::test::Folder folder;
    const PrinterFile printer = tower();
    for (const auto& [turn, copies] : {std::pair{std::vector<double>{}, 1}, {std::vector<double>{0, 0, 90}, 2}}) {
        Order order;
        order.inputs = {"blocks"};
        order.layer = "100 um";
        order.turn = turn;
        order.copies = copies;
        Progress silent;
        const auto made = slice_job(order, printer, blocks(), folder / "blocks.zip", silent);
        REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
        const auto guess = estimate(order, printer.printer, blocks());
        REQUIRE_MESSAGE(guess, (guess ? "" : guess.error().message));
        CHECK(guess->layers == made->plan.layers);
        CHECK(guess->swaps == made->plan.swaps);
        CHECK(guess->seconds.total == near(made->plan.seconds.total, {.relative = 1e-6}));
        for (std::size_t v = 0; v < guess->vats.size(); ++v)
            CHECK(guess->vats[v].resin_ml == near(made->plan.vats[v].resin_ml, {.relative = 0.01}));
    }
}

TEST_CASE("the estimate of a real robot is close to the plan of its sliced job") {
    const pliant::test::Folder folder;
    const PrinterFile printer = tower();
    Order order;
    order.inputs = {"finger.toml"};
    order.layer = "500 um";
    constexpr const char* finger = "examples/tutorial/finger.toml";
    Progress silent;
    const auto made = slice_job(order, printer, drawing(finger), folder / "finger.zip", silent);
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
    const auto guess = estimate(order, printer.printer, drawing(finger));
    REQUIRE_MESSAGE(guess, (guess ? "" : guess.error().message));
    CHECK(guess->layers == made->plan.layers);
    CHECK(guess->seconds.total == near(made->plan.seconds.total, {.relative = 0.02}));
}

TEST_CASE("orders that slicing refuses have no estimate") {
    Order order;
    order.copies = 100000;
    CHECK_FALSE(estimate(order, tower().printer, blocks()));
    order.copies = 1;
    order.layer = "thick";
    CHECK_FALSE(estimate(order, tower().printer, blocks()));
    order.layer = "";
    CHECK(estimate(order, tower().printer, blocks()));
}

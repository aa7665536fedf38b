#include "printing/prepare/estimate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "printing/job/png.hpp"
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

TEST_CASE("air that is cut out of a body is in no estimate and in no job") {
    const pliant::test::Folder folder;
    const PrinterFile printer = tower();
    Order order;
    order.inputs = {"blocks"};
    order.layer = "100 um";
    const auto cut = [] {
        Drawing drawing = blocks();
        // 3 x 2 x 3 of 4 x 4 x 3 mm
        drawing.bodies[0].air_um.push_back(prepare::test::box_um({9000, 1000, 5000}, {13000, 3000, 8000}));
        return drawing;
    };
    Progress silent;
    const auto made = slice_job(order, printer, cut(), folder / "blocks.zip", silent);
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
    const auto guess = estimate(order, printer.printer, cut());
    REQUIRE_MESSAGE(guess, (guess ? "" : guess.error().message));
    const auto whole = estimate(order, printer.printer, blocks());
    REQUIRE(whole);
    CHECK(made->manifest.materials[0].model_volume_mm3 == near(30, {.relative = 1e-6}));
    CHECK(guess->seconds.total == near(made->plan.seconds.total, {.relative = 1e-6}));
    for (std::size_t v = 0; v < guess->vats.size(); ++v)
        CHECK(guess->vats[v].resin_ml == near(made->plan.vats[v].resin_ml, {.relative = 0.01}));
    CHECK(guess->vats[0].resin_ml < 0.9 * whole->vats[0].resin_ml);
}

TEST_CASE("an order that lacks the support or the hollow that an option belongs to has no estimate") {
    const auto problem = [](const std::function<void(Order&)>& change) {
        Order order;
        order.inputs = {"blocks"};
        order.layer = "100 um";
        change(order);
        const auto guess = estimate(order, tower().printer, blocks());
        return guess ? std::string() : guess.error().message;
    };
    CHECK(problem([](Order& o) { o.raft = "1 mm"; }) == "--raft: needs --support MATERIAL");
    CHECK(problem([](Order& o) { o.drain = "1 mm"; }) == "--drain: needs --hollow");
    CHECK(problem([](Order& o) { o.hollow = o.drain = "1 mm"; }).empty());
}

TEST_CASE("supports that cannot be sliced have no estimate, for the same reason") {
    const pliant::test::Folder folder;
    const PrinterFile printer = tower();
    const auto problem = [&](const std::function<void(Order&)>& change) {
        Order order;
        order.inputs = {"blocks"};
        order.layer = "100 um";
        order.support = "soft";
        change(order);
        Progress silent;
        const auto guess = estimate(order, printer.printer, blocks());
        const auto made = slice_job(order, printer, blocks(), folder / "blocks.zip", silent);
        CHECK((guess ? "" : guess.error().message) == (made ? "" : made.error().message));
        return guess ? std::string() : guess.error().message;
    };
    const std::string header = "wish,x (mm),y (mm),z (mm),nx,ny,nz,radius (mm)\n";
    CHECK(problem([](Order& o) { o.support = "nothing"; }).starts_with("--support nothing: is neither a material"));
    CHECK(problem([](Order& o) { o.support_paint = "wish,x (mm)\nblock,1\n"; }).starts_with("supports:1: "));
    CHECK(problem([&](Order& o) { o.support_paint = header + "enforce,1,2,0,0,0,0,1\n"; }).starts_with("supports:2: "));
    CHECK(problem([](Order& o) { o.support = "", o.support_paint = "x"; }) ==
          "--support-paint: needs --support MATERIAL");
    CHECK_FALSE(problem([](Order& o) { o.support_angle = "100"; }).empty());
    CHECK_FALSE(problem([](Order& o) { o.support_tip = "900 mm"; }).empty());
    CHECK_FALSE(problem([](Order& o) { o.raft = "1 mm", o.lift = "1 mm"; }).empty());
    CHECK(problem([&](Order& o) { o.support_paint = header + "block,1,2,0,0,0,-1,1\n"; }).empty());
}

TEST_CASE("a resin of supports alone is allowed for an estimate, and takes no vat in it") {
    Order order;
    order.inputs = {"blocks"};
    order.layer = "100 um";
    const auto usual = estimate(order, tower().printer, blocks());
    REQUIRE(usual);
    order.support = "scaffold";
    order.resins = {"scaffold=tough"};
    const auto guess = estimate(order, tower().printer, blocks());
    REQUIRE_MESSAGE(guess, (guess ? "" : guess.error().message));
    CHECK(guess->vats.size() == usual->vats.size());
    CHECK(guess->seconds.total == usual->seconds.total);
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

TEST_CASE("exposures of layers that the job does not have, and a job that prints nothing, are refused") {
    const pliant::test::Folder folder;
    const PrinterFile printer = tower();
    const auto sliced = [&](const std::string& exposure, Drawing drawing) {
        Order order;
        order.inputs = {"blocks"};
        order.layer = "1 mm";
        if (!exposure.empty()) order.exposures = {exposure};
        Progress silent;
        return slice_job(order, printer, std::move(drawing), folder / "blocks.zip", silent);
    };
    const auto warned = [](const Result<SlicedJob>& made) {
        const std::string text = "the last layer is ";
        const auto& warnings = made.value().manifest.warnings;
        return std::any_of(warnings.begin(), warnings.end(),
                           [&](const std::string& w) { return w.find(text) != std::string::npos; });
    };
    const auto plain = sliced("", blocks());
    REQUIRE_MESSAGE(plain, (plain ? "" : plain.error().message));
    const auto count = static_cast<int>(plain->manifest.layers.size());
    const std::string name = blocks().resin_of_material[0].first;
    CHECK_FALSE(warned(sliced(fmt::format("{}:0-{}=4 s", name, count - 1), blocks())));
    CHECK(warned(sliced(fmt::format("{}:0-{}=4 s", name, count), blocks())));
    std::filesystem::remove(folder / "blocks.zip");
    CHECK(sliced(fmt::format("{}:{}-{}=4 s", name, count, count + 5), blocks()).error().message ==
          fmt::format("--exposure {}:{}-{}=4 s: the job has no such layers, its layers are 0 to {}, counted from 0",
                      name, count, count + 5, count - 1));
    // Every image of a stack may be dark.
    const std::filesystem::path dark = folder / "dark";
    std::filesystem::create_directories(dark);
    for (const char* image : {"a0.png", "a1.png"}) {
        const machine::Projector& p = printer.printer.projector;
        REQUIRE(write_file(dark / image, job::encode_png(slice::RunImage(p.width_px, p.height_px))));
    }
    Progress silent;
    const std::string message =
        sliced("", read_drawing({"semi-flex=" + dark.string()}, {}, silent).value()).error().message;
    CHECK(message.find("nothing is printed: not one pixel of 2 layers is lit") == 0);
    CHECK_FALSE(std::filesystem::exists(folder / "blocks.zip"));
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
    order.resins = {"soft=glue"};
    const auto unknown = estimate(order, tower().printer, blocks());
    REQUIRE_FALSE(unknown);
    CHECK(unknown.error().message.find("no vat of tower prototype holds the resin \"glue\" of \"soft\"") == 0);
    order.any_vat = true;
    CHECK(estimate(order, tower().printer, blocks()));
    order.hollow = "-1 mm";
    const auto inside_out = estimate(order, tower().printer, blocks());
    REQUIRE_FALSE(inside_out);
    CHECK(inside_out.error().message == "--hollow -1 mm: must be above 0 and at most 100 mm");
}

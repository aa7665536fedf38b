// Programs and their results folders through the public interface.
#include "pliant/program.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "library/simulation/test_bar.hpp"

using namespace pliant;
using test::bar;
namespace fs = std::filesystem;

namespace {

const char* const six_steps = "program = { steps = 6 }\n";

/// A watch that cancels when a step is reached.
Watch until(int step, const int& reached) {
    return [step, &reached](std::string_view, double) { return reached < step; };
}

}  // namespace

TEST_CASE("the steps of a program can be read after its end") {
    const ProgramResult result = run(Model(bar(six_steps)));
    CHECK(result.converged());
    CHECK(result.message().empty());
    CHECK(result.solver() == "newton");
    REQUIRE(result.step_count() == 7);
    CHECK(result.step(0).observed.cables[0].tension_N == 0);
    CHECK(result.step(3).observed.cables[0].length_m == near(0.058, {.relative = 1e-6}));
    CHECK(result.step(6).observed.cables[0].length_ratio == near(56.0 / 60, {.relative = 1e-6}));
    CHECK(result.step(6).positions.size() == result.step(0).positions.size());
    CHECK_THROWS_WITH_AS((void)result.step(7), "there is no step 7; the last is 6", Failure);
}

TEST_CASE("a cancelled run resumes from its checkpoint to the same steps") {
    const test::Folder folder;
    const Model model(bar(six_steps));
    const ProgramResult whole = run(model);
    int reached = 0, resumed = -1;
    RunOptions options{.on_step = [&](const ProgramStep& step) { reached = step.index; },
                       .checkpoint = folder / "kept",
                       .checkpoint_every = 1};
    const ProgramResult first = run(model, options, until(3, reached));
    CHECK_FALSE(first.converged());
    CHECK(first.step_count() == 4);
    CHECK_THROWS_WITH_AS((void)run(model, options),
                         ((folder / "kept").string() + ": holds this run up to step 3 of 6, which a new run would "
                                                       "delete; resume it, or remove the folder")
                             .c_str(),
                         Failure);
    options.resume = true;
    options.on_resume = [&](int step) { resumed = step; };
    const ProgramResult second = run(Model(bar(six_steps)), options);
    CHECK(resumed == 3);
    REQUIRE(second.converged());
    REQUIRE(second.step_count() == 7);
    for (std::size_t k = 0; k < 7; ++k) CHECK(second.step(k).positions == whole.step(k).positions);
    CHECK(fs::exists(folder / "kept"));
    options.resume = false;
    CHECK(run(model, options).converged());  // replaces what was finished
    options.resume = true;
    second.remove_checkpoint();
    CHECK_FALSE(fs::exists(folder / "kept"));
    CHECK_THROWS_AS((void)run(model, options), Failure);
    CHECK_THROWS_WITH_AS((void)run(model, {.resume = true}), "a checkpoint is asked for, but no folder is named for it",
                         Failure);
}

TEST_CASE("a checkpoint is of the robot that the file stands on, too") {
    const test::Folder folder;
    const fs::path file = folder / "program.toml", base = folder / "bar.toml";
    test::write(base, test::bar_text());
    test::write(file, "robot = \"bar.toml\"\nprogram.steps = 6\n");
    int reached = 0;
    RunOptions options{.on_step = [&](const ProgramStep& step) { reached = step.index; },
                       .checkpoint = folder / "kept",
                       .checkpoint_every = 1};
    CHECK_FALSE(run(Model(Robot::load(file)), options, until(3, reached)).converged());
    options.resume = true;
    test::write(base, test::bar_text("program.gravity = [0, 0, -9.81]\n"));
    CHECK_THROWS_AS((void)run(Model(Robot::load(file)), options), Failure);
    test::write(base, test::bar_text());
    CHECK(run(Model(Robot::load(file)), options).converged());
}

TEST_CASE("results are written whole, without pictures if they are not wanted, or not at all") {
    const test::Folder folder;
    ProgramResult result = run(Model(bar(six_steps)));
    CHECK(result.write(folder / "all", {.picture_size_px = {200, 120}}));
    for (const char* file : {"summary.json", "steps.csv", "markers.csv", "robot.glb", "report.html",
                             "pictures/final.png", "frames/frame_0006.vtu"})
        CHECK_MESSAGE(fs::exists(folder / "all" / file), file);
    CHECK(result.summary_json().find("\"converged\": true") != std::string::npos);
    CHECK_FALSE(result.write(folder / "all", {.enough_pictures = [] { return true; }}));
    CHECK_FALSE(fs::exists(folder / "all" / "pictures"));
    CHECK(fs::exists(folder / "all" / "summary.json"));
    CHECK_THROWS_AS(result.write(folder / "none", {}, [](std::string_view, double) { return false; }), Failure);
    CHECK_FALSE(fs::exists(folder / "none"));
    const auto throws = []() -> bool { throw std::logic_error("mine"); };
    CHECK_THROWS_AS(result.write(folder / "none", {.enough_pictures = throws}), std::logic_error);
    CHECK_FALSE(fs::exists(folder / "none"));
    CHECK_FALSE(fs::exists(folder / "none.partial"));
    CHECK_THROWS_AS(result.write(folder / "all", {.enough_pictures = throws}), std::logic_error);
    CHECK(fs::exists(folder / "all" / "summary.json"));  // the older results stay
    fs::create_directory(folder / "foreign");
    std::ofstream(folder / "foreign" / "letter.txt") << "mine";
    CHECK_THROWS_AS(result.write(folder / "foreign"), Failure);
    CHECK(fs::exists(folder / "foreign" / "letter.txt"));
    CHECK_THROWS_WITH_AS(result.write(folder / "small", {.picture_size_px = {10, 10}}),
                         "pictures of 10 x 10 pixels are not possible; write 100 to 10000 for each", Failure);
}

TEST_CASE("measured markers are read before anything is solved, and compared with the simulated ones") {
    const test::Folder folder;
    const Model model(bar(six_steps));
    REQUIRE(write_file(folder / "good.csv", "tip_x_mm,tip_y_mm,tip_z_mm\n60,5,5\n60,5,6\n"));
    const ProgramResult result = run(model, {.measured = folder / "good.csv"});
    REQUIRE(result.deviations().size() == 1);
    CHECK(result.deviations()[0].find("marker tip: 2 measured points") == 0);
    REQUIRE(write_file(folder / "bad.csv", "nose_x_mm\n60\n"));
    bool solved = false;
    const RunOptions options{.on_step = [&](const ProgramStep&) { solved = true; }, .measured = folder / "bad.csv"};
    try {
        (void)run(model, options);
        FAIL("a column of no marker passed");
    } catch (const Failure& failure) {
        CHECK(failure.file() == (folder / "bad.csv").string());
        CHECK(failure.line() == 1);
        CHECK(std::string(failure.what()).find(failure.file() + ":1: \"nose\" is not a marker") == 0);
    }
    CHECK_FALSE(solved);
}

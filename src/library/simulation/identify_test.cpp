// Parameter identification through the public interface.
#include "pliant/identify.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "library/simulation/test_bar.hpp"
#include "pliant/program.hpp"

using namespace pliant;
using test::bar;
namespace fs = std::filesystem;

namespace {

const char* const program = "program = { steps = 4, gravity = [0, 0, -9.81] }\n";

/// Synthetic measurements of the bar with 1 MPa.
Measurements measured() {
    const ProgramResult run = pliant::run(Model(bar(program)));
    Measurements table{"step,tip_z_mm,flexor_tension_N\n", "bar.csv"};
    for (std::size_t k = 1; k < run.step_count(); ++k) {
        const Observation seen = run.step(k).observed;
        table.csv +=
            fmt::format("{},{:.12g},{:.12g}\n", k, 1e3 * seen.markers[0].position_m[2], seen.cables[0].tension_N);
    }
    return table;
}

}  // namespace

TEST_CASE("a modulus is identified from the simulated motion of a robot") {
    const Robot other = Robot::parse(test::bar_text(program), {}, {"material.soft.youngs_modulus=0.7MPa"});
    const Identification found = identify(other, {"material.soft.youngs_modulus"}, measured(), JudgeOn::every_second);
    CHECK(found.converged());
    REQUIRE(found.estimates().size() == 1);
    const Estimate E = found.estimates()[0];
    CHECK(E.key == "material.soft.youngs_modulus");
    CHECK(E.start == near(0.7e6, {.relative = 1e-9}));
    CHECK(E.value == near(1e6, {.relative = 1e-4}));
    CHECK_FALSE(E.at_bound);
    CHECK(found.comparisons().size() == 8);
    CHECK(found.judged().size() == 2);
    CHECK(found.judged()[0].after < 0.01 * found.judged()[0].before);
    CHECK(found.trials() > 1);
    CHECK(found.correlation() == std::vector<std::vector<double>>{{1.0}});
    const ProgramResult run = pliant::run(Model(found.robot()));
    CHECK(run.step(4).observed.cables[0].tension_N ==
          near(pliant::run(Model(bar(program))).step(4).observed.cables[0].tension_N, {.relative = 1e-4}));
    const test::Folder folder;
    found.write(folder / "out");
    for (const char* file : {"identified.toml", "summary.json", "comparison.csv", "measured_mm.png"})
        CHECK_MESSAGE(fs::exists(folder / "out" / file), file);
    CHECK(Robot::load(folder / "out/identified.toml").steps() == 4);
}

TEST_CASE("a robot file that builds on another one is written whole, with the identified value") {
    const test::Folder folder;
    test::write(folder / "bar.toml", test::bar_text(program));
    test::write(folder / "again.toml",
                "robot = \"bar.toml\"\nset = [\"material.soft.youngs_modulus=0.8MPa\"]\n"
                "[program]\nsteps = 4\n");
    const Identification found =
        identify(Robot::load(folder / "again.toml"), {"material.soft.youngs_modulus"}, measured());
    CHECK(found.estimates()[0].value == near(1e6, {.relative = 1e-4}));
    found.write(folder / "out");
    CHECK(Robot::load(folder / "out/identified.toml").name() == "bar");
}

TEST_CASE("identification refuses an unknown key and unusable measurements") {
    CHECK_THROWS_AS((void)identify(bar(program), {"material.soft.youngs_module"}, measured()), Failure);
    CHECK_THROWS_AS((void)identify(bar(program), {"material.soft.youngs_modulus"}, {"step,nothing\n1,2\n"}), Failure);
    CHECK_THROWS_AS((void)Measurements::load("/nowhere.csv"), Failure);
    CHECK_THROWS_WITH_AS((void)Measurements::load(""), "the name of a file is empty", Failure);
    CHECK_THROWS_WITH_AS(
        (void)identify(bar(program), {"material.soft.youngs_modulus"}, measured(), static_cast<JudgeOn>(99)),
        "rows cannot be judged on 99; take one of JudgeOn", Failure);
    try {
        (void)identify(bar(program), {"material.soft.youngs_modulus"}, {"step,tip_z_mm\n1,5\n9,5\n", "m.csv"});
        FAIL("a step after the end passed");
    } catch (const Failure& failure) {
        CHECK(failure.file() == "m.csv");
        CHECK(failure.line() == 3);
    }
}

TEST_CASE("an exception of the Watch of an identification reaches the caller, also while the robot is meshed") {
    const auto identify_with = [](const Watch& watch) {
        (void)identify(bar(program), {"material.soft.youngs_modulus"}, {"step,tip_z_mm\n4,5\n"}, JudgeOn::nothing, {},
                       watch);
    };
    std::string first;
    const auto note_stage = [&](std::string_view stage, double) -> bool {
        first = stage;
        throw std::runtime_error("of the caller");
    };
    CHECK_THROWS_WITH_AS(identify_with(note_stage), "of the caller", std::runtime_error);
    CHECK(first != "trial");
    CHECK_THROWS_AS(identify_with([](std::string_view, double) { return false; }), Failure);
}

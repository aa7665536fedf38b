// Runs a robot file for tests: any error on the way ends the test.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <utility>
#include <vector>

#include "robot/file/robot_file.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/scene.hpp"

namespace pliant::robot::testing {

inline constexpr double g = 9.81;  ///< m/s^2

using Built = Scene;

inline Built build(Result<Robot> robot) {
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    Result<Scene> scene = build_scene(std::move(*robot), silent);
    REQUIRE_MESSAGE(scene, (scene ? "" : scene.error().message));
    return std::move(*scene);
}

inline Built build_text(const std::string& text, const std::vector<std::string>& assignments = {}) {
    return build(parse_robot(text, "bar.toml", assignments));
}

/// The error for a text, whether from reading or from building; "" if there is none.
inline std::string problem(const std::string& text, const std::vector<std::string>& assignments = {}) {
    Result<Robot> robot = parse_robot(text, "bar.toml", assignments);
    if (!robot) return robot.error().message;
    Progress silent;
    const Result<Scene> scene = build_scene(std::move(*robot), silent);
    return scene ? "" : scene.error().message;
}

inline void check_problem(const std::string& text, const std::string& wanted) {
    const std::string found = problem(text);
    CHECK_MESSAGE(found.find(wanted) != std::string::npos, "found \"", found, "\", wanted \"", wanted, "\"");
}

/// The test must check whether it converged.
inline sim::Trajectory run(const Built& built) {
    Progress silent;
    return sim::run(built.model, built.robot.program, silent);
}

inline sim::Trajectory run_to_the_end(const Built& built) {
    sim::Trajectory result = run(built);
    REQUIRE_MESSAGE(result.converged, result.message);
    return result;
}

inline sim::Step last_step(const Built& built) {
    return run_to_the_end(built).steps.back();
}

inline sim::Trajectory run_text(const std::string& text, const std::vector<std::string>& assignments = {}) {
    return run_to_the_end(build_text(text, assignments));
}

inline sim::Trajectory run_file(const std::string& path, const std::vector<std::string>& assignments) {
    return run_to_the_end(build(load_robot(path, assignments)));
}

}  // namespace pliant::robot::testing

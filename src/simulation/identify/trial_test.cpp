// Derivatives of measurements with respect to an unknown, against programs solved with slightly different values.
#include "simulation/identify/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "simulation/gradient/program_gradient.hpp"
#include "simulation/identify/test_bars.hpp"
#include "simulation/linearisation/parameters.hpp"

using namespace pliant;
using namespace pliant::sim::identify;
using namespace pliant::sim::identify::testing;

namespace {

/// Relative to the largest slope of each channel, or to a thousandth of its largest value. Programs are solved to
/// 1e-10.
void check_slopes(const std::string& text, const std::vector<std::string>& keys,
                  const std::vector<std::string>& columns, const std::vector<double>& times, double tolerance) {
    const Bar bar(text, {"program.tolerance=1e-10"});
    const auto unknowns = bar.unknowns(keys);
    const auto channels = bar.channels(columns);
    std::vector<double> values;
    for (const Unknown& unknown : unknowns) values.push_back(unknown.value);
    const auto trial = solve(bar, unknowns, values, channels, times);
    Progress silent;
    const auto slopes = trial->slopes(bar.source, unknowns, values, silent);
    REQUIRE_MESSAGE(slopes, (slopes ? "" : slopes.error().message));
    constexpr double step = 1.6e-2;  // so long that residuals of 1e-10 are not seen in differences
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const double u = unknowns[k].coordinate(values[k]);
        const auto at = [&](double of_u) {
            std::vector<double> moved = values;
            moved[k] = unknowns[k].value_at(of_u);
            return solve(bar, unknowns, moved, channels, times)->values();
        };
        const Eigen::MatrixXd wide = (at(u + 2 * step) - at(u - 2 * step)) / (4 * step);
        const Eigen::MatrixXd differences = (4 * (at(u + step) - at(u - step)) / (2 * step) - wide) / 3;
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const double size = differences.col(static_cast<Eigen::Index>(c)).cwiseAbs().maxCoeff();
            const double largest = 1e-3 * trial->values().col(static_cast<Eigen::Index>(c)).cwiseAbs().maxCoeff();
            for (std::size_t t = 0; t < times.size(); ++t) {
                CAPTURE(keys[k]);
                CAPTURE(columns[c]);
                CAPTURE(times[t]);
                CHECK((*slopes)[t](static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(k)) ==
                      near(differences(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(c)),
                           {.absolute = tolerance * (size + largest)}));
            }
        }
    }
}

const std::string shortened = R"(
    cable = [{ name = "flexor", points = [[0, 5, 9], [20, 5, 8], [40, 5, 9], [60, 5, 8]], target.shortening = "5 mm" }]
)";

}  // namespace

TEST_CASE("derivatives of markers, angles, lengths and forces at equilibrium") {
    check_slopes(shortened + "program = { steps = 3, gravity = [0, 2, -9.81] }",
                 {"material.firm.youngs_modulus", "material.soft.poisson_ratio", "material.firm.density",
                  "cable.flexor.target.offset", "cable.flexor.target.shortening"},
                 {"tip_x_mm", "tip_z_mm", "middle-tip_angle_x_deg", "middle-corner_angle_z_deg",
                  "middle-tip-corner_angle_deg", "flexor_length_ratio", "flexor_tension_N"},
                 {0, 0.2, 1.0 / 3, 1}, 1e-5);
}

TEST_CASE("derivatives of a support's force") {
    check_slopes("program = { steps = 2, gravity = [0, 2, -9.81] }",
                 {"material.firm.density", "material.soft.youngs_modulus"}, {"clamp_force_y_N", "clamp_force_z_N"},
                 {0.5, 1}, 1e-5);
}

TEST_CASE("derivatives by more unknowns than measured values, from transposed solutions") {
    check_slopes(shortened + "program = { steps = 2 }",
                 {"material.firm.youngs_modulus", "material.soft.youngs_modulus", "cable.flexor.target.offset"},
                 {"tip_z_mm"}, {0.4, 1}, 1e-5);
}

TEST_CASE("derivatives of a chamber's pressure, volume and gas") {
    const std::vector<std::string> columns = {"tip_x_mm", "air_volume_mm3", "air_pressure_kPa"};
    check_slopes("chamber = [{ name = \"air\", region = \"air\", target.pressure = \"9 kPa\" }]\nprogram.steps = 2",
                 {"chamber.air.target.offset", "chamber.air.target.pressure", "material.soft.youngs_modulus"}, columns,
                 {0.5, 1}, 1e-5);
    check_slopes("chamber = [{ name = \"air\", region = \"air\", target.gas_ratio = 1.3 }]\nprogram.steps = 2",
                 {"chamber.air.target.gas_ratio", "material.soft.youngs_modulus"}, columns, {0.5, 1}, 1e-5);
    check_slopes("chamber = [{ name = \"air\", region = \"air\", target.volume_ratio = 1.2 }]\nprogram.steps = 2",
                 {"chamber.air.target.offset", "chamber.air.target.volume_ratio"}, columns, {0.5, 1}, 1e-5);
}

TEST_CASE("derivatives for a swinging bar, through all earlier steps") {
    check_slopes("program = { duration = \"60 ms\", time_step = \"6 ms\", gravity = [0, 0, -9.81], mass_damping = 3 }",
                 {"material.soft.youngs_modulus", "material.soft.density", "program.mass_damping"},
                 {"tip_z_mm", "middle_z_mm", "clamp_force_z_N"}, {0.006, 0.016, 0.03, 0.06}, 1e-5);
}

TEST_CASE("derivatives by contact stiffness, for a bar lifted by a block") {
    check_slopes(R"(
        obstacle = [{ name = "block", geometry = { box = [[40, -3, -4], [80, 13, -1]] }, move = [0, 0, 3] }]
        contact = { stiffness = "60 kPa" }
        program = { steps = 3 }
    )",
                 {"contact.stiffness", "material.firm.youngs_modulus"},
                 {"block_force_z_N", "tip_z_mm", "block_force_x_N"}, {0.5, 1}, 1e-5);
}

TEST_CASE("forward derivatives through earlier steps equal the adjoint ones, also with contact friction") {
    for (const char* text : {R"(
        obstacle = [{ name = "block", geometry.box = [[40, -3, -4], [80, 13, -1]], friction = 0.3, move = [0, 0, 3] }]
        contact = { stiffness = "60 kPa" }
        program = { steps = 3 }
    )",
                             "program = { duration = \"30 ms\", time_step = \"5 ms\", gravity = [0, 0, -9.81], "
                             "mass_damping = 3, stiffness_damping = 0.004 }"}) {
        const Bar bar(text);
        const auto unknowns = bar.unknowns({"material.firm.youngs_modulus", "material.soft.youngs_modulus"});
        const std::vector<double> values = {unknowns[0].value, unknowns[1].value};
        const auto variant = bar.variant();
        const double end = variant->program.duration;
        const auto channels = bar.channels({"tip_z_mm"});
        const auto trial = solve(bar, unknowns, values, channels, {end});
        Progress silent;
        const auto slopes = trial->slopes(bar.source, unknowns, values, silent);
        REQUIRE_MESSAGE(slopes, (slopes ? "" : slopes.error().message));
        const auto back = sim::program_gradient(
            variant->model, variant->program, sim::at_end(channels[0].measures[0], variant->program.steps), {}, silent);
        REQUIRE_MESSAGE(back, (back ? "" : back.error().message));
        const sim::Equilibrium system(variant->model);
        const auto at = sim::Linearisation::create(system, system.rest(), system.controls(0));
        REQUIRE(at);
        const auto parameters = sim::parameters(*at);
        for (std::size_t k = 0; k < unknowns.size(); ++k) {
            const auto by = std::ranges::find(
                parameters, k == 0 ? "material \"firm\": youngs_modulus" : "material \"soft\": youngs_modulus",
                &sim::Parameter::name);
            REQUIRE(by != parameters.end());
            CHECK((*slopes)[0](0, static_cast<Eigen::Index>(k)) ==
                  near(1e3 * values[k] * back->by.parameters[by - parameters.begin()], {.relative = 1e-7}));
        }
    }
}

TEST_CASE("an unknown has derivatives where the robot file allows no larger value") {
    const Bar bar(test::replaced(shortened, "target", "friction = 0.1, target") + "program = { steps = 1 }");
    const auto unknowns = bar.unknowns({"cable.flexor.friction"});
    const auto trial = solve(bar, unknowns, {unknowns[0].value}, bar.channels({"tip_z_mm"}), {1});
    Progress silent;
    const auto slopes = trial->slopes(bar.source, unknowns, std::vector<double>{unknowns[0].high}, silent);
    REQUIRE_MESSAGE(slopes, (slopes ? "" : slopes.error().message));
    CHECK((*slopes)[0].allFinite());
    CHECK((*slopes)[0](0, 0) != 0);
}

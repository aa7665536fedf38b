// Parameters used in a simulation are recovered from synthetic measurements.
#include "simulation/identify/identify.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/core/near.hpp"
#include "simulation/identify/test_bars.hpp"

using namespace pliant;
using namespace pliant::sim::identify;
using namespace pliant::sim::identify::testing;

namespace {

const std::string pulled = R"(
    cable = [{ name = "flexor", points = [[0, 5, 9], [20, 5, 9], [40, 5, 9], [60, 5, 9]], target.tension = "3 N" }]
    program = { steps = 4 }
)";
const std::string heavy = "program = { steps = 2, gravity = [0, 0, -9.81] }\n";

/// Exact data give back the values that generated them, starting from those of the file.
void check_found(const Bar& bar, const std::vector<std::string>& keys, const std::vector<double>& truth,
                 const std::vector<std::string>& columns, const std::vector<double>& times) {
    const auto unknowns = bar.unknowns(keys);
    const auto data = bar.read(table_of(bar, unknowns, truth, columns, times, undisturbed));
    const Identification result = find(bar, unknowns, data);
    CHECK(result.converged);
    for (std::size_t k = 0; k < keys.size(); ++k) {
        CAPTURE(keys[k]);
        CHECK(std::fabs(result.found[k].unknown.value / truth[k] - 1) > 0.04);
        CHECK(result.found[k].value == near(truth[k], {.relative = 1e-6}));
    }
    for (const Errors& errors : result.fitted) CHECK(errors.after < 1e-5 * errors.before);
}

/// A bar far above the origin, with the bending cable of `at`.
Bar bar_at(double z) {
    mesh::TetMesh mesh = bar_mesh(false);
    for (Vec3& point : mesh.points) point.z += 1e-3 * z;
    return Bar(fmt::format(R"(
        name = "bar"
        length_unit = "mm"
        material.firm = {{ youngs_modulus = "2 MPa", poisson_ratio = 0.4 }}
        material.soft = {{ youngs_modulus = "0.7 MPa", poisson_ratio = 0.42 }}
        mesh = {{ file = "memory:", order = 1 }}
        body = [{{ name = "root", material = "firm", region = "root" }},
                {{ name = "end", material = "soft", region = "end" }}]
        fixed = [{{ name = "clamp", box = [[0, 0, {0}], [0, 10, {1}]] }}]
        marker = [{{ name = "tip", point = [60, 5, {2}] }}]
        cable = [{{ name = "flexor", points = [[0, 5, {3}], [30, 5, {3}], [60, 5, {3}]], target.length_ratio = 0.9 }}]
        program = {{ steps = 4 }}
    )",
                           z - 1, z + 11, z + 5, z + 9),
               std::move(mesh));
}

/// Of normal distribution, always the same.
class Noise {
public:
    double operator()(int) {
        double sum = -6;
        for (int k = 0; k < 12; ++k) {
            state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
            sum += static_cast<double>(state_ >> 11U) / 9007199254740992.0;
        }
        return size_ * sum;
    }
    explicit Noise(double size, unsigned long long seed) : size_(size), state_(seed) {}

private:
    double size_;
    unsigned long long state_;
};

bool has_warning(const Identification& result, const std::vector<std::string>& words) {
    return std::ranges::any_of(result.warnings, [&](const std::string& warning) {
        return std::ranges::all_of(words,
                                   [&](const std::string& word) { return warning.find(word) != std::string::npos; });
    });
}

}  // namespace

TEST_CASE("two moduli are identified from markers") {
    check_found(Bar(pulled), {"material.firm.youngs_modulus", "material.soft.youngs_modulus"}, {1.1e6, 0.95e6},
                {"middle_x_mm", "middle_z_mm", "tip_x_mm", "tip_z_mm"}, {0.5, 1});
}

TEST_CASE("constants of a law with a list of constants are identified") {
    const Bar bar(pulled,
                  {R"(material.soft={law="ogden", mu=["0.2 MPa", "20 kPa"], alpha=[1.5, 4], poisson_ratio=0.42})"});
    check_found(bar, {"material.soft.mu.0", "material.soft.alpha.1"}, {0.24e6, 5.5},
                {"tip_x_mm", "tip_z_mm", "flexor_length_mm"}, {0.25, 0.5, 0.75, 1});
}

TEST_CASE("Poisson's ratio is identified from lateral contraction") {
    const Bar bar(R"(
        load = [{ name = "pull", box = [[60, 0, 0], [60, 10, 10]], force = ["12 N", "0 N", "0 N"] }]
        program = { steps = 2 }
    )");
    check_found(bar, {"material.soft.poisson_ratio"}, {0.47}, {"tip_x_mm", "corner_y_mm", "corner_z_mm"}, {0.5, 1});
}

TEST_CASE("the offset of a pressure gauge is identified") {
    const Bar bar(R"(
        chamber = [{ name = "air", region = "air", target.pressure = "12 kPa" }]
        program = { steps = 3 }
    )");
    check_found(bar, {"chamber.air.target.offset", "material.firm.youngs_modulus"}, {1.7e3, 1.7e6},
                {"tip_x_mm", "air_volume_mm3", "air_pressure_kPa"}, {0.2, 0.6, 1});
}

TEST_CASE("the offset of a cable's zero length is identified") {
    const Bar bar(R"(
        cable = [{ name = "flexor", points = [[0, 5, 9], [30, 5, 9], [60, 5, 9]], target.length_ratio = 0.9 }]
        program = { steps = 4 }
    )");
    check_found(bar, {"cable.flexor.target.offset", "material.soft.youngs_modulus"}, {0.8e-3, 0.9e6},
                {"tip_x_mm", "tip_z_mm", "flexor_tension_N"}, {0.1, 0.5, 1});
}

TEST_CASE("the free length of a spring is identified, though the file does not give it") {
    check_found(Bar(R"(
        spring = [{ name = "band", points = [[0, 5, 9], [30, 5, 9], [60, 5, 9]], stiffness = "200 N/m" }]
        program = { steps = 2 }
    )"),
                {"spring.band.free_length"}, {0.05}, {"tip_x_mm", "tip_z_mm", "band_force_N"}, {1});
}

TEST_CASE("modulus and damping are identified from a swinging bar") {
    const Bar bar(R"(
        program = { duration = "120 ms", time_step = "6 ms", gravity = [0, 0, -9.81], stiffness_damping = 0.002 }
    )");
    check_found(bar, {"material.soft.youngs_modulus", "program.stiffness_damping"}, {0.8e6, 0.003},
                {"tip_z_mm", "middle_z_mm"}, {0.02, 0.05, 0.08, 0.1, 0.12});
}

TEST_CASE("a cable's friction is identified from its tension") {
    const Bar bar(R"(
        [program]
        steps = 4
        [[cable]]
        name = "flexor"
        points = [[0, 5, 9], [20, 5, 8], [40, 5, 9], [60, 5, 8]]
        friction = 0.1
        target.shortening = "6 mm"
    )");
    check_found(bar, {"cable.flexor.friction"}, {0.25}, {"tip_z_mm", "flexor_tension_N"}, {0.5, 1});
}

TEST_CASE("the density is identified from a bar under its own weight") {
    check_found(Bar(heavy), {"material.soft.density"}, {1300}, {"tip_z_mm"}, {0.5, 1});
}

TEST_CASE("a modulus is identified from contact forces, which depend on it through the contact stiffness") {
    const Bar bar(R"(
        obstacle = [{ name = "block", geometry = { box = [[40, -3, -4], [80, 13, -1]] }, move = [0, 0, 3] }]
        program = { steps = 4 }
    )");
    check_found(bar, {"material.soft.youngs_modulus"}, {0.8e6}, {"block_force_z_N", "clamp_force_z_N"}, {0.5, 1});
}

TEST_CASE("unknowns that cannot be separated, and unknowns without effect, are named") {
    const Bar bar(R"(
        load = [{ name = "press", box = [[30, 0, 10], [60, 10, 10]], pressure = "5 kPa" }]
        program = { steps = 2 }
    )");
    const auto both = bar.unknowns({"load.press.pressure", "material.firm.youngs_modulus"});
    const auto all = bar.unknowns({"load.press.pressure", "material.firm.youngs_modulus",
                                   "material.soft.youngs_modulus", "material.soft.density"});
    const std::vector<std::string> columns = {"middle_z_mm", "tip_x_mm", "tip_z_mm"};
    const auto data = bar.read(table_of(bar, both, {6e3, 2.2e6}, columns, {0.5, 1}, undisturbed));
    const Identification result = find(bar, all, data);
    CHECK(has_warning(result, {"load.press.pressure", "material.firm.youngs_modulus", "material.soft.youngs_modulus",
                               "cannot be told apart"}));
    CHECK(has_warning(result, {"material.soft.density", "nothing that was measured depends on it"}));
    CHECK_FALSE(result.found[3].matters);
    CHECK_FALSE(result.found[0].low);
    CHECK(result.fitted[0].after < 1e-4 * result.fitted[0].before);
    // With a force beside them each has its own effect.
    const auto forces =
        bar.read(table_of(bar, both, {6e3, 2.2e6}, {"tip_z_mm", "clamp_force_z_N"}, {0.25, 0.5, 0.75, 1}, undisturbed));
    const Identification told = find(bar, both, forces);
    CHECK(told.warnings.empty());
    CHECK(told.found[0].value == near(6e3, {.relative = 1e-6}));
}

TEST_CASE("an unknown at its bound is reported") {
    const Bar bar(pulled);
    const auto free = bar.unknowns({"material.soft.youngs_modulus"});
    const auto data = bar.read(table_of(bar, free, {1.2e6}, {"tip_z_mm"}, {0.5, 1}, undisturbed));
    const auto bound = bar.unknowns({"material.soft.youngs_modulus=0.5 MPa..1 MPa"});
    const Identification result = find(bar, bound, data);
    CHECK(result.found[0].value == bound[0].high);  // to the last bit
    CHECK(result.found[0].at_bound);
    CHECK_FALSE(result.found[0].low);
    CHECK(has_warning(result, {"material.soft.youngs_modulus", "is at its bound, 1 MPa"}));
}

TEST_CASE("a damping that the data take below zero is zero, with an interval from zero") {
    const Bar bar(R"(
        program = { duration = "120 ms", time_step = "6 ms", gravity = [0, 0, -9.81], mass_damping = 5 }
    )");
    const auto unknowns = bar.unknowns({"program.mass_damping"});
    const std::vector<std::string> columns = {"tip_z_mm", "middle_z_mm"};
    const std::vector<double> times = {0.02, 0.04, 0.05, 0.06, 0.08, 0.1, 0.12};
    const auto at = [&](double damping) {
        return solve(bar, unknowns, {damping}, bar.channels(columns), times)->values();
    };
    // As with a damping of about -1, in noise that leaves it open.
    const Eigen::MatrixXd rest = at(0), damped = at(4);
    Noise noise(0.003, 3);
    std::string csv = "time,tip_z_mm,middle_z_mm";
    for (std::size_t t = 0; t < times.size(); ++t) {
        const auto row = static_cast<Eigen::Index>(t);
        csv += fmt::format("\n{}", times[t]);
        for (Eigen::Index c = 0; c < 2; ++c)
            csv += fmt::format(",{:.15g}", rest(row, c) - 0.25 * (damped(row, c) - rest(row, c)) + noise(0));
    }
    const Identification result = find(bar, unknowns, bar.read(csv + "\n"));
    CHECK(result.converged);
    const Found& found = result.found[0];
    CHECK(found.matters);
    CHECK(found.at_bound);
    CHECK(found.value == 0);
    REQUIRE(found.high);
    CHECK(*found.low == 0);
    CHECK(*found.high > 0);
    CHECK(*found.high < 20);
    CHECK(has_warning(result, {"program.mass_damping", "is at its bound, 0", "allow up to"}));
}

TEST_CASE("95 % intervals hold the true value in about 95 % of tries, and held-out rows judge the fit") {
    const Bar bar(pulled, {"program.steps=2"});
    const auto unknowns = bar.unknowns({"material.firm.youngs_modulus", "material.soft.youngs_modulus"});
    const std::array truth = {1.6e6, 0.8e6};
    const std::vector<std::string> columns = {"middle_x_mm", "middle_z_mm", "tip_x_mm", "tip_z_mm"};
    std::array<int, 2> held{};
    constexpr int repeats = 20;
    for (int k = 0; k < repeats; ++k) {
        const auto data = bar.read(table_of(bar, unknowns, {truth.begin(), truth.end()}, columns, {0.5, 1},
                                            Noise(0.1, 17 + static_cast<unsigned long long>(k))));
        const Identification result = find(bar, unknowns, data);
        for (std::size_t j = 0; j < 2; ++j)
            held[j] += *result.found[j].low < truth[j] && truth[j] < *result.found[j].high ? 1 : 0;
    }
    // With correct intervals, 16 or fewer of 20 occur once in 60 times.
    CHECK(held[0] >= 16);
    CHECK(held[1] >= 16);

    const auto halves = bar.read(table_of(bar, unknowns, {truth.begin(), truth.end()}, columns,
                                          {0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1}, Noise(0.05, 3)),
                                 JudgeOn::every_second);
    const Identification result = find(bar, unknowns, halves);
    REQUIRE(result.judged.size() == 1);
    CHECK(result.fitted[0].values == 16);
    CHECK(result.judged[0].values == 16);
    CHECK(result.judged[0].before > 0.2);
    CHECK(result.judged[0].after == near(0.05, {.relative = 0.4}));
    CHECK(result.fitted[0].after == near(0.05, {.relative = 0.4}));
}

TEST_CASE("what is found does not depend on where the robot is") {
    std::vector<Found> found;
    for (const double z : {0.0, 400.0}) {
        const Bar bar = bar_at(z);
        const auto unknowns = bar.unknowns({"material.soft.youngs_modulus"});
        Noise noise(0.1, 5);
        const auto data = bar.read(table_of(bar, unknowns, {1e6}, {"tip_x_mm", "tip_z_mm", "flexor_tension_N"},
                                            {0.25, 0.5, 0.75, 1}, [&](int k) { return noise(k); }));
        found.push_back(find(bar, unknowns, data).found[0]);
    }
    CHECK(found[1].value == near(found[0].value, {.relative = 1e-6}));
    CHECK(*found[1].low == near(*found[0].low, {.relative = 1e-6}));
    CHECK(*found[1].high == near(*found[0].high, {.relative = 1e-6}));
}

TEST_CASE("95 % intervals hold for values in two units, with noise of their own") {
    const Bar bar = bar_at(0);
    const auto unknowns = bar.unknowns({"material.firm.youngs_modulus", "material.soft.youngs_modulus"});
    const std::vector<double> truth = {1.6e6, 0.8e6};
    const std::vector<std::string> columns = {"tip_x_mm", "tip_z_mm", "flexor_tension_N"};
    for (const auto& [of_mm, of_N] : {std::pair(0.3, 0.01), std::pair(0.005, 0.2)}) {
        CAPTURE(of_mm);
        std::array<int, 2> held{};
        for (int k = 0; k < 20; ++k) {
            Noise noise(1, 17 + static_cast<unsigned long long>(k));
            const auto data = bar.read(table_of(bar, unknowns, truth, columns, {0.25, 0.5, 0.75, 1},
                                                [&](int i) { return noise(i) * (i % 3 == 2 ? of_N : of_mm); }));
            const Identification result = find(bar, unknowns, data);
            for (std::size_t j = 0; j < 2; ++j)
                held[j] += *result.found[j].low < truth[j] && truth[j] < *result.found[j].high ? 1 : 0;
        }
        CHECK(held[0] >= 16);
        CHECK(held[1] >= 16);
    }
}

TEST_CASE("too few values of a unit leave an interval open, which is said") {
    const Bar bar(pulled);
    const auto unknowns = bar.unknowns({"material.firm.youngs_modulus", "material.soft.youngs_modulus"});
    const auto data = bar.read("time,tip_z_mm,tip-middle_angle_x_deg\n0.25,5.6,\n0.5,6.4,\n0.75,7.1,\n1,8.1,170\n");
    const Identification result = find(bar, unknowns, data);
    CHECK_FALSE(result.found[0].low);
    CHECK(has_warning(result, {"the values in deg are too few to show their noise"}));
}

TEST_CASE("the same bits on any number of threads") {
    const Bar bar(pulled);
    const auto unknowns = bar.unknowns({"material.firm.youngs_modulus", "material.soft.youngs_modulus"});
    const auto data = bar.read("time,middle_z_mm,tip_z_mm\n0.5,11,14\n1,12,23\n");
    std::vector<std::string> found;
    for (const std::size_t threads : {1, 3}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const Identification result = find(bar, unknowns, data);
        found.push_back(identification_json(result) + comparison_csv(result));
    }
    CHECK(found[0] == found[1]);
}

TEST_CASE("a value with a large scatter has little weight") {
    const Bar bar(pulled);
    const auto unknowns = bar.unknowns({"material.soft.youngs_modulus"});
    const auto channels = bar.channels({"tip_z_mm"});
    const auto trial = solve(bar, unknowns, {0.9e6}, channels, {0.5, 1});
    const auto data = bar.read(fmt::format("time,tip_z_mm,tip_z_mm_scatter\n0.5,{:.12g},1\n1,{:.12g},0.001\n",
                                           trial->values()(0, 0) + 2, trial->values()(1, 0)));
    CHECK(find(bar, unknowns, data).found[0].value == near(0.9e6, {.relative = 1e-5}));
}

TEST_CASE("impossible requests are reported in one line") {
    const Bar bar(pulled);
    const auto E = bar.unknowns({"material.soft.youngs_modulus"});
    const auto data = bar.read("time,tip_z_mm\n1,8\n");
    Progress silent;
    const auto problem = [&](const std::vector<Unknown>& unknowns) {
        const auto result = sim::identify::identify(bar.source, unknowns, data, silent);
        return result ? "" : result.error().message;
    };
    CHECK(problem({}) == "there is nothing to find; name an unknown");
    CHECK(problem({E[0], E[0]}) == "material.soft.youngs_modulus: is named twice");
    CHECK(problem({E[0], bar.unknowns({"material.firm.youngs_modulus"})[0]}) ==
          "m.csv: 1 measured values cannot give 2 unknowns");
    struct Stop : Progress {
        [[nodiscard]] bool cancelled() const override { return true; }
    } stop;
    const auto result = sim::identify::identify(bar.source, E, data, stop);
    REQUIRE_FALSE(result);
    CHECK(result.error().cause == Cause::cancelled);
}

TEST_CASE("values that the robot file does not allow make a step shorter, and those that are wanted are told") {
    const Bar bar(heavy);
    const auto unknowns = bar.unknowns({"material.soft.youngs_modulus"});
    const auto data = bar.read(table_of(bar, unknowns, {0.35e6}, {"tip_z_mm"}, {0.5, 1}, undisturbed));
    auto mesh = robot::take_mesh(bar.robot(), bar_mesh(false));
    REQUIRE(mesh);
    const auto found = [&](double least_Pa) {
        const Source limited(
            [&, least_Pa](const std::vector<std::string>& set) -> Result<robot::Robot> {
                auto robot = robot::parse_robot(bar.text, "bar.toml", set);
                if (robot && std::ranges::any_of(robot->materials,
                                                 [&](const auto& m) { return m.youngs_modulus_Pa < least_Pa; }))
                    return input_error("bar.toml: too soft");
                return robot;
            },
            *mesh);
        Progress silent;
        auto result = identify(limited, unknowns, data, silent);
        REQUIRE_MESSAGE(result, (result ? "" : result.error().message));
        return std::move(*result);
    };
    // From twice the modulus the first step goes to 0.26 MPa.
    const Identification within = found(0.3e6);
    CHECK(within.found[0].value == near(0.35e6, {.relative = 1e-6}));
    CHECK(within.warnings.empty());
    const Identification beyond = found(0.5e6);
    CHECK(beyond.found[0].value >= 0.5e6);
    CHECK(beyond.found[0].value < 0.6e6);
    REQUIRE_FALSE(beyond.warnings.empty());
    CHECK(beyond.warnings.back() ==
          "the data ask for values that the robot file does not allow, and the search ended before them: bar.toml: too "
          "soft");
}

TEST_CASE("rows that are held out do not change what is found") {
    const Bar bar(pulled);
    const auto unknowns = bar.unknowns({"material.soft.youngs_modulus"});
    const std::string table = table_of(bar, unknowns, {0.8e6}, {"tip_z_mm", "flexor_length_ratio"}, {0.5, 1},
                                       [](int k) { return k % 2 == 0 ? 0.2 : 0.003; });
    std::string rows;
    for (std::size_t begin = 0, end = 0; (end = table.find('\n', begin)) != std::string::npos; begin = end + 1)
        rows += table.substr(begin, end - begin) + (begin == 0 ? ",use\n" : ",fit\n");
    const double alone = find(bar, unknowns, bar.read(rows)).found[0].value;
    CHECK(find(bar, unknowns, bar.read(rows + "1,300,0.2,judge\n")).found[0].value == alone);
}

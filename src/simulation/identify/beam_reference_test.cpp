// A silicone beam under its own weight and with a weight at its tip: the modulus is identified from the first test, the
// second is predicted.
#include <doctest/doctest.h>

#include <string>

#include "base/core/near.hpp"
#include "simulation/identify/test_bars.hpp"

using namespace pliant;
using namespace pliant::sim::identify;
using namespace pliant::sim::identify::testing;
namespace reference = pliant::sim::reference;

namespace {

/// 100 x 30 x 30 mm, clamped at x = 0; the weight hangs at the upper edge of the tip.
const std::string beam_text = R"(
    name = "beam"
    length_unit = "mm"
    material.silicone = { youngs_modulus = "150 kPa", poisson_ratio = 0.499, density = "1070 kg/m^3" }
    mesh = { file = "memory:", order = 2 }
    body = [{ name = "beam", material = "silicone", region = "all" }]
    fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 30, 30]] }]
    load = [{ name = "weight", box = [[99.9, -1, 28.9], [101, 31, 31]], force = ["0 N", "0 N", "-0.51012 N"] }]
    marker = [{ name = "tip1", point = [100, 15, 30] }, { name = "tip2", point = [100, 0, 24] },
              { name = "tip3", point = [100, 30, 6] }]
    [program]
    gravity = [0, 0, -9.81]
    steps = 4
    [[program.key]]
    time = "1 s"
    gravity = 1
    weight = 0
    [[program.key]]
    time = "2 s"
    weight = 1
)";

/// The uppermost layer is thin, so that the weight hangs at the edge.
mesh::TetMesh beam_mesh() {
    mesh::TetMesh mesh = reference::kuhn_box({0.1, 0.03, 0.03}, 20, 6, 6, [](Vec3) { return 0; });
    for (Vec3& p : mesh.points) {
        if (p.z > 0.0249 && p.z < 0.0251) p.z = 0.029;
    }
    return mesh;
}

/// Heights of the markers' feet, from their displacements; the parts of markers above the surface move alike to 0.03
/// mm.
std::string heights_of(const std::string& path) {
    std::string text = "time,use,tip1_z_mm,tip2_z_mm,tip3_z_mm\n";
    const auto rows = reference::load_csv(path);
    for (std::size_t k = 0; k + 2 < rows.size(); k += 3) {
        const bool loaded = std::stod(rows[k].at("tip_load_N")) > 0;
        text += loaded ? "2,judge" : "1,fit";
        for (std::size_t m = 0; m < 3; ++m) {
            REQUIRE(rows[k + m].at("marker") == fmt::format("tip{}", m + 1));
            const double foot_mm = m == 0 ? 30 : (m == 1 ? 24 : 6);
            text += fmt::format(",{:.6g}", foot_mm + std::stod(rows[k + m].at("dz_mm")));
        }
        text += "\n";
    }
    return text;
}

}  // namespace

TEST_CASE("beam of Dragon Skin 10: the modulus from its own weight predicts its tip under a dead load within 4 %") {
    const Bar beam(beam_text, beam_mesh());
    const auto data = beam.read(heights_of(reference::data_folder() + "/experiments/beam_dragonskin10/static.csv"));
    const auto unknowns = beam.unknowns({"material.silicone.youngs_modulus"});
    const Identification result = find(beam, unknowns, data);
    const Found& E = result.found[0];
    MESSAGE("E ", E.unknown.shown(E.value), " (", E.unknown.shown(*E.low), " to ", E.unknown.shown(*E.high),
            "); gravity, rms ", result.fitted[0].before, " -> ", result.fitted[0].after, " mm; 0.51 N, rms ",
            result.judged[0].before, " -> ", result.judged[0].after, " mm");
    CHECK(result.converged);
    // The value stated in the data's own documentation for a converged mesh.
    CHECK(E.value > 265e3);
    CHECK(E.value < 285e3);
    CHECK(*E.low > 255e3);
    CHECK(*E.high < 295e3);
    CHECK(result.fitted[0].values == 6);
    CHECK(result.fitted[0].after < 0.1);
    CHECK(result.judged[0].values == 3);
    // The weight's string is not quite in the middle: the sides, tip2 and tip3, differ by up to 0.8 mm from each other.
    for (const Compared& value : result.values) {
        if (!value.measured.judged) continue;
        const bool middle = value.measured.channel == 0;
        const double foot_mm = middle ? 30 : (value.measured.channel == 1 ? 24 : 6);
        CHECK(value.after - foot_mm == near(value.measured.value - foot_mm, {.relative = middle ? 0.04 : 0.07}));
    }
}

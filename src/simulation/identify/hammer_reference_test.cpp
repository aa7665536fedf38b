// Two silicone bars with a head that hang by their own weight: each modulus is identified from the head's rotation, and
// validated by its corners.
#include <doctest/doctest.h>

#include <array>
#include <string>

#include "base/core/near.hpp"
#include "simulation/identify/test_bars.hpp"

using namespace pliant;
using namespace pliant::sim::identify;
using namespace pliant::sim::identify::testing;
namespace reference = pliant::sim::reference;

namespace {

/// The free part: a shaft of 140 x 30 x 30 mm from the clamp at x = 0 to -x, and a head of 30 x 60 x 30 mm.
mesh::TetMesh hammer_mesh() {
    mesh::TetMesh whole = reference::kuhn_box(
        {0.17, 0.06, 0.03}, 17, 8, 2, [](Vec3 c) { return c.x < 0.03 || (c.y > 0.015 && c.y < 0.045) ? 0 : 1; });
    whole.region_names = {"bar", "air"};
    mesh::Extract bar = mesh::extract_regions(whole, {true, false});
    for (Vec3& p : bar.mesh.points) p = p - Vec3{0.17, 0.03, 0};
    bar.mesh.region_names = {"bar"};
    return std::move(bar.mesh);
}

std::string hammer_text(int density) {
    return fmt::format(R"(
    name = "hammer"
    length_unit = "mm"
    material.silicone = {{ youngs_modulus = "250 kPa", poisson_ratio = 0.49, density = "{} kg/m^3" }}
    mesh = {{ file = "memory:", order = 2 }}
    body = [{{ name = "hammer", material = "silicone", region = "all" }}]
    fixed = [{{ name = "clamp", box = [[0, -15, 0], [0, 15, 30]] }}]
    marker = [{{ name = "D", point = [-140, 30, 30] }}, {{ name = "E", point = [-170, 30, 30] }},
              {{ name = "F", point = [-170, -30, 30] }}, {{ name = "G", point = [-140, -30, 30] }}]
    program = {{ gravity = [0, -9.81, 0], steps = 4 }}
)",
                       density);
}

struct Silicone {
    const char* file;
    int density;
    double rotation_deg;  ///< of the head beside the clamp
    double least_E_Pa, most_E_Pa;
};

}  // namespace

TEST_CASE("hanging hammers: moduli from the head's rotation predict the corners within 10 mm") {
    constexpr std::array<Silicone, 2> silicones = {
        {{"moldstar_15_points.csv", 1180, 27.5, 320e3, 390e3}, {"ecoflex_00-50_points.csv", 1070, 54.1, 115e3, 135e3}}};
    for (const Silicone& silicone : silicones) {
        CAPTURE(std::string(silicone.file));
        const Bar hammer(hammer_text(silicone.density), hammer_mesh());
        // The free end's edge from E to F leaves the vertical, -y, as the head rotates.
        std::string table = fmt::format(
            "step,use,E-F_angle_y_deg,D_x_mm,D_y_mm,E_x_mm,E_y_mm,"
            "F_x_mm,F_y_mm,G_x_mm,G_y_mm\n4,fit,{},,,,,,,,\n4,judge,",
            180 - silicone.rotation_deg);
        const auto points =
            reference::load_csv(reference::data_folder() + "/experiments/hammer_two_silicones/" + silicone.file);
        for (const auto& row : points) {
            if (std::string("DEFG").find(row.at("point")) != std::string::npos)
                table += "," + row.at("x_mm_scaled") + "," + row.at("y_mm_scaled");
        }
        const Measurements data = hammer.read(table + "\n");
        const Identification result = find(hammer, hammer.unknowns({"material.silicone.youngs_modulus"}), data);
        const double E = result.found[0].value;
        MESSAGE(std::string(silicone.file), ": E ", E, " Pa; rotation, before ", result.fitted[0].before, " after ",
                result.fitted[0].after, " deg; corners, rms before ", result.judged[0].before, " after ",
                result.judged[0].after, " mm");
        CHECK(E > silicone.least_E_Pa);
        CHECK(E < silicone.most_E_Pa);
        CHECK(result.fitted[0].after < 1e-4);
        CHECK(result.judged[0].values == 8);
        CHECK(result.judged[0].after < 10);
    }
}

// Materials: elastic laws as robot files give them, and the library.
#include <doctest/doctest.h>

#include <cmath>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "robot/file/material_library.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/material/response.hpp"

using namespace pliant;
using namespace pliant::robot;

namespace {

/// A bar of one material; `table` is what stands in the file before the body, `name` the body's material.
std::string bar_of(const std::string& table, const std::string& name) {
    return "name = \"bar\"\nlength_unit = \"mm\"\n" + table + "\n[[body]]\nname = \"bar\"\nmaterial = \"" + name +
           "\"\ngeometry = { box = [[0, 0, 0], [20, 10, 10]] }\n[[fixed]]\nname = \"clamp\"\n" +
           "box = [[0, 0, 0], [0, 10, 10]]\n";
}

MaterialSpec material_of(const std::string& table, const std::string& name = "soft") {
    const Result<Robot> robot = parse_robot(bar_of(table, name), "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    return robot->materials.at(static_cast<std::size_t>(robot->bodies.at(0).material));
}

void check_material_problem(const std::string& table, const std::string& wanted, const std::string& name = "soft") {
    const Result<Robot> robot = parse_robot(bar_of(table, name), "bar.toml");
    REQUIRE_FALSE(robot);
    const std::string& found = robot.error().message;
    CHECK_MESSAGE(found.find(wanted) != std::string::npos, "found \"", found, "\", wanted \"", wanted, "\"");
}

}  // namespace

TEST_CASE("mooney-rivlin is read, with the Poisson ratio at small strain") {
    const auto m = material_of(
        "[material.soft]\nlaw = \"mooney-rivlin\"\nc10 = \"0.3 MPa\"\nc01 = \"100 kPa\"\n"
        "poisson_ratio = 0.49");
    const auto law = std::get<material::MooneyRivlin>(m.law);
    CHECK(law.c10_Pa == near(3e5, {.relative = 1e-12}));
    CHECK(law.c01_Pa == near(1e5, {.relative = 1e-12}));
    CHECK(m.poisson_ratio == near(0.49, {.relative = 1e-12}));
    CHECK(m.youngs_modulus_Pa == near(8e5 * 2 * 1.49, {.relative = 1e-12}));  // E = 2 mu (1 + nu), mu = 2 (c10 + c01)
}

TEST_CASE("yeoh is read with a bulk modulus; c20 and c30 may be missing") {
    const auto m = material_of(
        "[material.soft]\nlaw = \"yeoh\"\nc10 = \"0.11 MPa\"\nc20 = \"0.02 MPa\"\n"
        "bulk_modulus = \"10 MPa\"");
    const auto law = std::get<material::Yeoh>(m.law);
    CHECK(law.c20_Pa == near(2e4, {.relative = 1e-12}));
    CHECK(law.c30_Pa == 0);
    CHECK(law.bulk_Pa == near(1e7, {.relative = 1e-12}));
}

TEST_CASE("ogden, corotated and linear are read") {
    const auto m = material_of("[material.soft]\nlaw = \"ogden\"\nmu = [\"0.6 MPa\", \"-10 kPa\"]\nalpha = [1.3, -2]");
    const auto law = std::get<material::Ogden>(m.law);
    CHECK(law.terms == 2);
    CHECK(law.mu_Pa[1] == near(-1e4, {.relative = 1e-12}));
    CHECK(law.alpha[0] == near(1.3, {.relative = 1e-12}));
    CHECK(law.bulk_Pa == near(material::bulk_modulus(5.9e5, 0.45), {.relative = 1e-12}));
    const auto c = material_of("[material.soft]\nlaw = \"corotated\"\nyoungs_modulus = \"1 MPa\"");
    CHECK(std::holds_alternative<material::Corotated>(c.law));
    const auto l = material_of("[material.soft]\nlaw = \"linear\"\nyoungs_modulus = \"1 MPa\"");
    CHECK(std::holds_alternative<material::Linear>(l.law));
}

TEST_CASE("shape-blend takes a shape parameter from rigid to extremely soft, and refuses others") {
    const std::string soft = "[material.soft]\nlaw = \"shape-blend\"\nyoungs_modulus = \"12 MPa\"\n";
    const auto a_of = [&](const std::string& more) {
        return std::get<material::ShapeBlend>(material_of(soft + more).law).a;
    };
    CHECK(a_of("shape_parameter = 1") == 1);
    CHECK(a_of("shape_parameter = 7.08") == near(1 / 7.08, {.relative = 1e-12}));
    CHECK(a_of("poisson_ratio = 0.49925") > 1e-3);
    CHECK(a_of("shape_parameter = 1000") == near(1e-3, {.relative = 1e-12}));
    for (const char* value : {"1e9", "1e300", "1001", "0", "-7", "1e-12", "0.999"})
        check_material_problem(soft + "shape_parameter = " + value,
                               "is not possible; R_omega is from 1 (rigid) to 1000");
    for (const char* value : {"nan", "inf", "-inf", "true"}) {
        const Result<Robot> robot = parse_robot(bar_of(soft + "shape_parameter = " + value, "soft"), "bar.toml");
        REQUIRE_FALSE(robot);
        CHECK(robot.error().message.find("material.soft.shape_parameter: is ") != std::string::npos);
        CHECK(robot.error().message.find('\n') == std::string::npos);  // one line is enough
    }
    CHECK(a_of("poisson_ratio = 0.499") == near(0.002 / 1.499, {.relative = 1e-12}));
    check_material_problem(soft + "poisson_ratio = 0.4999999", "at most 0.49925");
    check_material_problem(soft + "shape_parameter = \"thesis\"\nstiffest = \"12 GPa\"",
                           "is 1000 times youngs_modulus");
    check_material_problem(soft + "shape_parameter = \"small-strain\"\nstiffest = \"12 GPa\"", "takes R_omega 1500");
}

TEST_CASE("shape-blend computes R_omega from two moduli, by the name of a map") {
    const std::string soft = "[material.soft]\nlaw = \"shape-blend\"\nyoungs_modulus = \"12 MPa\"\n";
    const auto by = [&](const std::string& name) {
        return std::get<material::ShapeBlend>(
            material_of(soft + "stiffest = \"45 MPa\"\nshape_parameter = \"" + name + "\"").law);
    };
    CHECK(1 / by("thesis").a == near(0.114 * 3.75 * 3.75 + 1.665 * 3.75 - 0.766, {.relative = 1e-12}));
    CHECK(1 / by("small-strain").a == near(5.125, {.relative = 1e-12}));
    CHECK(1 / by("calibrated\"\nshape_curve = [0.1, 2, -1]#").a ==
          near(0.1 * 3.75 * 3.75 + 2 * 3.75 - 1, {.relative = 1e-5}));
    CHECK(by("thesis").weight_Pa == near(45e6, {.relative = 1e-12}));
    // Of small strains its own modulus comes out again: the weight is the stiffest one's.
    const material::Law law = by("small-strain");
    CHECK(material::youngs_modulus(material::moduli(law)) == near(12e6, {.relative = 1e-12}));
    const auto stiff = material_of(
        "[material.soft]\nlaw = \"shape-blend\"\nyoungs_modulus = \"45 MPa\"\nstiffest = \"45 MPa\"\n"
        "shape_parameter = \"thesis\"");
    CHECK(std::get<material::ShapeBlend>(stiff.law).a == 1);
    CHECK(std::get<material::ShapeBlend>(stiff.law).weight_Pa == near(45e6, {.relative = 1e-12}));
    CHECK(stiff.poisson_ratio == near(0, {.absolute = 1e-12}));  // a rigid target keeps no volume
    check_material_problem(soft + "shape_parameter = \"thesis\"", "stiffest: is missing");
    check_material_problem(soft + "shape_parameter = \"thesis\"\nstiffest = \"10 MPa\"", "is below youngs_modulus");
    check_material_problem(soft + "shape_parameter = \"T3.9\"\nstiffest = \"45 MPa\"", "small-strain");
    check_material_problem(soft + "shape_parameter = 7\nstiffest = \"45 MPa\"", "goes with a shape_parameter by name");
    check_material_problem(soft + "shape_parameter = \"calibrated\"\nstiffest = \"45 MPa\"", "shape_curve");
    check_material_problem(soft + "shape_parameter = \"calibrated\"\nstiffest = \"45 MPa\"\nshape_curve = [0, 0, 0.5]",
                           "gives R_omega 0.5");
    check_material_problem(soft + "shape_parameter = \"thesis\"\nstiffest = \"45 MPa\"\nshape_curve = [0, 0, 1]",
                           "goes with shape_parameter = \"calibrated\"");
    check_material_problem("[material.soft]\nyoungs_modulus = \"1 MPa\"\nstiffest = \"45 MPa\"",
                           "is a constant of shape-blend");
}

TEST_CASE("constants that do not fit their law are refused") {
    check_material_problem("[material.soft]\nlaw = \"mooney-rivlin\"\nyoungs_modulus = \"1 MPa\"",
                           "does not determine the constants of \"mooney-rivlin\"");
    check_material_problem("[material.soft]\nlaw = \"mooney-rivlin\"\nc10 = \"0.1 MPa\"\nc01 = \"-0.2 MPa\"",
                           "the initial shear modulus, 2 (c10 + c01), is -0.2 MPa");
    check_material_problem("[material.soft]\nlaw = \"yeoh\"\nc10 = \"-1 kPa\"", "a stable solid needs one above zero");
    check_material_problem("[material.soft]\nlaw = \"ogden\"\nmu = [\"1 MPa\"]\nalpha = [1, 2]",
                           "has 1 values and alpha 2");
    check_material_problem("[material.soft]\nlaw = \"ogden\"\nmu = [\"1 MPa\"]\nalpha = [0]", "0 is not possible");
    check_material_problem("[material.soft]\nlaw = \"ogden\"\nmu = [\"1\"]\nalpha = [2]", "has no unit");
    check_material_problem(
        "[material.soft]\nlaw = \"yeoh\"\nc10 = \"1 MPa\"\nbulk_modulus = \"1 MPa\"\npoisson_ratio = 0.4",
        "stands beside bulk_modulus");
    check_material_problem("[material.soft]\nlaw = \"yeoh\"\nc10 = \"1 MPa\"\nbulk_modulus = \"-1 MPa\"", "above zero");
    check_material_problem("[material.soft]\nyoungs_modulus = \"1 MPa\"\nc10 = \"1 MPa\"",
                           "is a constant of mooney-rivlin and yeoh");
}

TEST_CASE("a body may name a material of the library") {
    const auto m = material_of("", "elastosil-m4601");
    CHECK(std::get<material::Yeoh>(m.law).c10_Pa == near(0.11e6, {.relative = 1e-12}));
    CHECK(m.resin == "elastosil-m4601");
    check_material_problem("", "no material \"elastosil\" in the library", "elastosil");
    check_material_problem("", "material: is empty; name a material of this file or of the library", "");
    check_material_problem("", "elastosil-m4601", "elastosil");
    check_material_problem("[material.soft]\nyoungs_modulus = \"1 MPa\"", "and the library", "unobtainium");
}

TEST_CASE("a material may start from one of the library") {
    const auto m =
        material_of("[material.soft]\nbase = \"elastosil-m4601\"\nc10 = \"0.2 MPa\"\ndensity = \"2 g/cm^3\"");
    const auto law = std::get<material::Yeoh>(m.law);
    CHECK(law.c10_Pa == near(0.2e6, {.relative = 1e-12}));
    CHECK(law.c20_Pa == near(0.02e6, {.relative = 1e-12}));
    CHECK(m.density_kg_m3 == near(2000, {.relative = 1e-12}));
    CHECK(m.name == "soft");

    const auto bulk = material_of("[material.soft]\nbase = \"elastosil-m4601\"\nbulk_modulus = \"5 MPa\"");
    CHECK(std::get<material::Yeoh>(bulk.law).bulk_Pa == near(5e6, {.relative = 1e-12}));

    const auto other =
        material_of("[material.soft]\nbase = \"elastosil-m4601\"\nlaw = \"neo-hookean\"\nyoungs_modulus = \"1 MPa\"");
    CHECK(std::holds_alternative<material::NeoHookean>(other.law));
    CHECK(other.poisson_ratio == 0.45);  // the library's constants went with its law
    CHECK(other.density_kg_m3 == near(1130, {.relative = 1e-12}));

    check_material_problem("[material.soft]\nbase = \"elastosil\"", "the library has no material \"elastosil\"");
    check_material_problem("[material.soft]\nbase = \"ninjaflex\"\nyoungs_modulu = \"1 MPa\"",
                           "did you mean \"youngs_modulus\"?");
    check_material_problem("[material.soft]\nbase = \"ninjaflex\"\ntitle = \"mine\"", "unknown key");
}

TEST_CASE("every library material is valid, stable in its range, and in the reference") {
    const Result<std::string> page = read_file("docs/reference/materials.md");
    REQUIRE(page);
    CHECK(library_files().size() >= 14);
    for (const EmbeddedFile& file : library_files()) {
        CAPTURE(file.name);
        const Result<LibraryMaterial> m = library_material(file.name);
        REQUIRE_MESSAGE(m, (m ? "" : m.error().message));
        CHECK(m->spec.youngs_modulus_Pa > 1e4);
        CHECK(m->spec.youngs_modulus_Pa < 1e9);
        CHECK(m->spec.density_kg_m3 > 900);
        CHECK(m->spec.density_kg_m3 < 1400);
        CHECK(m->source.size() > 20);
        CHECK(m->derivation.size() > 20);
        CHECK(m->stretch[0] <= 1);
        CHECK(m->stretch[1] > 1);
        CHECK(page->find("`" + std::string(file.name) + "`") != std::string::npos);
        CHECK(page->find(m->source) != std::string::npos);
        CHECK(page->find(m->derivation) != std::string::npos);
        // The nominal stress of a body that keeps its volume grows all the way to the end of the range.
        double before = -1e300;
        for (double l = m->stretch[0]; l <= m->stretch[1]; l += 0.01) {
            const material::Matrix3 F = Eigen::Vector3d(l, 1 / std::sqrt(l), 1 / std::sqrt(l)).asDiagonal();
            const material::Matrix3 P = material::stress(m->spec.law, F);
            const double nominal = P(0, 0) - P(1, 1) * std::pow(l, -1.5);
            CHECK(nominal > before);
            before = nominal;
        }
    }
}

TEST_CASE("the list of materials has one line each, and JSON has constants in Pa") {
    const std::string text = library_text();
    CHECK(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) == library_files().size() + 1);
    const auto elastosil = library_material("elastosil-m4601");
    REQUIRE(elastosil);
    const std::string json = library_json({*elastosil});
    CHECK(json.find("\"c10_Pa\": 110000.0") != std::string::npos);
    CHECK(json.find("\"source\": ") != std::string::npos);
}

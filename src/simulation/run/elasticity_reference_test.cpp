// Bars and beams against CalculiX on the same meshes and laws (fem/README.md of the reference data).
#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "simulation/actuators/loads.hpp"
#include "simulation/peers/comparison_problems.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::mm;
using testing::model_of;

namespace {

constexpr double MPa = 1e6;

material::Law law_of(const std::string& name, double E, double nu) {
    if (name == "SVK") return material::st_venant_kirchhoff(E, nu);
    return material::neo_hookean(E, nu);
}

std::array<int, 3> cells_of(const std::string& text) {
    std::array<int, 3> cells{};
    REQUIRE(std::sscanf(text.c_str(), "%dx%dx%d", &cells[0], &cells[1], &cells[2]) == 3);
    return cells;
}

Trajectory run_to_end(const Model& model, int steps, double tolerance) {
    Progress silent;
    Program program;
    program.steps = steps;
    program.tolerance = tolerance;
    Trajectory result = run(model, program, silent);
    REQUIRE_MESSAGE(result.converged, result.message);
    return result;
}

Description two_material_bar(const reference::Row& row) {
    const auto cells = cells_of(row.at("cells"));
    const double interface = std::stod(row.at("L1")) * mm;
    Description d;
    d.mesh = reference::kuhn_box({100 * mm, 10 * mm, 10 * mm}, cells[0], cells[1], cells[2],
                                 [&](Vec3 c) { return c.x < interface ? 0 : 1; });
    if (row.at("elem") == "C3D10") d.mesh = mesh::to_quadratic(d.mesh);
    const double nu = std::stod(row.at("nu"));
    d.materials = {{"A", law_of(row.at("law"), 12 * MPa * std::stod(row.at("Rm")), nu), 0},
                   {"B", law_of(row.at("law"), 12 * MPa, nu), 0}};
    d.material_of_region = {0, 1};
    const double strain = std::stod(row.at("strain"));
    d.supports = {
        {"left", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}},
        {"right", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 0.1 - 1e-9; }), {0.1 * strain, 0, 0}}};
    d.markers = {{"interface", reference::mean_of(reference::nodes_where(
                                   d.mesh, [&](Vec3 p) { return std::fabs(p.x - interface) < 1e-9; }))}};
    return d;
}

void check_bar_rows(const std::string& element, double tolerance, std::size_t every) {
    const auto rows = reference::load_csv(reference::data_folder() + "/fem/ccx_bar.csv");
    std::size_t seen = 0;
    for (const auto& row : rows) {
        if (row.at("elem") != element || row.at("converged") != "True" || seen++ % every != 0) continue;
        CAPTURE(row.at("law"));
        CAPTURE(row.at("nu"));
        CAPTURE(row.at("Rm"));
        CAPTURE(row.at("L1"));
        const Model model = model_of(two_material_bar(row));
        const auto last = run_to_end(model, 5, 1e-8).steps.back();
        const double u = last.markers[0].position_m.x / mm - std::stod(row.at("L1"));
        CHECK(u == near(std::stod(row.at("u_interface_mm")), {.relative = tolerance}));
        CHECK(last.supports[1].force_N.x == near(std::stod(row.at("Fx_N")), {.relative = tolerance}));
        CHECK(last.supports[0].force_N.x == near(-last.supports[1].force_N.x, {.relative = 1e-6}));
    }
    CHECK(seen > 0);
}

/// The thesis' target shape with (E, nu) mapped to weight and blend, against an independent solver of the same model.
void check_shape_blend(double nu, double material_ratio) {
    for (const auto& row : reference::load_csv(reference::data_folder() + "/fem/calibration_R_omega_vs_ccx.csv")) {
        if (row.at("law") != "NH" || std::stod(row.at("nu")) != nu || std::stod(row.at("Rm")) != material_ratio)
            continue;
        CAPTURE(nu);
        CAPTURE(row.at("L1"));
        reference::Row bar = {{"cells", "48x5x5"},  {"elem", "C3D4"},     {"law", "NH"},    {"nu", row.at("nu")},
                              {"Rm", row.at("Rm")}, {"L1", row.at("L1")}, {"strain", "0.3"}};
        Description d = two_material_bar(bar);
        d.materials[0].law = material::shape_blend(12 * MPa * material_ratio, nu);
        d.materials[1].law = material::shape_blend(12 * MPa, nu);
        const Model model = model_of(std::move(d));
        const Step last = run_to_end(model, 5, 1e-6).steps.back();
        const double u = last.markers[0].position_m.x / mm - std::stod(row.at("L1"));
        CHECK(u == near(std::stod(row.at("u_map_T")), {.relative = 1e-4}));
        CHECK(last.supports[1].force_N.x == near(std::stod(row.at("F_map_T")), {.relative = 1e-4}));
    }
}

void check_beam(const std::string& element, double nu, double tolerance) {
    const auto rows = reference::load_csv(reference::data_folder() + "/fem/ccx_beam_100x5x5.csv");
    bool found = false;
    for (const auto& row : rows) {
        if (row.at("elem") != element || row.at("cells") != "40x2x2" || std::stod(row.at("nu")) != nu) continue;
        found = true;
        CAPTURE(nu);
        Description d;
        d.mesh = reference::kuhn_box({100 * mm, 5 * mm, 5 * mm}, 40, 2, 2, [](Vec3) { return 0; });
        const auto corners = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 0.1 - 1e-9; });
        if (element == "C3D10") d.mesh = mesh::to_quadratic(d.mesh);
        d.materials = {{"A", material::neo_hookean(12 * MPa, nu), 0}};
        d.material_of_region = {0};
        d.supports = {{"left", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
        std::vector<mesh::Face> faces;
        for (const mesh::Face& face : mesh::boundary_faces(d.mesh)) {
            const auto& p = d.mesh.points;
            if (p[face.nodes[0]].x + p[face.nodes[1]].x + p[face.nodes[2]].x > 0.3 - 1e-9) faces.push_back(face);
        }
        const SurfaceShares shares = surface_shares(d.mesh, faces);
        CHECK(shares.area_m2 == near(25e-6, {.relative = 1e-12}));
        d.loads = {{"tip", shares.nodes, shares.shares, {0, 0, 0.06}}};
        d.markers = {{"tip", reference::mean_of(corners)}};
        const Model model = model_of(std::move(d));
        const auto last = run_to_end(model, 5, 1e-7).steps.back();
        const Vec3 tip = (last.markers[0].position_m - Vec3{100 * mm, 2.5 * mm, 2.5 * mm}) / mm;
        CHECK(tip.z == near(std::stod(row.at("tip_uz_mm")), {.relative = tolerance}));
        CHECK(tip.x == near(std::stod(row.at("tip_ux_mm")), {.relative = tolerance}));
    }
    CHECK(found);
}

/// The finest quadratic mesh that the table has for this Poisson ratio.
double finest_tip_mm(double nu) {
    double most = 0;
    double tip = 0;
    for (const auto& row : reference::load_csv(reference::data_folder() + "/fem/ccx_beam_100x5x5.csv")) {
        if (row.at("elem") != "C3D10" || std::stod(row.at("nu")) != nu || std::stod(row.at("n_nodes")) <= most)
            continue;
        most = std::stod(row.at("n_nodes"));
        tip = std::stod(row.at("tip_uz_mm"));
    }
    REQUIRE(most > 10000);
    return tip;
}

}  // namespace

TEST_CASE("two-material bar, linear tets: displacement and force agree with CalculiX to five digits") {
    check_bar_rows("C3D4", 1e-5, 1);
}

TEST_CASE("two-material bar, quadratic tets: agrees with CalculiX within 0.02 %") {
    check_bar_rows("C3D10", 2e-4, 7);
}

TEST_CASE("slender beam, quadratic tets: agrees with CalculiX within 0.1 % for every Poisson ratio") {
    for (const double nu : {0.3, 0.45, 0.49, 0.499}) check_beam("C3D10", nu, 1e-3);
}

TEST_CASE("slender beam, 2,025 nodes in quadratic tets: within 1 % of CalculiX on a mesh twice as fine") {
    for (const double nu : {0.3, 0.45, 0.49}) {
        const Description d = comparison::beam(2, material::neo_hookean(12 * MPa, nu), 40);
        REQUIRE(d.mesh.points.size() == 2025);
        const Model model = model_of(d);
        const double tip = comparison::tip_displacement(d, run_to_end(model, 5, 1e-7).steps.back()).z / mm;
        const double fine = finest_tip_mm(nu);
        MESSAGE("nu " << nu << ": tip " << tip << " mm, fine mesh " << fine << " mm, off by " << tip / fine - 1);
        CHECK(tip == near(fine, {.relative = 0.01}));
    }
}

TEST_CASE("slender beam, linear tets: agrees with CalculiX within 0.1 %") {
    for (const double nu : {0.3, 0.45, 0.49, 0.499}) check_beam("C3D4", nu, 1e-3);
}

TEST_CASE("two-material bar with the thesis' target shapes: agrees with an independent solver") {
    check_shape_blend(0.3, 3.75);
    check_shape_blend(0.45, 3.75);
    check_shape_blend(0.45, 8);
}

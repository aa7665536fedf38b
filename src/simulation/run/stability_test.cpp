#include "simulation/run/stability.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

constexpr double column_modulus = 1e6, column_length = 0.1, column_width = 0.008, column_depth = 0.005;

/// A box and its mirror image in its face z = 0, as one mesh: an unsymmetric mesh would bend by itself.
mesh::TetMesh mirrored(const mesh::TetMesh& half) {
    mesh::TetMesh mesh = half;
    std::vector<int> image;
    for (std::size_t n = 0; n < half.points.size(); ++n) {
        const Vec3 p = half.points[n];
        image.push_back(p.z == 0 ? static_cast<int>(n) : static_cast<int>(mesh.points.size()));
        if (p.z != 0) mesh.points.push_back({p.x, p.y, -p.z});
    }
    for (std::size_t t = 0; t < half.tet_count(); ++t) {
        const auto n = half.tet(t);
        for (const int corner : {n[0], n[2], n[1], n[3]}) mesh.nodes.push_back(image[static_cast<std::size_t>(corner)]);
        mesh.region.push_back(0);
    }
    return mesh;
}

/// A straight cantilever along x, thin in z, that a dead load presses along its axis. Program time 1 is `load_N`.
Description column(double load_N) {
    Description d;
    d.mesh = mesh::to_quadratic(mirrored(
        reference::kuhn_box({column_length, column_width, column_depth / 2}, 24, 1, 1, [](Vec3) { return 0; })));
    d.mesh.region_names = {"column"};
    d.materials = {{"A", material::neo_hookean(column_modulus, 0.3), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    const std::vector<int> tip = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > column_length - 1e-9; });
    Load load{"press", tip, std::vector<double>(tip.size(), 1.0 / static_cast<double>(tip.size())), {-load_N, 0, 0}};
    d.loads = {load};
    d.markers = {{"tip", reference::mean_of(tip)}};
    return d;
}

/// Euler's, of a column that is clamped at one end and free at the other.
double critical_load() {
    const double I = column_width * column_depth * column_depth * column_depth / 12;
    return std::numbers::pi * std::numbers::pi * column_modulus * I / (4 * column_length * column_length);
}

std::string said(const Trajectory& result) {
    std::string all = result.message;
    for (const std::string& warning : result.warnings) all += "\n" + warning;
    return all;
}

bool warns(const Trajectory& result, std::string_view text) {
    return std::any_of(result.warnings.begin(), result.warnings.end(),
                       [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
}

/// The share of the critical load at which a straight column is first reported unstable; 0: never.
double first_unstable(const Trajectory& result, double largest_share) {
    for (const std::string& warning : result.warnings) {
        int step = 0;
        if (std::sscanf(warning.c_str(), "from step %d on the equilibrium is unstable", &step) == 1)
            return largest_share * step / (static_cast<double>(result.steps.size()) - 1);
    }
    return 0;
}

}  // namespace

TEST_CASE("a straight column is reported as unstable from Euler's load on") {
    // The load shortens it a little, which the formula leaves out: P/EA = 0.5 % at the critical load, and the clamp
    // hinders the sides; steps are 2.5 % of the load.
    Program program;
    program.steps = 52;
    program.tolerance = 1e-6;
    const Trajectory result = testing::solve(column(1.3 * critical_load()), program);
    REQUIRE_MESSAGE(result.converged, said(result));
    const double share = first_unstable(result, 1.3);
    CHECK_MESSAGE(share > 0.97, said(result));
    CHECK_MESSAGE(share < 1.06, said(result));
}

TEST_CASE("below Euler's load a column is not reported as unstable") {
    Program program;
    program.steps = 8;
    const Trajectory result = testing::solve(column(0.95 * critical_load()), program);
    REQUIRE_MESSAGE(result.converged, said(result));
    CHECK_MESSAGE(result.warnings.empty(), said(result));
}

TEST_CASE("with an imperfection the column buckles sideways as far as the elastica") {
    // An inextensible cantilever whose end has turned by 40 degrees carries 1.063 times Euler's load with its tip
    // 0.422 of its length off the axis, and by 60 degrees 1.152 times with 0.593 (Timoshenko and Gere 1961, table 2-4).
    Program program;
    program.steps = 24;
    program.tolerance = 1e-6;
    program.imperfection_m = 1e-4;
    const Trajectory result = testing::solve(column(1.152 * critical_load()), program);
    REQUIRE_MESSAGE(result.converged, said(result));
    CHECK_MESSAGE(warns(result, "led to a stable one"), said(result));
    const Vec3 tip = result.steps.back().markers[0].position_m;
    const double aside = std::fabs(tip.z) / column_length;
    CHECK_MESSAGE(aside == near(0.593, {.relative = 0.05}), aside);
}

TEST_CASE("an unstable equilibrium that no push leaves is reported") {
    Program program;
    program.steps = 13;
    program.imperfection_m = 1e-15;
    const Trajectory result = testing::solve(column(1.3 * critical_load()), program);
    REQUIRE_MESSAGE(result.converged, said(result));
    CHECK_MESSAGE(warns(result, "led to no stable one"), said(result));
    CHECK_MESSAGE(first_unstable(result, 1.3) > 0.9, said(result));
}

TEST_CASE("a column shortened by a guided cable along its axis is not reported as unstable") {
    // Pulled to a fixed length by a cable along its axis it is under a load that is not given but follows; sideways the
    // cable keeps the line to its end, so that it does not buckle as under a dead load: a guide in the middle of every
    // tenth of it makes it stable at any length.
    Description d = column(0);
    d.loads.clear();
    const Attacher attacher(d.mesh);
    Cable cable{"cable", {}, {CableTarget::Kind::length_ratio, 0.97}};
    for (int k = 0; k <= 10; ++k)
        cable.points.push_back(*attacher.carried_by_tet({k * column_length / 10, column_width / 2, 0}, 1e-6));
    d.cables = {cable};
    Program program;
    program.steps = 6;
    const Trajectory result = testing::solve(d, program);
    REQUIRE_MESSAGE(result.converged, said(result));
    CHECK_MESSAGE(result.warnings.empty(), said(result));
}

TEST_CASE("an arch that snaps through under a load is reported; one driven by a displacement is not") {
    // Two bars that lean against each other, as a shallow roof (von Mises' truss), with soft hinges: under a load it
    // snaps, moved by the top it goes through smoothly.
    Description d;
    d.mesh = mesh::to_quadratic(reference::kuhn_box({0.1, 0.004, 0.002}, 24, 1, 1, [](Vec3) { return 0; }));
    d.mesh.region_names = {"arch"};
    const auto raised = [](Vec3 p) { return Vec3{p.x, p.y, p.z + 0.008 * std::sin(std::numbers::pi * p.x / 0.1)}; };
    const auto ends = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9 || p.x > 0.1 - 1e-9; });
    const auto top = reference::nodes_where(d.mesh, [](Vec3 p) { return std::fabs(p.x - 0.05) < 1e-9; });
    for (Vec3& p : d.mesh.points) p = raised(p);
    d.materials = {{"A", material::neo_hookean(column_modulus, 0.3), 1000}};
    d.material_of_region = {0};
    d.supports = {{"ends", ends, {}}};
    d.markers = {{"top", reference::mean_of(top)}};
    Program program;
    program.steps = 30;
    Description pushed = d;
    Load load{"push", top, std::vector<double>(top.size(), 1.0 / static_cast<double>(top.size())), {0, 0, -0.012}};
    pushed.loads = {load};
    const Trajectory snap = testing::solve(pushed, program);
    REQUIRE_MESSAGE(snap.converged, said(snap));
    CHECK(snap.steps.back().markers[0].position_m.z < 0);  // it is through
    CHECK_MESSAGE(warns(snap, "the robot jumps"), said(snap));
    pushed.loads[0].share = ramp(1, 1);  // all of it from the first instant on
    const Trajectory snap_at_once = testing::solve(pushed, {.steps = 2});
    REQUIRE_MESSAGE(snap_at_once.converged, said(snap_at_once));
    CHECK_MESSAGE(warns(snap_at_once, "at step 1 the robot jumps"), said(snap_at_once));
    Description moved = d;
    moved.supports.push_back({"hand", top, {0, 0, -0.016}});
    const Trajectory smooth = testing::solve(moved, program);
    REQUIRE_MESSAGE(smooth.converged, said(smooth));
    CHECK_MESSAGE(!warns(smooth, "jumps"), said(smooth));
}

TEST_CASE("a pull that acts from the first instant on is no jump: a load, a stretched spring, the offset of a cable") {
    Description d;
    d.mesh = reference::kuhn_box({30e-3, 10e-3, 10e-3}, 6, 2, 2, [](Vec3) { return 0; });
    d.mesh.region_names = {"bar"};
    d.materials = {{"A", material::neo_hookean(1e6, 0.3), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    const std::vector<int> tip = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 30e-3 - 1e-9; });
    const double each = 1.0 / static_cast<double>(tip.size());
    const auto check = [&](const Description& pulled, double way_m) {
        const Trajectory result = testing::solve(pulled, {.steps = 4});
        REQUIRE_MESSAGE(result.converged, said(result));
        const double moved = result.steps[1].positions[static_cast<std::size_t>(tip[0])].x - 30e-3;
        CHECK(moved / way_m > 0.7);  // far enough to be examined
        CHECK_MESSAGE(result.warnings.empty(), said(result));
    };
    Description loaded = d;
    loaded.loads = {{"pull", tip, std::vector<double>(tip.size(), each), {10, 0, 0}, ramp(1, 1)}};
    check(loaded, 3e-3);
    Description sprung = d;
    Spring spring;
    spring.name = "spring";
    spring.points = {reference::mean_of(tip), {{}, {}, {40e-3, 5e-3, 5e-3}}};
    spring.stiffness_N_m = 1000;
    spring.free_length_m = 0;
    sprung.springs = {spring};
    check(sprung, 2.5e-3);
    Description shortened = d;
    Cable cable;
    cable.name = "cable";
    cable.points = {{{}, {}, {0, 5e-3, 8e-3}}, reference::mean_of(tip)};
    cable.target = {CableTarget::Kind::shortening_m, 1e-3};
    cable.target.offset = -5e-3;
    shortened.cables = {cable};
    check(shortened, -4e-3);
}

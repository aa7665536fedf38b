#include "printing/slice/supports.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "printing/slice/grid_surface.hpp"
#include "printing/slice/inspect.hpp"
#include "printing/slice/repair.hpp"
#include "printing/slice/support_shapes.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

const Settings support_slicing{{200, 160, 100}, 50, {}};  // 20 x 16 mm

double volume_of(const mesh::TriMesh& mesh) {
    const auto repaired = repair(mesh, "shape", 50);
    REQUIRE(repaired.has_value());
    CHECK(repaired->warnings.empty());
    return volume_mm3(repaired->surface);
}

struct SupportOutcome {
    Supports supports;
    std::size_t islands = 0;
    double part_mm3 = 0, support_mm3 = 0;
    std::vector<std::string> warnings;
};

SupportOutcome supported(const std::vector<Body>& part, const SupportSettings& wanted) {
    Progress progress;
    auto made = make_supports(part, support_slicing, wanted, progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    std::vector<Body> all = made->bodies;
    all.insert(all.end(), part.begin(), part.end());
    const auto slicer = Slicer::prepare(all, support_slicing);
    REQUIRE(slicer.has_value());
    SupportOutcome outcome{std::move(*made), 0, 0, 0, {}};
    Inspector inspector(slicer->layers());
    Tally tally(*slicer);
    for (int k = 0; k < slicer->layer_count(); ++k) {
        const SlicedLayer layer = slicer->layer(k);
        tally.add(k, layer);
        for (const MaterialImage& m : layer.images)
            (slicer->materials()[static_cast<std::size_t>(m.material)] == wanted.material ? outcome.support_mm3
                                                                                          : outcome.part_mm3) +=
                static_cast<double>(m.value_sum) / 255 * 0.01 * 0.05;
        inspector.add(shape_of(layer, support_slicing.raster.width_px));
    }
    outcome.islands = inspector.finish().islands.size();
    outcome.warnings = tally.summary().warnings;
    return outcome;
}

SupportSettings in_wax() {
    SupportSettings wanted;
    wanted.material = "wax";
    return wanted;
}

}  // namespace

TEST_CASE("support shapes are closed and have the volumes of their formulas") {
    // A cylinder of radius 1 mm and a cone frustum on it.
    const double wanted = std::numbers::pi * (1 * 2 + 1.0 / 3 * (1 + 0.5 + 0.25));
    CHECK(volume_of(turned_solid(500, -200, {{0, 1000}, {2000, 1000}, {3000, 500}})) ==
          near(wanted, {.relative = 1e-3}));
    // The hull of four corners of a 4 x 2 mm rectangle and a point inside, with a margin of 1 mm: a regular polygon of
    // 16 sides at the corners, together.
    const double polygon = 8 * std::sin(std::numbers::pi / 8);
    CHECK(volume_of(hull_prism({{0, 0}, {4000, 0}, {2000, 1000}, {4000, 2000}, {0, 2000}}, 1000, 0, 500)) ==
          near(0.5 * (8 + 2 * (4 + 2) + polygon), {.relative = 1e-3}));
}

TEST_CASE("a plate in mid-air gets tips, no island is left, and the part keeps its volume") {
    const std::vector<Body> plate{{"soft", box({-6000, -4000, 5000}, {6000, 4000, 6000}), ""}};
    const SupportOutcome o = supported(plate, in_wax());
    CHECK(o.islands == 0);
    CHECK(o.supports.islands_left == 0);
    CHECK(o.supports.on_part == 0);
    // Tips at most 3 mm apart over 12 x 8 mm: more than area / (pi 3^2), fewer than area / (pi 1.5^2) plus a rim.
    CHECK(o.supports.tips > 4);
    CHECK(o.supports.tips < 30);
    CHECK(o.part_mm3 == near(12 * 8 * 1, {.relative = 1e-9}));
    // Pillars of 1 mm, 5 mm high, with a foot and a cone of 2 mm down to 0.4 mm.
    const double cone = std::numbers::pi / 3 * 2 * (0.25 + 0.1 + 0.04);
    const double foot = std::numbers::pi / 3 * 0.5 * (0.75 * 0.75 + 0.75 * 0.5 + 0.25);
    const double pillar = std::numbers::pi * 0.25 * 2.5;
    CHECK(o.support_mm3 == near(o.supports.tips * (cone + foot + pillar), {.relative = 0.03}));
    CHECK(o.supports.volume_mm3 == near(o.support_mm3, {.relative = 0.01}));
    CHECK(o.warnings.empty());
}

TEST_CASE("teeth may name the material of supports, which the part alone does not have") {
    const std::vector<Body> plate{{"soft", box({-6000, -4000, 5000}, {6000, 4000, 6000}), ""}};
    Settings settings = support_slicing;
    settings.teeth = {{"soft", "wax", 2, 1}};
    Progress progress;
    const auto made = make_supports(plate, settings, in_wax(), progress);
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    CHECK(made->tips > 4);
}

TEST_CASE("only flat undersides get tips, and a blocked pillar stands on the part") {
    // A column with a roof at 60 degrees needs none; a floor below a ledge carries supports.
    const std::vector<Body> steep{
        {"soft", prism({{-1000, -1000}, {1000, -1000}, {1000, 1000}, {-1000, 1000}}, 0, 4000), ""}};
    CHECK(supported(steep, in_wax()).supports.tips == 0);
    const std::vector<Body> ledge{{"soft", box({-7000, -3000, 0}, {7000, 3000, 1000}), ""},
                                  {"soft", box({-7000, -3000, 1000}, {-6000, 3000, 6000}), ""},
                                  {"soft", box({-7000, -3000, 6000}, {7000, 3000, 7000}), ""}};
    const SupportOutcome o = supported(ledge, in_wax());
    CHECK(o.islands == 0);
    CHECK(o.supports.tips > 5);
    CHECK(o.supports.on_part == o.supports.tips);
}

TEST_CASE("an underside gets tips if it is flatter than the angle by a few degrees, and none if it is steeper") {
    const auto tips = [](double underside_deg, double angle_deg) {
        const double height = 10000 * std::tan(underside_deg * std::numbers::pi / 180);
        // From a column of 2 mm outwards and upwards, 6 mm wide.
        const std::vector<std::array<double, 2>> profile{{-2000, 0}, {0, 0}, {10000, height}, {-2000, height}};
        mesh::TriMesh wedge;
        const auto at = [&](std::size_t i, double y) { return Vec3{profile[i % 4][0] - 4000, y, profile[i % 4][1]}; };
        for (std::size_t i = 0; i < 4; ++i) {
            add_triangle(wedge, at(i, -3000), at(i + 1, -3000), at(i + 1, 3000));
            add_triangle(wedge, at(i, -3000), at(i + 1, 3000), at(i, 3000));
        }
        for (const std::size_t i : {1, 2}) {
            add_triangle(wedge, at(0, -3000), at(i + 1, -3000), at(i, -3000));
            add_triangle(wedge, at(0, 3000), at(i, 3000), at(i + 1, 3000));
        }
        SupportSettings wanted = in_wax();
        wanted.angle_deg = angle_deg;
        return supported({{"soft", wedge, ""}}, wanted).supports.tips;
    };
    for (const double angle : {20.0, 30.0, 45.0, 60.0}) {
        CAPTURE(angle);
        CHECK(tips(angle - 5, angle) > 3);
        CHECK(tips(angle + 1, angle) == 0);
    }
}

TEST_CASE("a sphere in mid-air is supported on a raft, in a separate support material") {
    mesh::TriMesh ball;
    constexpr int rings = 24, around = 48;
    const auto at = [&](int i, int j) {
        const double polar = std::numbers::pi * i / rings, turn = 2 * std::numbers::pi * j / around;
        return Vec3{3000 * std::sin(polar) * std::cos(turn), 3000 * std::sin(polar) * std::sin(turn),
                    7000 + 3000 * std::cos(polar)};
    };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            if (i > 0) add_triangle(ball, at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + 1 < rings) add_triangle(ball, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    SupportSettings wanted = in_wax();
    wanted.raft_um = 800;
    wanted.spacing_um = 1500;
    const SupportOutcome o = supported({{"soft", ball, ""}}, wanted);
    CHECK(o.islands == 0);
    CHECK(o.supports.tips > 3);
    CHECK(o.part_mm3 == near(4.0 / 3 * std::numbers::pi * 27, {.relative = 0.02}));
    // The raft extends 2 mm beyond the outermost pillar on all sides.
    CHECK(o.support_mm3 > 0.8 * 16);
}

namespace {

SupportTouch touch(SupportWish wish, const Vec3& at_um, double radius_um, const Vec3& normal = {0, 0, -1}) {
    return {wish, at_um, normal, radius_um};
}

/// Whether there is any filler under this place.
bool stands_under(const Supports& supports, double x_um, double y_um) {
    return std::any_of(supports.bodies.begin(), supports.bodies.end(), [&](const Body& b) {
        const Box3 box = mesh::bounds(b.surface_um);
        return box.low.x <= x_um && x_um <= box.high.x && box.low.y <= y_um && y_um <= box.high.y;
    });
}

/// To the right of an upright wall a roof at 60 degrees: too steep to need a tip.
std::vector<Body> steep_roof() {
    const mesh::TriMesh wedge = prism({{-1000, -3000}, {1000, -3000}, {1000, 3000}, {-1000, 3000}}, 0, 8000);
    mesh::TriMesh leaning = wedge;
    for (Vec3& p : leaning.points) p.x += p.z / std::tan(60 * std::numbers::pi / 180);
    return {{"soft", leaning, ""}};
}

}  // namespace

TEST_CASE("painted supports: a steep underside gets tips where they are enforced, and nowhere else") {
    SupportSettings wanted = in_wax();
    CHECK(supported(steep_roof(), wanted).supports.tips == 0);
    // On its underside, 4 mm up: x = 1000 + 4000 / tan 60, normal down and to the right.
    const double lean = std::tan(60 * std::numbers::pi / 180);
    const Vec3 under{1000 + 4000 / lean, 0, 4000};
    const Vec3 down{std::sin(60 * std::numbers::pi / 180), 0, -0.5};
    wanted.paint = {touch(SupportWish::enforce, under, 1200, down)};
    const SupportOutcome held = supported(steep_roof(), wanted);
    REQUIRE(held.supports.tips > 0);
    CHECK(held.supports.painted == held.supports.tips);
    for (const Body& b : held.supports.bodies) {
        const Vec3 middle = mesh::bounds(b.surface_um).center();
        CHECK(std::hypot(middle.x - under.x, middle.y - under.y) < 1200 + 500);
    }
    // Erased again, or painted on the upper face, which does not overhang.
    wanted.paint.push_back(touch(SupportWish::usual, under, 1300, down));
    CHECK(supported(steep_roof(), wanted).supports.tips == 0);
    wanted.paint = {touch(SupportWish::enforce, under, 1200, {0, 0, 1})};
    CHECK(supported(steep_roof(), wanted).supports.tips == 0);
}

TEST_CASE("painted supports: no tip where they are blocked, not even under an island") {
    const std::vector<Body> plate{{"soft", box({-6000, -4000, 5000}, {6000, 4000, 6000}), ""}};
    SupportSettings wanted = in_wax();
    wanted.paint = {touch(SupportWish::block, {4000, 0, 5000}, 2500)};
    const SupportOutcome half = supported(plate, wanted);
    CHECK(half.supports.tips > 3);
    CHECK_FALSE(stands_under(half.supports, 4000, 0));
    CHECK(stands_under(half.supports, 0, 0));
    // Everything blocked, then one place restored.
    wanted.paint = {touch(SupportWish::block, {0, 0, 5000}, 10000)};
    const SupportOutcome none = supported(plate, wanted);
    CHECK(none.supports.tips == 0);
    CHECK(none.supports.islands_left == 1);
    wanted.paint.push_back(touch(SupportWish::enforce, {-3000, 0, 5000}, 1000));
    const SupportOutcome one = supported(plate, wanted);
    CHECK(one.supports.tips > 0);
    CHECK(stands_under(one.supports, -3000, 0));
    CHECK_FALSE(stands_under(one.supports, 3000, 0));
    CHECK(one.islands == 0);
}

TEST_CASE("invalid supports are refused") {
    const std::vector<Body> plate{{"soft", box({-600, -400, 500}, {600, 400, 600}), ""}};
    Progress progress;
    const auto refused = [&](const SupportSettings& s) {
        const auto made = make_supports(plate, support_slicing, s, progress);
        return made ? std::string() : made.error().message;
    };
    SupportSettings s = in_wax();
    s.tip_um = 2000;
    CHECK(refused(s) == "supports: a tip of 2000 um is wider than its pillar of 1000 um");
    s = in_wax();
    s.spacing_um = 200;
    CHECK(refused(s) == "supports: a spacing of 200 um is less than the diameter of a tip, 400 um");
    s = in_wax();
    s.angle_deg = 90;
    CHECK(refused(s) == "supports: angle of 90 degrees: must be 0 to 89");
    CHECK(refused({}) == "supports: a material is needed");
    s = in_wax();
    s.paint = {touch(SupportWish::block, {0, 0, 0}, 0)};
    CHECK(refused(s) == "painted supports: a radius of 0 mm: must be above 0 and at most 100 mm");
    s.paint = {touch(SupportWish::block, {0, 0, 0}, 1000, {0, 0, 0})};
    CHECK(refused(s) == "painted supports: a normal of length 0");
}

TEST_CASE("tall supports are braced, braces need no support, and a single pillar has a broad foot") {
    const Settings tall{{200, 160, 100}, 100, {}};
    const auto made_for = [&](const std::vector<Body>& part) {
        Progress progress;
        auto made = make_supports(part, tall, in_wax(), progress);
        REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
        CHECK(made->islands_left == 0);
        return std::move(*made);
    };
    const Supports table = made_for({{"soft", box({-5000, -3000, 24000}, {5000, 3000, 25000}), ""}});
    CHECK(table.tips > 4);
    CHECK(table.struts >= table.tips);
    // A foot a twentieth as wide as the pillar is long: the lowest ring of the body.
    const Supports lone = made_for({{"soft", box({-500, -500, 32500}, {500, 500, 33000}), ""}});
    REQUIRE(lone.tips == 1);
    CHECK(lone.struts == 0);
    const Box3 around = mesh::bounds(lone.bodies[0].surface_um);
    CHECK(around.size().x == near((32500 - 2000 - 500) / 20.0, {.relative = 0.05}));
    // A wall between two pillars blocks their struts.
    const std::vector<Body> walled{{"soft", box({-5000, -100, 0}, {5000, 100, 24000}), ""},
                                   {"soft", box({-2000, -2000, 24000}, {2000, 2000, 25000}), ""}};
    const Supports apart = made_for(walled);
    REQUIRE(apart.bodies.size() == static_cast<std::size_t>(apart.tips + apart.struts));
    for (auto strut = apart.bodies.begin() + apart.tips; strut != apart.bodies.end(); ++strut) {
        const Box3 box = mesh::bounds(strut->surface_um);
        CHECK((box.low.y > 0 || box.high.y < 0));
    }
}

TEST_CASE("braces hold themselves in layers that are thicker than a pillar") {
    const auto tips_of = [](double lift_um) {
        Progress progress;
        const std::vector<Body> plate{{"soft", box({-5000, -3000, lift_um}, {5000, 3000, lift_um + 2000}), ""}};
        auto made = make_supports(plate, {{200, 160, 100}, 1000, {}}, in_wax(), progress);
        REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
        CHECK(made->islands_left == 0);
        return std::pair(made->tips, made->struts);
    };
    const auto [low_tips, low_struts] = tips_of(4000);
    const auto [high_tips, high_struts] = tips_of(40000);
    CHECK(low_struts == 0);
    CHECK(high_struts > 0);
    CHECK(high_tips == low_tips);  // none under the struts
}

#include "printing/slice/overlap.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/core/near.hpp"
#include "printing/slice/arrange.hpp"
#include "printing/slice/place.hpp"
#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant::slice;
using namespace pliant::slice::test;
using pliant::near;

namespace {

std::vector<Segment> closed(const std::vector<Point2>& outline) {
    std::vector<Segment> segments;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Point2 &p = outline[i], &q = outline[(i + 1) % outline.size()];
        segments.push_back({p.x, p.y, q.x, q.y});
    }
    return segments;
}

std::vector<Segment> rectangle(double x0, double y0, double x1, double y1) {
    return closed({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
}

/// The winding number of outlines around a point, from what a ray to the left crosses: 0 outside.
int turns_around(const std::vector<Segment>& outlines, Point2 p) {
    int sum = 0;
    for (const Segment& s : outlines) {
        if ((s.y0 <= p.y) == (s.y1 <= p.y)) continue;
        const double x = s.x0 + (s.x1 - s.x0) * (p.y - s.y0) / (s.y1 - s.y0);
        if (x < p.x) sum += s.y1 > s.y0 ? 1 : -1;
    }
    return sum;
}

/// Polygons of all sizes, of which some overlap, some lie in others, some in their holes, and most stay apart.
std::vector<std::vector<Segment>> crowd(std::mt19937& random, std::size_t bodies) {
    const auto number = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    std::vector<std::vector<Segment>> outlines(bodies);
    for (int i = 0; i < 40; ++i) {
        const double radius = i < 2 ? number(20, 45) : number(0.5, 6), x = number(0, 100), y = number(0, 100);
        auto polygon = regular_polygon(3 + static_cast<int>(random() % 14), radius, number(0, 3));
        for (Point2& p : polygon) p = {p.x + x, p.y + y};
        if (random() % 3 == 0) std::reverse(polygon.begin(), polygon.end());
        const std::vector<Segment> segments = random() % 4 == 0 ? rectangle(x, y, x + radius, y + 2) : closed(polygon);
        std::vector<Segment>& body = outlines[random() % bodies];
        body.insert(body.end(), segments.begin(), segments.end());
    }
    return outlines;
}

}  // namespace

TEST_CASE("two rotated squares overlap in a regular octagon") {
    const double r = std::sqrt(2.0);  // squares of side 2
    const std::vector<std::vector<Segment>> outlines{closed(regular_polygon(4, r, std::numbers::pi / 4)),
                                                     closed(regular_polygon(4, r))};
    const std::vector<int> materials{0, 1};
    const auto areas = divided(outlines, materials).areas;
    CHECK(areas[0].others == near(8 * (std::sqrt(2.0) - 1), {.relative = 1e-12}));  // apothem 1
    CHECK(areas[0].own == 0);
    CHECK(areas[1].others == 0);
}

TEST_CASE("two circles of 200 corners overlap nearly in a lens") {
    constexpr int corners = 200;
    auto moved = regular_polygon(corners, 1);
    for (Point2& p : moved) p.x += 0.7;
    const std::vector<std::vector<Segment>> outlines{closed(regular_polygon(corners, 1)), closed(moved)};
    const auto areas = divided(outlines, std::vector<int>{0, 1}).areas;
    const double lens = 2 * std::acos(0.35) - 0.35 * std::sqrt(4 - 0.49);
    CHECK(areas[0].others == near(lens, {.relative = 2e-3}));
    CHECK(areas[0].others < lens);
}

TEST_CASE("the last body keeps the overlap; holes and touching borders are no overlap") {
    auto ring = rectangle(0, 0, 10, 10);
    for (Segment& s : rectangle(2, 2, 8, 8)) ring.push_back({s.x1, s.y1, s.x0, s.y0});
    const std::vector<std::vector<Segment>> outlines{ring, rectangle(2, 2, 8, 8), rectangle(10, 0, 12, 10),
                                                     rectangle(7, 4, 11, 5), rectangle(1, 4, 3, 5)};
    const auto areas = divided(outlines, std::vector<int>{0, 1, 2, 0, 0}).areas;
    CHECK(areas[0].own == near(2 + 1, {.relative = 1e-12}));
    CHECK(areas[0].others == 0);
    CHECK(areas[1].others == near(1 + 1, {.relative = 1e-12}));
    CHECK(areas[2].others == near(1, {.relative = 1e-12}));
    CHECK(areas[3].own == 0);
}

TEST_CASE("what the chords of a common curved face leave of an overlap that was cut out is no warning") {
    const auto warnings = [](double chord_um, double deep_um) {
        std::vector<Body> bodies{{"soft", box({-1000, -1000, 0}, {1000, 1000, 1000}), "block"},
                                 {"firm", box({1000 - deep_um, -1000, 0}, {2000, 1000, 1000}), "peg"}};
        bodies[0].chord_um = chord_um;
        pliant::Progress progress;
        const auto summary = slice_bodies(
            bodies, {{64, 48, 100}, 50, {}}, [](int, int, const RunImage&) { return pliant::Status{}; }, progress);
        REQUIRE(summary.has_value());
        CHECK(summary->lost_mm3[0] == near(deep_um / 1000 * 2, {.relative = 1e-9}));
        return std::ranges::count_if(summary->warnings, [](const std::string& line) {
            return line.find("overlap with later bodies") != std::string::npos;
        });
    };
    CHECK(warnings(0, 5) == 1);
    CHECK(warnings(10, 5) == 0);
    // More than 20 um over the 16 mm^2 of the block's surface is no residue of chords of 10 um.
    CHECK(warnings(10, 200) == 1);
}

TEST_CASE("air is cut out of a body, also where it reaches beyond it, and follows it") {
    // A block of 4 x 4 x 3 mm; a room of 1 x 2 x 1 mm, of which a tenth of 1 mm lies beyond the block, twice.
    Body block{"soft", box({10000, 0, 5000}, {14000, 4000, 8000}), "block"};
    const mesh::TriMesh room = box({13100, 1000, 6000}, {14100, 3000, 7000});
    block.air_um = {room, room};
    std::vector<Body> bodies{block, {"firm", box({13000, 0, 8000}, {14000, 4000, 9000}), "peg"}};
    REQUIRE(scale(bodies, 0.5));
    REQUIRE(turn(bodies, {0, 0, 90}));
    const Raster raster{100, 80, 50};
    REQUIRE(place_on_platform(bodies, raster));
    for (const double rotation : {0.0, 30.0}) {
        Raster turned = raster;
        turned.rotation_deg = rotation;
        double lit_mm3 = 0;
        pliant::Progress progress;
        const auto summary = slice_bodies(
            bodies, {turned, 50, {}},
            [&](int, int material, const RunImage& image) {
                if (material == 0) lit_mm3 += static_cast<double>(image.value_sum()) / 255 * 0.05 * 0.05 * 0.05;
                return pliant::Status{};
            },
            progress);
        REQUIRE_MESSAGE(summary.has_value(), (summary ? "" : summary.error().message));
        CHECK(lit_mm3 == near((48 - 1.8) / 8, {.relative = 2e-3}));
        CHECK(summary->air_mm3[0] == near(1.8 / 8, {.relative = 1e-6}));
        CHECK(summary->air_mm3[1] == 0);
        CHECK(summary->lost_mm3[0] == near(0, {.absolute = 1e-9}));
        CHECK(summary->warnings.empty());
    }
}

TEST_CASE("an overlap in partly filled pixels counts fully") {
    // 30 um of a pixel of 100 um, and borders in the middle of pixels all around.
    const std::vector<Body> bodies{{"soft", box({-950, -450, 0}, {50, 450, 100}), "left"},
                                   {"firm", box({-250, -350, 0}, {1050, 550, 100}), "right"}};
    pliant::Progress progress;
    const auto summary = slice_bodies(
        bodies, {{64, 48, 100}, 50, {}}, [](int, int, const RunImage&) { return pliant::Status{}; }, progress);
    REQUIRE(summary.has_value());
    CHECK(summary->overlap_mm3 == near(0.3 * 0.8 * 0.1, {.relative = 1e-12}));
    CHECK(summary->lost_mm3[1] == 0);
}

namespace {

/// Lit area of the images of a layer, in square micrometres.
double lit_um2(const std::vector<Body>& bodies, const Raster& raster, double& overlap_mm3) {
    double sum = 0;
    pliant::Progress progress;
    const auto summary = slice_bodies(
        bodies, {raster, 50, {}},
        [&](int layer, int, const RunImage& image) {
            if (layer == 0) sum += static_cast<double>(image.value_sum()) / 255;
            return pliant::Status{};
        },
        progress);
    REQUIRE_MESSAGE(summary.has_value(), (summary ? "" : summary.error().message));
    overlap_mm3 = summary->overlap_mm3;
    return sum * raster.pixel_um * raster.pixel_um;
}

}  // namespace

TEST_CASE("pixels on shared outlines of overlapping bodies get their common coverage, not the sum") {
    double overlap_mm3 = 0;
    // All outer borders are at a quarter of a pixel of 100 um, those of both bodies on the same lines.
    const std::vector<Body> boxes{{"soft", box({-975, -475, 0}, {325, 425, 50}), ""},
                                  {"firm", box({-275, -475, 0}, {1075, 425, 50}), ""},
                                  {"hard", box({-75, -475, 0}, {125, 425, 50}), ""}};
    CHECK(lit_um2(boxes, {64, 48, 100}, overlap_mm3) == near(2050 * 900, {.relative = 1e-4}));
    CHECK(overlap_mm3 == near((0.6 + 0.2) * 0.9 * 0.05, {.relative = 1e-9}));
    CHECK(lit_um2(boxes, {64, 48, 100, true, false, 30}, overlap_mm3) == near(2050 * 900, {.relative = 1e-3}));
    // One material, in two bodies and in one body of two shells.
    const std::vector<Body> alike{{"soft", boxes[0].surface_um, ""}, {"soft", boxes[1].surface_um, ""}};
    CHECK(lit_um2(alike, {64, 48, 100}, overlap_mm3) == near(2050 * 900, {.relative = 1e-4}));
    CHECK(overlap_mm3 == 0);
    const std::vector<Body> shells{{"soft", together(boxes[0].surface_um, boxes[1].surface_um), ""}};
    CHECK(lit_um2(shells, {64, 48, 100}, overlap_mm3) == near(2050 * 900, {.relative = 1e-4}));
    // Two discs with the same 97 corners, one rotated by a third of a side: every border pixel belongs to both.
    const double radius = 1500, turn = 2 * std::numbers::pi / 97;
    const std::vector<Body> discs{{"soft", prism(regular_polygon(97, radius), 0, 50), ""},
                                  {"firm", prism(regular_polygon(97, radius, turn / 3), 0, 50), ""}};
    const double whole = 0.5 * 97 * radius * radius * std::sin(turn);
    const double lit = lit_um2(discs, {64, 48, 100}, overlap_mm3);
    CHECK(lit > whole);
    CHECK(lit < std::numbers::pi * radius * radius);
    CHECK(lit == near(2 * whole - overlap_mm3 / 0.05 * 1e6, {.relative = 1e-4}));
}

TEST_CASE("the areas that bodies keep make up the whole union, each place once") {
    const std::vector<std::vector<Segment>> outlines{closed(regular_polygon(7, 10)), closed(regular_polygon(5, 9, 0.2)),
                                                     rectangle(-3, -20, 2, 4), closed(regular_polygon(3, 8, 1))};
    const auto area = [](const std::vector<Segment>& lines) {
        double sum = 0;
        for (const Segment& s : lines) sum += (s.y1 - s.y0) * (s.x0 + s.x1) / 2;
        return -sum;  // the solid lies to the right of lines that run to higher rows
    };
    const DividedLayer layer = divided(outlines, std::vector<int>{0, 1, 2, 0});
    for (std::size_t b = 0; b < outlines.size(); ++b) {
        const double drawn = std::fabs(area(outlines[b]));
        CHECK(area(layer.kept[b]) == near(drawn - layer.areas[b].others - layer.areas[b].own, {.relative = 1e-9}));
    }
}

TEST_CASE("in a crowd of polygons each place is kept by the last body there, once") {
    std::mt19937 random(5);
    const std::vector<int> materials{0, 1, 0, 2};
    for (int scene = 0; scene < 50; ++scene) {
        CAPTURE(scene);
        const auto outlines = crowd(random, materials.size());
        const DividedLayer layer = divided(outlines, materials);
        for (int i = 0; i < 200; ++i) {
            const Point2 p{static_cast<double>(random() % 1000003) / 1e4,
                           static_cast<double>(random() % 1000003) / 1e4};
            int last = -1;
            for (std::size_t b = 0; b < outlines.size(); ++b) {
                if (turns_around(outlines[b], p) != 0) last = static_cast<int>(b);
            }
            for (std::size_t b = 0; b < outlines.size(); ++b)
                CHECK(turns_around(layer.kept[b], p) == (static_cast<int>(b) == last ? 1 : 0));
        }
    }
}

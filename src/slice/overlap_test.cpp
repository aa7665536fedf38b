#include "slice/overlap.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "slice/slicer.hpp"
#include "slice/test_shapes.hpp"

using namespace pliant::slice;
using namespace pliant::slice::test;

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

}  // namespace

TEST_CASE("two turned squares share a regular octagon") {
    const double r = std::sqrt(2.0);  // squares of side 2
    const std::vector<std::vector<Segment>> outlines{closed(regular_polygon(4, r, std::numbers::pi / 4)),
                                                     closed(regular_polygon(4, r))};
    const std::vector<int> materials{0, 1};
    const auto areas = overlaps(outlines, materials);
    CHECK(areas[0].others == doctest::Approx(8 * (std::sqrt(2.0) - 1)).epsilon(1e-12));  // apothem 1
    CHECK(areas[0].own == 0);
    CHECK(areas[1].others == 0);
}

TEST_CASE("two circles of 200 corners share nearly a lens") {
    constexpr int corners = 200;
    auto moved = regular_polygon(corners, 1);
    for (Point2& p : moved) p.x += 0.7;
    const std::vector<std::vector<Segment>> outlines{closed(regular_polygon(corners, 1)), closed(moved)};
    const auto areas = overlaps(outlines, std::vector<int>{0, 1});
    const double lens = 2 * std::acos(0.35) - 0.35 * std::sqrt(4 - 0.49);
    CHECK(areas[0].others == doctest::Approx(lens).epsilon(2e-3));
    CHECK(areas[0].others < lens);
}

TEST_CASE("the last body keeps the place; holes and touching borders are no overlap") {
    auto ring = rectangle(0, 0, 10, 10);
    for (Segment& s : rectangle(2, 2, 8, 8)) ring.push_back({s.x1, s.y1, s.x0, s.y0});
    const std::vector<std::vector<Segment>> outlines{ring, rectangle(2, 2, 8, 8), rectangle(10, 0, 12, 10),
                                                     rectangle(7, 4, 11, 5), rectangle(1, 4, 3, 5)};
    const auto areas = overlaps(outlines, std::vector<int>{0, 1, 2, 0, 0});
    CHECK(areas[0].own == doctest::Approx(2 + 1));
    CHECK(areas[0].others == 0);
    CHECK(areas[1].others == doctest::Approx(1 + 1));
    CHECK(areas[2].others == doctest::Approx(1));
    CHECK(areas[3].own == 0);
}

TEST_CASE("an overlap in pixels that neither body fills counts whole") {
    // 30 um of a pixel of 100 um, and borders in the middle of pixels all around.
    const std::vector<Body> bodies{{"soft", box({-950, -450, 0}, {50, 450, 100}), "left"},
                                   {"firm", box({-250, -350, 0}, {1050, 550, 100}), "right"}};
    pliant::Progress progress;
    const auto summary = slice_bodies(
        bodies, {{64, 48, 100}, 50, {}}, [](int, int, const RunImage&) { return pliant::Status{}; }, progress);
    REQUIRE(summary.has_value());
    CHECK(summary->overlap_mm3 == doctest::Approx(0.3 * 0.8 * 0.1).epsilon(1e-12));
    CHECK(summary->lost_mm3[1] == 0);
}

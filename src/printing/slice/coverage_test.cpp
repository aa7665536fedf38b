#include "printing/slice/coverage.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant::slice;
using namespace pliant::slice::test;
using pliant::near;

namespace {

/// The part of a polygon where `inside(p)` >= 0 (Sutherland-Hodgman clipping): an independent way to compute areas.
template <class Distance>
std::vector<Point2> clip(const std::vector<Point2>& polygon, const Distance& inside) {
    std::vector<Point2> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
        const double dp = inside(p), dq = inside(q);
        if (dp >= 0) kept.push_back(p);
        if ((dp >= 0) != (dq >= 0))
            kept.push_back({p.x + (q.x - p.x) * dp / (dp - dq), p.y + (q.y - p.y) * dp / (dp - dq)});
    }
    return kept;
}

double polygon_area(const std::vector<Point2>& polygon) {
    double twice = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
        twice += p.x * q.y - p.y * q.x;
    }
    return twice / 2;
}

double clipped_area(std::vector<Point2> polygon, double x0, double x1, double y0, double y1) {
    polygon = clip(polygon, [&](Point2 p) { return p.x - x0; });
    polygon = clip(polygon, [&](Point2 p) { return x1 - p.x; });
    polygon = clip(polygon, [&](Point2 p) { return p.y - y0; });
    polygon = clip(polygon, [&](Point2 p) { return y1 - p.y; });
    return polygon.empty() ? 0 : polygon_area(polygon);
}

/// Dense coverage from the cells, by the rule in Cell's comment.
std::vector<double> dense(const std::vector<Cell>& cells, const Raster& raster) {
    std::vector<double> own(raster.width_px * raster.height_px, 0.0), passed = own;
    const double step = 1.0 / static_cast<double>(full_coverage);
    for (const Cell& c : cells) {
        if (c.column() >= raster.width_px) continue;
        own[c.row() * raster.width_px + c.column()] += static_cast<double>(c.area) * step;
        passed[c.row() * raster.width_px + c.column()] += static_cast<double>(c.cover) * step;
    }
    for (int row = 0; row < raster.height_px; ++row) {
        double sum = 0;
        for (int column = 0; column < raster.width_px; ++column) {
            const std::size_t i = row * raster.width_px + column;
            own[i] += sum;
            sum += passed[i];
        }
    }
    return own;
}

std::vector<double> coverage(const std::vector<Point2>& polygon, const Raster& raster) {
    std::vector<Segment> segments;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point2 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
        segments.push_back({p.x * grid_per_um, p.y * grid_per_um, q.x * grid_per_um, q.y * grid_per_um});
    }
    CellBuffer buffer;
    buffer.add(0, in_image(segments, raster));
    return dense(buffer.sorted(), raster);
}

void check_every_pixel(const std::vector<Point2>& polygon, const Raster& raster) {
    const std::vector<double> pixels = coverage(polygon, raster);
    double sum = 0, worst = 0;
    for (int row = 0; row < raster.height_px; ++row) {
        for (int column = 0; column < raster.width_px; ++column) {
            const double x0 = (column - raster.width_px / 2.0) * raster.pixel_um;
            const double y1 = (raster.height_px / 2.0 - row) * raster.pixel_um;
            const double sx = raster.mirror_x ? -1 : 1, sy = raster.mirror_y ? -1 : 1;
            const double xa = sx * x0, xb = sx * (x0 + raster.pixel_um), ya = sy * y1, yb = sy * (y1 - raster.pixel_um);
            const double exact =
                clipped_area(polygon, std::min(xa, xb), std::max(xa, xb), std::min(ya, yb), std::max(ya, yb)) /
                (raster.pixel_um * raster.pixel_um);
            const double got = pixels[row * raster.width_px + column];
            worst = std::max(worst, std::fabs(got - exact));
            sum += got;
        }
    }
    CHECK(worst < 1e-10);
    const double exact_sum = polygon_area(polygon) / (raster.pixel_um * raster.pixel_um);
    CHECK(std::fabs(sum - exact_sum) < 1e-9 * exact_sum);
}

const Raster coarse_raster{40, 30, 50};

}  // namespace

TEST_CASE("every pixel of a triangle, a rotated square and a disc has its exact coverage") {
    for (const bool mirror_x : {false, true}) {
        for (const bool mirror_y : {false, true}) {
            const Raster r{40, 30, 50, mirror_x, mirror_y};
            check_every_pixel({{-700.3, -611.7}, {812.9, -122.2}, {33.1, 701.5}}, r);
            check_every_pixel(regular_polygon(4, 640, 0.3), r);
            check_every_pixel(regular_polygon(4, 707.1067811865476, std::numbers::pi / 4), r);  // along the pixels
            check_every_pixel(regular_polygon(257, 733.3), r);
        }
    }
}

TEST_CASE("shapes inside one pixel, on pixel borders and at the raster's edge have exact coverage") {
    check_every_pixel({{10, 10}, {20, 12}, {15, 30}}, coarse_raster);
    check_every_pixel({{0, 0}, {50, 0}, {50, 50}, {0, 50}}, coarse_raster);
    check_every_pixel({{-1000, -750}, {1000, -750}, {1000, 750}, {-1000, 750}}, coarse_raster);
    check_every_pixel({{-1000, -750}, {1000, -750}, {1000, -749.5}, {-1000, -749.75}}, coarse_raster);
}

TEST_CASE("an outline takes cells along its border only") {
    CellBuffer buffer;
    const double a = 500.0 * grid_per_um;
    buffer.add(0, in_image({{-a, -a, a, -a}, {a, -a, a, a}, {a, a, -a, a}, {-a, a, -a, -a}}, coarse_raster));
    CHECK(buffer.sorted().size() == 40);  // two upright sides of 20 rows
}

TEST_CASE("outlines beyond the raster are clamped to it") {
    const std::vector<double> pixels =
        coverage({{-9999, -9999}, {9999, -9999}, {9999, 9999}, {-9999, 9999}}, coarse_raster);
    for (const double p : pixels) CHECK(p == near(1, {.relative = 1e-12}));
}

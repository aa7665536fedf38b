#include "printing/twin/wet_part.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "base/core/near.hpp"
#include "printing/twin/test_runs.hpp"

using namespace pliant;
using namespace pliant::twin;
using twin::test::block;

namespace {

machine::Projector projector(bool mirror_x, bool mirror_y) {
    machine::Projector p;
    p.width_px = 200;
    p.height_px = 100;
    p.pixel_um = 100;
    p.mirror_x = mirror_x;
    p.mirror_y = mirror_y;
    return p;
}

double solid(const wash::PartCells& cells) {
    return std::accumulate(cells.solid.begin(), cells.solid.end(), 0.0) * cells.cell_mm * cells.cell_mm * cells.high_mm;
}

}  // namespace

TEST_CASE("a wet part has the place and volume of its images, mirrored as the projector is") {
    CoarsePart part(200, 100, 100, 4000);
    // 1 mm high, 4 x 2 mm, right of and above the middle; then 1 mm of half of it.
    part.add(0, 1000, 0, block(10, 30, 120, 160));
    part.add(1000, 2000, 1, block(10, 30, 120, 140));
    const wash::PartCells cells = wet_part(part, projector(false, false));
    CHECK(solid(cells) == near(4 * 2 * 1 + 2 * 2 * 1, {.relative = 1e-12}));
    CHECK(cells.x_mm == near(2, {.relative = 1e-12}));
    CHECK(cells.y_mm == near(2, {.relative = 1e-12}));
    CHECK(cells.height_mm() == near(2, {.relative = 1e-12}));
    CHECK(cells.at(cells.columns - 1, 0, 0));
    CHECK_FALSE(cells.at(cells.columns - 1, 0, cells.slabs - 1));
    const wash::PartCells mirrored = wet_part(part, projector(true, true));
    CHECK(mirrored.x_mm == near(-6, {.relative = 1e-12}));
    CHECK(mirrored.y_mm == near(-4, {.relative = 1e-12}));
    CHECK_FALSE(mirrored.at(0, 0, mirrored.slabs - 1));
    CHECK(mirrored.at(mirrored.columns - 1, 0, mirrored.slabs - 1));
}

TEST_CASE("a part without solid cells has no faces") {
    CHECK(wash::wet_faces(wet_part(CoarsePart(10, 10, 50, 1000), projector(false, false))).empty());
}

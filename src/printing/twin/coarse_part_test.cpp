#include "printing/twin/coarse_part.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "printing/twin/test_runs.hpp"

using namespace pliant;
using twin::CoarsePart;
using twin::test::block;

namespace {

/// Volume of one material, in pixels times um.
double volume(const CoarsePart& part, int material) {
    double sum = 0;
    for (const CoarsePart::CellRun& run : part.runs()) {
        if (run.material != material) continue;
        const CoarsePart::Slab& slab = part.slabs()[run.slab];
        sum +=
            static_cast<double>(run.end - run.begin) * part.cell_px() * part.cell_px() * (slab.top_um - slab.bottom_um);
    }
    return sum;
}

}  // namespace

TEST_CASE("two materials side by side are in their cells, and the last slab grows with its layers") {
    CoarsePart part(100, 60, 50, 25600);  // slabs of 100 um
    part.add(0, 50, 0, block(10, 20, 10, 30));
    part.add(0, 50, 1, block(10, 20, 30, 40));
    REQUIRE(part.slabs().size() == 1);
    CHECK(part.closed() == 0);
    CHECK(part.cell_px() == 1);
    CHECK(volume(part, 0) == 10 * 20 * 50);
    CHECK(volume(part, 1) == 10 * 10 * 50);
    part.add(50, 100, 0, block(10, 20, 10, 30));
    part.add(50, 100, 1, block(10, 20, 30, 40));
    CHECK(part.slabs().size() == 1);
    CHECK(part.slabs()[0].top_um == 100);
    CHECK(volume(part, 0) == 10 * 20 * 100);
    part.add(100, 150, 1, block(0, 5, 0, 100));
    CHECK(part.closed() == 1);
    CHECK(part.slabs().size() == 2);
    CHECK(part.top_um() == 150);
    CHECK(part.revision() == 0);
    CHECK(volume(part, 1) == 10 * 10 * 100 + 5 * 100 * 50);
}

TEST_CASE("a cell covered by a quarter is empty, one covered by half is full") {
    CoarsePart part(4096, 64, 50, 256);  // cells of 4 px
    REQUIRE(part.cell_px() == 4);
    part.add(0, 50, 0, block(0, 1, 0, 4));    // a quarter of a cell
    part.add(0, 50, 0, block(8, 10, 8, 12));  // half of one
    REQUIRE(part.runs().size() == 1);
    CHECK(part.runs()[0].row == 2);
    CHECK(part.runs()[0].begin == 2);
    CHECK(part.runs()[0].end == 3);
    CoarsePart faint(100, 60, 50, 256);
    faint.add(0, 50, 0, block(0, 1, 0, 4, 40));  // grey: 16 % of every pixel
    CHECK(faint.runs().empty());
}

TEST_CASE("the number of runs is limited for any resolution, and the volume is kept") {
    CoarsePart part(512, 512, 50, 100 * 50);
    double all = 0;
    for (int layer = 0; layer < 100; ++layer) {
        twin::Runs runs;
        for (int row = 0; row < 512; ++row) {
            // Stripes of 6 px, shifted slightly from layer to layer.
            for (int at = 32 + layer % 3; at + 6 < 480; at += 12) runs.push_back({row, at, at + 6, 255});
        }
        for (const twin::Run& run : runs) all += (run.end - run.begin) * 50.0;
        part.add(50 * layer, 50 * (layer + 1), 0, runs);
    }
    part.add(5000, 5050, 0, {});
    CHECK(part.runs().size() <= CoarsePart::most_runs);
    CHECK(part.revision() > 0);
    CHECK(part.top_um() == 5050);
    // Stripes narrower than a cell fill it: at most twice the volume, and none are lost.
    CHECK(volume(part, 0) > 0.7 * all);
    CHECK(volume(part, 0) < 2.2 * all);
    int top = 0;
    for (const CoarsePart::Slab& slab : part.slabs()) {
        CHECK(slab.bottom_um >= top);
        top = slab.top_um;
    }
}

TEST_CASE("empty or invalid layers are ignored, and pixels beyond the frame are cut off") {
    CoarsePart part(100, 60, 50, 1000);
    part.add(100, 100, 0, block(0, 5, 0, 5));
    part.add(0, 50, -1, block(0, 5, 0, 5));
    part.add(0, 50, 300, block(0, 5, 0, 5));
    CHECK(part.slabs().empty());
    part.add(0, 50, 0, block(58, 70, 90, 130));  // beyond the frame
    CHECK(volume(part, 0) == 2 * 10 * 50);
}

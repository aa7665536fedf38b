#include "library/printing/cured_block.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;

namespace {

/// 20 x 10 pixels of 50 um, two vats.
machine::Printer printer() {
    machine::Printer p;
    p.projector.width_px = 20;
    p.projector.height_px = 10;
    p.projector.pixel_um = 50;
    p.vats.resize(2);
    p.vats[0].resin = "soft";
    p.vats[1].resin = "firm";
    return p;
}

/// The upper layer first; in it a pixel of both resins, and one that was lit twice.
std::vector<twin::CuredLayer> layers() {
    return {{200, 100, {{0, {{4, 6, 8, 255}, {5, 6, 7, 100}}, {}}, {1, {{5, 6, 7, 120}, {4, 9, 10, 510}}, {}}}},
            {100, 100, {{1, {{3, 5, 7, 255}}, {}}}},
            {300, 100, {{0, {}, {}}}}};
}

}  // namespace

TEST_CASE("a cured block has layers from below, rows from the lowest y, and each voxel's main resin") {
    const CuredBlock block = library::cured_block(layers(), printer());
    CHECK(block.size == std::array<std::size_t, 3>{5, 3, 2});  // columns 5 to 9, rows 3 to 5
    CHECK(block.resins == std::vector<std::string>{"firm", "soft"});
    CHECK(block.pixel_mm == near(0.05, {.relative = 1e-15}));
    CHECK(block.corner_mm[0] == near(0.25, {.relative = 1e-12}));
    CHECK(block.corner_mm[1] == near(0.2, {.relative = 1e-12}));  // below row 5 of 10
    CHECK(block.corner_mm[2] == near(0, {.absolute = 1e-15}));
    CHECK(block.tops_mm[1] == near(0.2, {.relative = 1e-15}));
    const auto at = [&](std::size_t z, std::size_t y, std::size_t x) {
        const std::size_t voxel = (z * 3 + y) * 5 + x;
        return std::array<int, 2>{block.resin[voxel], block.share[voxel]};
    };
    CHECK(at(0, 2, 0) == std::array{1, 255});  // row 3 is the greatest y
    CHECK(at(0, 2, 2) == std::array{0, 0});
    CHECK(at(1, 1, 1) == std::array{2, 255});
    CHECK(at(1, 0, 1) == std::array{1, 220});  // 100 of soft, 120 of firm
    CHECK(at(1, 1, 4) == std::array{1, 255});
}

TEST_CASE("a mirrored projector gives the same cured block") {
    machine::Printer mirrored = printer();
    mirrored.projector.mirror_x = mirrored.projector.mirror_y = true;
    const CuredBlock plain = library::cured_block(layers(), printer()),
                     turned = library::cured_block(layers(), mirrored);
    CHECK(turned.corner_mm[0] == near(0.5, {.relative = 1e-12}));   // 20 - 10 columns
    CHECK(turned.corner_mm[1] == near(0.15, {.relative = 1e-12}));  // 3 rows
    for (std::size_t y = 0; y < 3; ++y)
        for (std::size_t x = 0; x < 5; ++x) CHECK(turned.resin[y * 5 + x] == plain.resin[(2 - y) * 5 + 4 - x]);
}

TEST_CASE("without cured resin the block is empty") {
    const CuredBlock block = library::cured_block({}, printer());
    CHECK(block.resin.empty());
    CHECK(block.size == std::array<std::size_t, 3>{0, 0, 0});
}

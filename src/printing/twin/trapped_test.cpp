#include "printing/twin/trapped.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "base/core/near.hpp"

using namespace pliant::twin;
using pliant::near;

namespace {

/// A layer of 1 mm pixels and 0.1 mm, drawn: # solid of vat 0, o solid of vat 1, + a third each, blank liquid.
CuredLayer drawn(int number, const std::vector<std::string>& rows) {
    CuredLayer layer{100 * number, 100, {{0, {}, {}}, {1, {}, {}}}};
    for (int row = 0; row < static_cast<int>(rows.size()); ++row) {
        for (int x = 0; x < static_cast<int>(rows[static_cast<std::size_t>(row)].size()); ++x) {
            const char c = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(x)];
            if (c == '#' || c == '+')
                layer.vats[0].runs.push_back({row, x, x + 1, static_cast<std::uint16_t>(c == '#' ? 255 : 85)});
            if (c == 'o' || c == '+')
                layer.vats[1].runs.push_back({row, x, x + 1, static_cast<std::uint16_t>(c == 'o' ? 255 : 85)});
        }
    }
    return layer;
}

std::vector<Trapped> trapped_in(const std::vector<CuredLayer>& layers) {
    return trapped_resin(layers, 7, 5, 1000);
}

const std::vector<std::string> plate = {"       ", " ##### ", " ##### ", " ##### ", "       "};
const std::vector<std::string> ring = {"       ", " ##### ", " #  o# ", " ##### ", "       "};
const std::vector<std::string> open_ring = {"       ", " ##### ", " #     ", " ##### ", "       "};

}  // namespace

TEST_CASE("a cavity between two plates is closed, with its volume and height") {
    const auto found = trapped_in({drawn(1, plate), drawn(2, ring), drawn(3, ring), drawn(4, plate)});
    REQUIRE(found.size() == 1);
    CHECK(found[0].closed);
    CHECK(found[0].ml == near(2 * 0.1 * 2 / 1000, {.relative = 1e-12}));  // 2 pixels of 1 mm^2, two layers of 0.1 mm
    CHECK(found[0].z_begin_um == 100);
    CHECK(found[0].z_end_um == 300);
    CHECK(found[0].x_begin_px == 2);
    CHECK(found[0].x_end_px == 4);
    CHECK(found[0].y_begin_px == 2);
    CHECK(found[0].y_end_px == 3);
}

TEST_CASE("a cavity open below or at its lowest side drains; one open only at its upper side is a cup") {
    CHECK(trapped_in({drawn(1, plate), drawn(2, ring), drawn(3, ring)}).empty());
    CHECK(trapped_in({drawn(1, plate), drawn(2, ring), drawn(3, open_ring), drawn(4, plate)}).empty());
    const auto cup = trapped_in({drawn(1, plate), drawn(2, open_ring), drawn(3, ring), drawn(4, plate)});
    REQUIRE(cup.size() == 1);
    CHECK_FALSE(cup[0].closed);
    CHECK(cup[0].ml == near(2 * 0.1 / 1000, {.relative = 1e-12}));  // only the layer below the opening stays full
    CHECK(cup[0].z_begin_um == 200);
    // The order in which layers cured does not matter, only their heights.
    CHECK(trapped_in({drawn(4, plate), drawn(3, ring), drawn(2, open_ring), drawn(1, plate)}).size() == 1);
}

TEST_CASE("cavities that join further up are one, the largest comes first; solid and empty parts have none") {
    const std::vector<std::string> two = {"       ", " ##### ", " # # # ", " ##### ", "       "};
    const std::vector<std::string> wide = {"       ", " ##### ", " #   # ", " ##### ", "       "};
    const auto joined = trapped_in({drawn(1, plate), drawn(2, wide), drawn(3, two), drawn(4, plate)});
    REQUIRE(joined.size() == 1);
    CHECK(joined[0].ml == near(5 * 0.1 / 1000, {.relative = 1e-12}));
    const auto apart = trapped_in({drawn(1, plate), drawn(2, two), drawn(3, plate), drawn(4, ring), drawn(5, plate)});
    REQUIRE(apart.size() == 3);
    CHECK(apart[0].ml == near(2 * 0.1 / 1000, {.relative = 1e-12}));
    CHECK(trapped_in({drawn(1, plate), drawn(2, plate)}).empty());
    CHECK(trapped_in({}).empty());
}

TEST_CASE("a wall of two resins holds; one less than half cured leaks") {
    const std::vector<std::string> shared = {"       ", " ##### ", " #  +# ", " ##### ", "       "};
    const std::vector<std::string> weak = {"       ", " ##### ", " #  o+ ", " ##+## ", "       "};
    CHECK(trapped_in({drawn(1, plate), drawn(2, shared), drawn(3, plate)}).size() == 1);
    auto leak = drawn(2, weak);
    leak.vats[1].runs.clear();  // a wall cured to a third does not count
    CHECK(trapped_in({drawn(1, plate), leak, drawn(3, plate)}).empty());
}

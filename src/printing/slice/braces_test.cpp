#include "printing/slice/braces.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::slice;

namespace {

Pillar pillar(double x_mm, double y_mm, double height_mm) {
    return {1000 * x_mm, 1000 * y_mm, 0, 1000 * height_mm, 500};
}

bool never(const Strut&) {
    return false;
}

}  // namespace

TEST_CASE("short pillars have no braces; slender ones are braced every ten diameters, in alternating directions") {
    CHECK(braces({pillar(0, 0, 10), pillar(3, 0, 10)}, 100, never).struts.empty());
    const Braces made = braces({pillar(0, 0, 34), pillar(3, 0, 40)}, 100, never);
    REQUIRE(made.struts.size() == 4);  // from 0, 10, 20 and 30 mm, 3 mm up each
    CHECK(made.held == std::vector<bool>{true, true});
    for (std::size_t i = 0; i < 4; ++i) {
        const Strut& s = made.struts[i];
        CHECK(s.from_um.z == near(10000.0 * static_cast<double>(i), {.relative = 1e-12}));
        CHECK(s.to_um.z - s.from_um.z == near(3000, {.relative = 1e-12}));  // 45 degrees
        CHECK(s.from_um.x == (i % 2 == 0 ? 0 : 3000));
        CHECK(s.to_um.x == (i % 2 == 0 ? 3000 : 0));
        CHECK(s.radius_um == 250);
    }
}

TEST_CASE("each slender pillar has two braces if neighbours are near enough, and no brace that is blocked") {
    std::vector<Pillar> grid;
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) grid.push_back(pillar(3 * i, 3 * j, 15));
    }
    const Braces made = braces(grid, 100, never);
    for (const Pillar& p : grid) {
        int ends = 0;
        for (const Strut& s : made.struts) {
            for (const Vec3& end : {s.from_um, s.to_um}) ends += std::hypot(end.x - p.x_um, end.y - p.y_um) < 1;
        }
        CHECK(ends >= 2);
    }
    const Braces far = braces({pillar(0, 0, 30), pillar(10.1, 0, 30)}, 100, never);
    CHECK(far.struts.empty());
    CHECK(far.held == std::vector<bool>{false, false});
    const Braces barred =
        braces({pillar(0, 0, 30), pillar(3, 0, 30)}, 100, [](const Strut& s) { return s.from_um.z < 15000; });
    CHECK(barred.struts.size() == 1);  // only that from 20 mm
    CHECK(braces({pillar(0, 0, 30), pillar(3, 0, 30)}, 400, never).struts[0].radius_um == 400);
}

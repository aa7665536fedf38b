#include "simulation/contact/belonging.hpp"

#include <doctest/doctest.h>

#include <array>

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

/// Two strips of triangles 1 long, `gap` above each other and `apart` beside their seam, that share nodes 0 and 1.
struct Notch {
    std::vector<double> positions;
    Surface surface;
};
Notch notch(double half_opening) {
    // Nodes 0 and 1: the tip. 2, 3 one edge up the first flank, 4, 5 up the second; 6, 7 and 8, 9 two edges up.
    Notch n;
    const auto add = [&](double x, double y, double z) { n.positions.insert(n.positions.end(), {x, y, z}); };
    for (const double y : {0.0, 1.0}) add(0, y, 0);
    for (const double z : {1.0, 2.0})
        for (const double side : {-1.0, 1.0})
            for (const double y : {0.0, 1.0}) add(side * half_opening * z, y, z);
    n.surface = make_surface(std::vector<std::array<int, 3>>{
        {0, 1, 2}, {1, 3, 2}, {0, 4, 1}, {1, 4, 5}, {2, 3, 6}, {3, 7, 6}, {4, 8, 5}, {5, 8, 9}});
    return n;
}

bool together(const Notch& n, std::vector<int> first, std::vector<int> second, double apart) {
    return Belonging(n.surface, n.positions, 1e-12).together(first, second, apart);
}

}  // namespace

TEST_CASE("surfaces that nearly touch within one edge of their seam count as joined, a narrow notch does not") {
    CHECK(together(notch(1e-6), {2}, {4, 5, 8}, 2e-6));
    CHECK(together(notch(0.005), {2}, {4, 5, 8}, 0.01));
    CHECK_FALSE(together(notch(0.0175), {2}, {4, 5, 8}, 0.035));  // 2 degrees
}

TEST_CASE("away from a seam only surfaces that touch within rounding count as joined") {
    CHECK(together(notch(2e-5), {6, 7}, {8, 9}, 8e-5));
    // Three edges lie between these: a gap of a hundredth of an edge there is a gap.
    Notch far = notch(0.0025);
    far.positions.insert(far.positions.end(), {-0.0075, 0, 3, -0.0075, 1, 3, 0.0075, 0, 3, 0.0075, 1, 3});
    far.surface = make_surface(std::vector<std::array<int, 3>>{{0, 1, 2},
                                                               {1, 3, 2},
                                                               {0, 4, 1},
                                                               {1, 4, 5},
                                                               {2, 3, 6},
                                                               {3, 7, 6},
                                                               {4, 8, 5},
                                                               {5, 8, 9},
                                                               {6, 7, 10},
                                                               {8, 12, 9}});
    CHECK_FALSE(together(far, {10}, {8, 12, 9}, 0.015));
}

TEST_CASE("nodes of obstacles count as joined only if they touch") {
    const Notch n = notch(0.1);
    CHECK_FALSE(together(n, {2}, {20, 21, 22}, 1e-9));
    CHECK(together(n, {2}, {20, 21, 22}, 1e-13));
}

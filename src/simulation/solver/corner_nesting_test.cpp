#include "simulation/solver/corner_nesting.hpp"

#include <doctest/doctest.h>

#include "simulation/peers/reference_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

Model clamped(int order) {
    Description d;
    d.mesh = reference::kuhn_box({3, 1, 1}, 3, 1, 1, [](Vec3) { return 0; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"rubber", material::neo_hookean(1e6, 0.3), 0}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    return Model::create(std::move(d)).value();
}

}  // namespace

TEST_CASE("a node on an edge is nested in the edge's free ends, a corner in itself") {
    const Model model = clamped(2);
    const auto nesting = nest_in_corners(model);
    REQUIRE(nesting);
    CHECK(nesting->coarse_nodes == 3 * 4);
    CHECK(nesting->ends.size() == static_cast<std::size_t>(model.free_count()));
    // Positions of the coarse nodes, by those that are corners themselves; held ones at the clamp.
    std::vector<Vec3> at(static_cast<std::size_t>(nesting->coarse_nodes));
    const auto visit = [&](const auto& use) {
        for (std::size_t node = 0; node < model.free_index().size(); ++node) {
            const int free = model.free_index()[node];
            if (free >= 0) use(model.mesh().points[node], nesting->ends[static_cast<std::size_t>(free)]);
        }
    };
    visit([&](const Vec3& p, const std::array<int, 2>& ends) {
        if (ends[0] == ends[1]) at[static_cast<std::size_t>(ends[0])] = p;
    });
    visit([&](const Vec3& p, const std::array<int, 2>& ends) {
        if (ends[0] < 0 || ends[1] < 0) {
            CHECK(p.x == 0.5);
            return;
        }
        const Vec3 middle = 0.5 * (at[static_cast<std::size_t>(ends[0])] + at[static_cast<std::size_t>(ends[1])]);
        CHECK(norm(p - middle) < 1e-12);
    });
}

TEST_CASE("linear tets have no nesting in corners") {
    CHECK_FALSE(nest_in_corners(clamped(1)));
}

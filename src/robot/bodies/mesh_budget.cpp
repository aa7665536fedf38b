#include "robot/bodies/mesh_budget.hpp"

#include <algorithm>

namespace pliant::robot {
namespace {

/// Nodes in a cube of edge 1, and those that a square of surface adds, where edges have the length 1: counted in
/// meshes of cubes.
struct Density {
    double per_cube, per_square;
};

Density density(int order) {
    return order == 2 ? Density{6.2, 2.3} : Density{0.83, 0.58};
}

/// `mean_walls`: the thickness of a wall by the volume on each square of its surface.
double nodes(std::span<const Bulk> bodies, const Fineness& fineness, double mean_walls) {
    constexpr double least_share = 1.0 / 8;  // of the size, to which edges in walls get shorter
    const Density each = density(fineness.order);
    double sum = 0;
    for (const Bulk& body : bodies) {
        if (!(body.area > 0)) continue;
        double edge = fineness.size;
        if (fineness.through_wall > 0)
            edge = std::clamp(mean_walls * body.volume / body.area / fineness.through_wall, least_share * edge, edge);
        sum += each.per_cube * body.volume / (edge * edge * edge) + each.per_square * body.area / (edge * edge);
    }
    return sum;
}

}  // namespace

double expected_nodes(std::span<const Bulk> bodies, const Fineness& fineness) {
    return nodes(bodies, fineness, 2);  // a sheet has two faces
}

double fewest_nodes(std::span<const Bulk> bodies, const Fineness& fineness) {
    constexpr double sure = 0.7;
    return sure * nodes(bodies, fineness, 6);  // of a cube or a sphere: its width
}

Fineness coarsened(std::span<const Bulk> bodies, Fineness fineness, double most) {
    constexpr double matters = 1.3, longer = 1.05;
    const auto plain = [](Fineness one) { return Fineness{one.size, 0, one.order}; };
    while (expected_nodes(bodies, fineness) > most) {
        const bool by_walls = fineness.through_wall > 0 &&
                              expected_nodes(bodies, fineness) > matters * expected_nodes(bodies, plain(fineness));
        if (by_walls)
            --fineness.through_wall;
        else
            fineness.size *= longer;
    }
    return fineness;
}

Fineness within_budget(std::span<const Bulk> bodies, const Fineness& fineness, double most) {
    constexpr double margin = 0.75;  // coarse meshes have up to a quarter more nodes than expected
    return fewest_nodes(bodies, fineness) <= most ? fineness : coarsened(bodies, fineness, margin * most);
}

}  // namespace pliant::robot

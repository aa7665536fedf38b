// How many nodes a mesh will have, told before it is made.
#pragma once

#include <span>

namespace pliant::robot {

/// What a body measures.
struct Bulk {
    double volume = 0;
    double area = 0;  ///< of its surface
};

/// How finely a mesh divides the bodies.
struct Fineness {
    double size = 0;       ///< edge length
    int through_wall = 0;  ///< elements through every wall, as in mesh::MeshSettings
    int order = 2;
};

/// The nodes of the mesh; within some tens of per cent for compact bodies and for sheets.
[[nodiscard]] double expected_nodes(std::span<const Bulk> bodies, const Fineness& fineness);

/// Fewer than any mesh of these bodies has.
[[nodiscard]] double fewest_nodes(std::span<const Bulk> bodies, const Fineness& fineness);

/// Fewer elements through walls, where these need the nodes, and longer edges, until at most `most` nodes are expected.
[[nodiscard]] Fineness coarsened(std::span<const Bulk> bodies, Fineness fineness, double most);

/// The same fineness if the mesh may have at most `most` nodes; if it surely has more, one of somewhat fewer than that.
[[nodiscard]] Fineness within_budget(std::span<const Bulk> bodies, const Fineness& fineness, double most);

}  // namespace pliant::robot

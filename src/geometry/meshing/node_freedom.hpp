// How a mesh node may move without changing the meshed shape.
#pragma once

#include <optional>
#include <vector>

#include "geometry/meshing/editable_tets.hpp"

namespace pliant::mesh {

inline constexpr double one_plane =
    0.99999;  ///< cosine of a quarter of a degree: faces that meet at a smaller angle count as one plane

/// The directions in which a node may move.
struct Freedom {
    int dimensions = 0;
    Vec3 axis{};          ///< for 2 dimensions: the normal; for 1: the direction
    bool curved = false;  ///< it slides over the surrounding border faces, which are not coplanar
};

/// `smooth`: the cosine of the angle between faces above which their common edge is sharp.
[[nodiscard]] Freedom freedom_of(const EditableTets& tets, int v, double smooth);

/// The allowed position nearest to node v plus `step`; nothing if a curved surface has none there. `surface`: for a
/// curved one, the faces around v before any move.
[[nodiscard]] std::optional<Vec3> allowed_place(const EditableTets& tets, int v, const Freedom& f,
                                                const std::vector<Border>& surface, const Vec3& step);

}  // namespace pliant::mesh

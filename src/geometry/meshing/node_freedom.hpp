// Where a node of a mesh may go without changing the shape that is meshed.
#pragma once

#include <optional>
#include <vector>

#include "geometry/meshing/editable_tets.hpp"

namespace pliant::mesh {

inline constexpr double one_plane =
    0.99999;  ///< cosine of a quarter of a degree: faces that meet at less are one plane

/// Where a node may go.
struct Freedom {
    int dimensions = 0;
    Vec3 axis{};          ///< for 2 dimensions: normal to them; for 1: along it
    bool curved = false;  ///< over the borders around, not in a plane
};

/// `smooth`: the cosine of the angle between faces beyond which their common edge is sharp.
[[nodiscard]] Freedom freedom_of(const EditableTets& tets, int v, double smooth);

/// The allowed place nearest to node v plus `step`; nothing where a curved surface has none there. `surface`: the faces
/// around v before it was moved, for a curved one.
[[nodiscard]] std::optional<Vec3> allowed_place(const EditableTets& tets, int v, const Freedom& f,
                                                const std::vector<Border>& surface, const Vec3& step);

}  // namespace pliant::mesh

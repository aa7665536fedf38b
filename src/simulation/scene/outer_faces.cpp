#include "simulation/scene/outer_faces.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <variant>

#include "geometry/repair/cavity.hpp"

namespace pliant::robot {
namespace {

/// On nodes of the description's mesh; -1 for a corner that no body carries.
std::array<int, 3> sorted_corners(std::array<int, 3> corners) {
    std::ranges::sort(corners);
    return corners;
}

/// Faces of the bodies at the air of meshed chambers. The air of all others lies in cavities that are closed anyway.
std::set<std::array<int, 3>> faces_at_air(const ModelDraft& draft) {
    std::set<std::array<int, 3>> found;
    for (const ChamberSpec& chamber : draft.robot.chambers) {
        if (std::holds_alternative<SurfaceFile>(chamber.air) || std::holds_alternative<CavityAt>(chamber.air)) continue;
        const auto region = static_cast<int>(draft.region_of(Region::Use::chamber, chamber.name));
        for (const mesh::Face& face : mesh::region_faces(draft.whole, region)) {
            const auto node = [&](std::size_t i) {
                return draft.node_of_whole[static_cast<std::size_t>(face.nodes[i])];
            };
            found.insert(sorted_corners({node(0), node(1), node(2)}));
        }
    }
    return found;
}

}  // namespace

BodyFaces body_faces(const ModelDraft& draft) {
    const std::set<std::array<int, 3>> at_air = faces_at_air(draft);
    const std::vector<mesh::Face> reached = mesh::faces_from_outside(draft.bodies);
    BodyFaces faces;
    auto next = reached.begin();
    for (const mesh::Face& face : mesh::boundary_faces(draft.bodies)) {
        const bool from_outside = next != reached.end() && next->nodes == face.nodes;
        if (from_outside) ++next;
        const bool is_wall = at_air.contains(sorted_corners({face.nodes[0], face.nodes[1], face.nodes[2]}));
        (from_outside && !is_wall ? faces.outer : faces.inner).push_back(face);
    }
    return faces;
}

}  // namespace pliant::robot

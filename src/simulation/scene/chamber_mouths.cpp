#include "simulation/scene/chamber_mouths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "base/core/disjoint_sets.hpp"

namespace pliant::robot {
namespace {

/// A direction counts as held if less than this of its unit vector is left over.
constexpr double left_over = 1e-3;

/// (nodes that supports without motion hold) unit vectors at right angles that span the held directions.
using Held = std::map<int, std::vector<Vec3>>;

/// What of `direction` is at right angles to `held`.
Vec3 free_part(Vec3 direction, const std::vector<Vec3>& held) {
    for (const Vec3& axis : held) direction -= dot(direction, axis) * axis;
    return direction;
}

Held held_directions(const sim::Description& robot) {
    static const std::vector<Vec3> all = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Held held;
    for (const sim::Support& support : robot.supports) {
        if (support.moves()) continue;
        const std::vector<Vec3>& directions = support.directions.empty() ? all : support.directions;
        for (const int node : support.nodes) {
            std::vector<Vec3>& of_node = held[node];
            for (const Vec3& direction : directions) {
                const Vec3 rest = free_part(unit(direction), of_node);
                if (norm(rest) > left_over) of_node.push_back(unit(rest));
            }
        }
    }
    return held;
}

class Mouths {
public:
    Mouths(const ModelDraft& draft, const sim::Wall& wall)
        : draft_(draft), wall_(wall), held_(held_directions(draft.description)) {}

    /// Every point stays in the plane of the face, so that the mouth remains flat and the volume well defined.
    [[nodiscard]] bool stays_in_plane(const sim::WallFace& face) const {
        const Vec3 normal = unit(cross(at(face[1]) - at(face[0]), at(face[2]) - at(face[0])));
        return std::ranges::all_of(face, [&](int point) {
            if (point < 0 || node_of(point) < 0) return true;
            const auto held = held_.find(node_of(point));
            return held != held_.end() && norm(free_part(normal, held->second)) < left_over;
        });
    }
    /// A piece of the wall touches no body.
    [[nodiscard]] bool lies_outside() const {
        DisjointSets pieces(wall_.points.size());
        for (const sim::WallFace& face : wall_.faces) {
            for (const int point : face) {
                if (point >= 0) pieces.join(face[0], point);
            }
        }
        std::vector<bool> touches(wall_.points.size(), false);
        for (std::size_t p = 0; p < wall_.points.size(); ++p) {
            if (node_of(static_cast<int>(p)) >= 0) touches[root(pieces, p)] = true;
        }
        for (std::size_t p = 0; p < wall_.points.size(); ++p) {
            if (!touches[root(pieces, p)]) return true;
        }
        return false;
    }

private:
    static std::size_t root(DisjointSets& sets, std::size_t i) {
        return static_cast<std::size_t>(sets.find(static_cast<int>(i)));
    }
    /// Node of the robot; -1 if no body carries the point.
    [[nodiscard]] int node_of(int point) const {
        const auto& nodes = wall_.points[static_cast<std::size_t>(point)].nodes;
        return nodes.empty() ? -1 : nodes[0];
    }
    /// At rest.
    [[nodiscard]] Vec3 at(int point) const {
        const int node = node_of(point);
        return node < 0 ? wall_.points[static_cast<std::size_t>(point)].fixed
                        : draft_.description.mesh.points[static_cast<std::size_t>(node)];
    }

    const ModelDraft& draft_;
    const sim::Wall& wall_;
    Held held_;
};

std::array<int, 3> ascending(std::array<int, 3> corners) {
    std::ranges::sort(corners);
    return corners;
}

std::array<int, 3> corners_of(const mesh::Face& face) {
    return ascending({face.nodes[0], face.nodes[1], face.nodes[2]});
}

/// Of these faces (corners ascending) of `draft.whole` those of elements: of bodies, or of gaps.
std::set<std::array<int, 3>> faces_of_elements(const ModelDraft& draft, const std::set<std::array<int, 3>>& faces) {
    const mesh::TetMesh& elements = draft.description.mesh;
    std::vector<int> whole_of_node(elements.points.size(), -1);  // for nodes on these faces
    for (const auto& corners : faces) {
        for (const int node : corners) {
            const int own = draft.node_of_whole[static_cast<std::size_t>(node)];
            if (own >= 0) whole_of_node[static_cast<std::size_t>(own)] = node;
        }
    }
    std::set<std::array<int, 3>> found;
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        const std::span<const int> nodes = elements.tet(t);
        const auto whole = [&](int corner) {
            return whole_of_node[static_cast<std::size_t>(nodes[static_cast<std::size_t>(corner)])];
        };
        for (const auto& [a, b, c] : mesh::face_corners) {
            const std::array<int, 3> corners = ascending({whole(a), whole(b), whole(c)});
            if (corners[0] >= 0 && faces.contains(corners)) found.insert(corners);
        }
    }
    return found;
}

/// Where the bounding boxes of two drawn chambers overlap, as text; "" if that cannot be told.
std::string overlap_of(const ModelDraft& draft, const ChamberSpec& a, const ChamberSpec& b) {
    const auto* first = std::get_if<mesh::Solid>(&a.air);
    const auto* second = std::get_if<mesh::Solid>(&b.air);
    if (first == nullptr || second == nullptr) return "";
    const Box3 one = mesh::bounds(*first), other = mesh::bounds(*second);
    Vec3 low, high;
    for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::max(one.low[i], other.low[i]);
        high[i] = std::min(one.high[i], other.high[i]);
    }
    const double unit = draft.robot.unit_m;
    return fmt::format(", between {} and {}", draft.show(unit * low), draft.show(unit * high));
}

/// Another chamber whose air begins at one of these faces.
const ChamberSpec* neighbour_at(const ModelDraft& draft, const ChamberSpec& spec,
                                const std::set<std::array<int, 3>>& faces) {
    for (const ChamberSpec& other : draft.robot.chambers) {
        const bool meshed =
            !std::holds_alternative<SurfaceFile>(other.air) && !std::holds_alternative<CavityAt>(other.air);
        if (other.name == spec.name || !meshed) continue;
        const auto region = static_cast<int>(draft.region_of(Region::Use::chamber, other.name));
        for (const mesh::Face& face : mesh::region_faces(draft.whole, region)) {
            if (faces.contains(corners_of(face))) return &other;
        }
    }
    return nullptr;
}

}  // namespace

std::size_t put_mouths_last(const ModelDraft& draft, std::vector<mesh::Face>& faces) {
    std::set<std::array<int, 3>> all;
    for (const mesh::Face& face : faces) all.insert(corners_of(face));
    const std::set<std::array<int, 3>> closed = faces_of_elements(draft, all);
    const auto mouths = std::stable_partition(
        faces.begin(), faces.end(), [&](const mesh::Face& face) { return closed.contains(corners_of(face)); });
    return static_cast<std::size_t>(faces.end() - mouths);
}

std::string open_mouth(const ModelDraft& draft, const ChamberSpec& spec, const std::vector<mesh::Face>& faces,
                       const sim::Wall& wall) {
    const Mouths mouths(draft, wall);
    std::set<std::array<int, 3>> loose;
    for (std::size_t f = faces.size() - wall.mouth_faces; f < faces.size(); ++f) {
        if (!mouths.stays_in_plane(wall.faces[f])) loose.insert(corners_of(faces[f]));
    }
    if (mouths.lies_outside())
        return fmt::format("lies outside every body, at least in part; draw its air where a body surrounds it; {}",
                           draft.show_bounds());
    if (loose.empty()) return "";
    if (const ChamberSpec* other = neighbour_at(draft, spec, loose))
        return fmt::format(
            "overlaps chamber \"{}\", or touches it without a wall between them{}; draw them apart, or "
            "as one chamber",
            other->name, overlap_of(draft, spec, *other));
    return fmt::format(
        "{} faces of its wall belong to no body: the chamber is open; close it with a body, or let its "
        "mouth lie in a [[fixed]] without move or rotate that holds it, or lets it slide in its own "
        "plane",
        loose.size());
}

}  // namespace pliant::robot

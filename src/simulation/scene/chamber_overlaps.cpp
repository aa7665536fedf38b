#include "simulation/scene/chamber_overlaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "base/core/boxes.hpp"
#include "geometry/mesh/triangle_tree.hpp"

namespace pliant::robot {
namespace {

/// Of the smaller chamber: a surface from a file need not match the mesh, and may reach a little into a neighbour.
constexpr double most_shared = 0.05;

/// Nodes in the order of the face, the smallest first: it keeps the side of the air.
using Corners = std::array<int, 3>;

/// The faces of a wall that consist of nodes; none for one from a surface file.
std::vector<Corners> faces_of_nodes(const sim::Wall& wall) {
    std::vector<Corners> faces;
    for (const sim::WallFace& face : wall.faces_of_bodies()) {
        Corners corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& nodes = wall.points[static_cast<std::size_t>(face[i])].nodes;
            corners[i] = nodes.size() == 1 ? nodes[0] : -1;
        }
        if (std::ranges::count(corners, -1) > 0) continue;
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        faces.push_back(corners);
    }
    return faces;
}

/// A wall at rest, without the bulge of quadratic faces.
mesh::TriMesh surface_of(const sim::Wall& wall, const std::vector<double>& rest) {
    mesh::TriMesh surface;
    for (const sim::Attachment& point : wall.points) surface.points.push_back(sim::position(point, rest));
    for (const sim::WallFace& face : wall.faces) surface.triangles.push_back({face[0], face[1], face[2]});
    return surface;
}

/// Volume that two closed surfaces have in common, by the points of a grid.
double shared_volume(const mesh::TriMesh& a, const mesh::TriMesh& b) {
    constexpr int cells = 16;
    const Box3 one = mesh::bounds(a), other = mesh::bounds(b);
    if (!boxes_overlap(one, other)) return 0;
    Box3 box;
    for (std::size_t i = 0; i < 3; ++i) {
        box.low[i] = std::max(one.low[i], other.low[i]);
        box.high[i] = std::min(one.high[i], other.high[i]);
    }
    const mesh::TriangleTree in_a(a), in_b(b);
    const Vec3 step = box.size() / cells;
    int shared = 0;
    for (int k = 0; k < cells * cells * cells; ++k) {
        const Vec3 cell{k % cells + 0.5, k / cells % cells + 0.5, k / (cells * cells) + 0.5};
        const Vec3 p = box.low + Vec3{cell.x * step.x, cell.y * step.y, cell.z * step.z};
        shared += std::fabs(in_a.winding_number(p)) > 0.5 && std::fabs(in_b.winding_number(p)) > 0.5 ? 1 : 0;
    }
    return shared * step.x * step.y * step.z;
}

bool is_from_file(const ChamberSpec& chamber) {
    return std::holds_alternative<SurfaceFile>(chamber.air);
}

/// (chambers) the first one before it with a face of the same bodies; -1: none.
std::vector<int> first_with_same_face(const ModelDraft& draft) {
    std::map<Corners, int> owner;
    std::vector<int> first;
    for (const sim::Chamber& chamber : draft.description.chambers) {
        const auto own = static_cast<int>(first.size());
        first.push_back(-1);
        for (const Corners& face : faces_of_nodes(chamber.wall)) {
            const auto [entry, is_new] = owner.emplace(face, own);
            if (!is_new && (first.back() < 0 || entry->second < first.back())) first.back() = entry->second;
        }
    }
    return first;
}

/// The same where one of the two is from a file, whose faces are its own.
int first_with_same_space(const ModelDraft& draft, std::size_t chamber, const std::vector<mesh::TriMesh>& surfaces) {
    const auto volume = [&](std::size_t k) { return std::fabs(mesh::signed_volume(surfaces[k])); };
    for (std::size_t k = 0; k < chamber; ++k) {
        if (!is_from_file(draft.robot.chambers[k]) && !is_from_file(draft.robot.chambers[chamber])) continue;
        const double smaller = std::min(volume(k), volume(chamber));
        if (shared_volume(surfaces[k], surfaces[chamber]) > most_shared * smaller) return static_cast<int>(k);
    }
    return -1;
}

std::vector<mesh::TriMesh> surfaces_of(const ModelDraft& draft) {
    std::vector<double> rest;
    for (const Vec3& p : draft.description.mesh.points) rest.insert(rest.end(), {p.x, p.y, p.z});
    std::vector<mesh::TriMesh> surfaces;
    for (const sim::Chamber& chamber : draft.description.chambers) surfaces.push_back(surface_of(chamber.wall, rest));
    return surfaces;
}

}  // namespace

void check_overlaps(ModelDraft& draft) {
    const auto& chambers = draft.robot.chambers;
    if (chambers.size() < 2) return;
    const std::vector<int> same_face = first_with_same_face(draft);
    const std::vector<mesh::TriMesh> surfaces = surfaces_of(draft);
    for (std::size_t k = 1; k < chambers.size(); ++k) {
        const int first = same_face[k] >= 0 ? same_face[k] : first_with_same_space(draft, k, surfaces);
        if (first < 0) continue;
        // A chamber drawn in a part of a cavity is open as well, which is not the cause.
        std::erase_if(draft.problems, [&](const Diagnostic& d) { return d.line > 0 && d.line == chambers[k].line; });
        draft.problem(chambers[k].line, "chamber", chambers[k].name,
                      fmt::format("its air is that of chamber \"{}\", at least in part: two chambers cannot hold the "
                                  "same air; draw them apart, or leave one out",
                                  chambers[static_cast<std::size_t>(first)].name));
    }
}

}  // namespace pliant::robot

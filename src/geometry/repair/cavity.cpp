#include "geometry/repair/cavity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "geometry/repair/surface_shells.hpp"

namespace pliant::mesh {
namespace {

/// Faces connected by edges. Normals point out of the material: a shell around empty space is inside out.
struct SkinShell {
    std::vector<std::size_t> faces;
    TriMesh surface;
    Box3 box;
    double volume;
    Vec3 on_it;  ///< in the middle of a face, so on no other shell

    [[nodiscard]] bool surrounds(const Vec3& p) const {
        return box.contains(p) && std::fabs(winding_number(surface, p)) > 0.5;
    }
};

std::vector<SkinShell> shells_of(const TetMesh& mesh, const std::vector<Face>& faces) {
    TriMesh skin{mesh.points, {}};
    for (const Face& face : faces) skin.triangles.push_back({face.nodes[0], face.nodes[1], face.nodes[2]});
    std::vector<SkinShell> shells;
    for (std::vector<std::size_t>& triangles : shell_triangles(skin)) {
        TriMesh surface = part_of(skin, triangles);
        const Box3 box = bounds(surface);
        const double volume = signed_volume(surface);
        const auto& [a, b, c] = surface.triangles.front();
        const Vec3 middle = (surface.points[a] + surface.points[b] + surface.points[c]) / 3;
        shells.push_back({std::move(triangles), std::move(surface), box, volume, middle});
    }
    return shells;
}

/// The smallest shell around a point, if it is around empty space there; else null. `except`: not looked at.
const SkinShell* smallest_around(const std::vector<SkinShell>& shells, const Vec3& p, const SkinShell* except) {
    const SkinShell* smallest = nullptr;
    for (const SkinShell& shell : shells) {
        const bool larger = smallest != nullptr && std::fabs(shell.volume) >= std::fabs(smallest->volume);
        if (&shell != except && !larger && shell.surrounds(p)) smallest = &shell;
    }
    return smallest != nullptr && smallest->volume < 0 ? smallest : nullptr;
}

std::vector<Face> picked(const std::vector<Face>& faces, const std::vector<bool>& picks) {
    std::vector<Face> some;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (picks[f]) some.push_back(faces[f]);
    }
    return some;
}

}  // namespace

Result<std::vector<Face>> cavity_faces(const TetMesh& mesh, const Vec3& point) {
    const std::vector<Face> faces = boundary_faces(mesh);
    const std::vector<SkinShell> shells = shells_of(mesh, faces);
    double winding = 0;
    for (const SkinShell& shell : shells) winding += winding_number(shell.surface, point);
    if (winding > 0.5) return input_error("lies in the material");
    const SkinShell* enclosing = smallest_around(shells, point, nullptr);
    if (enclosing == nullptr)
        return input_error(
            "lies in no closed cavity: the space around it is open to the outside; close each mouth with cap = SHAPE");
    std::vector<bool> taken(faces.size(), false);
    for (const SkinShell& shell : shells) {
        const bool floats = shell.volume > 0 && smallest_around(shells, shell.on_it, &shell) == enclosing;
        if (&shell != enclosing && !floats) continue;
        for (const std::size_t f : shell.faces) taken[f] = true;
    }
    return picked(faces, taken);
}

std::vector<Face> faces_from_outside(const TetMesh& mesh) {
    std::vector<Face> faces = boundary_faces(mesh);
    const std::vector<SkinShell> shells = shells_of(mesh, faces);
    const auto is_cavity = [](const SkinShell& shell) { return shell.volume < 0; };
    if (std::ranges::none_of(shells, is_cavity)) return faces;
    std::vector<bool> reached(faces.size(), false);
    for (const SkinShell& shell : shells) {
        if (is_cavity(shell) || smallest_around(shells, shell.on_it, &shell) != nullptr) continue;
        for (const std::size_t f : shell.faces) reached[f] = true;
    }
    return picked(faces, reached);
}

}  // namespace pliant::mesh

// Closed bodies that touch, overlap and intersect themselves: grouping, and the joint mesh, in which no tet is inverted
// or has an invalid region.
#include <string>

#include "geometry/mesher/mesher.hpp"
#include "geometry/meshing/touching_bodies.hpp"
#include "geometry/repair/surface_check.hpp"
#include "shapes.hpp"

namespace {

using namespace pliant;

void trap_on_bad_mesh(const mesh::TetMesh& mesh, std::size_t bodies) {
    if (mesh.region_names.size() != bodies || mesh.region.size() != mesh.tet_count()) __builtin_trap();
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        const auto at = [&](int i) { return mesh.points.at(static_cast<std::size_t>(n[static_cast<std::size_t>(i)])); };
        if (mesh.region[t] < 0 || mesh.region[t] >= static_cast<int>(bodies)) __builtin_trap();
        if (!(mesh::signed_tet_volume(at(0), at(1), at(2), at(3)) > 0)) __builtin_trap();
    }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes bytes(data, size);
    std::vector<mesh::BodyGeometry> bodies(1 + static_cast<std::size_t>(bytes.up_to(2)));
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        bodies[b].name = "body " + std::to_string(b + 1);
        mesh::TriMesh surface = shapes::closed(bytes);
        if (!mesh::check_closed(surface)) return 0;
        bodies[b].shape = std::move(surface);
    }
    const auto groups = mesh::touching_groups(bodies, 2);
    if (!groups) return 0;
    for (const mesh::TouchingGroup& group : *groups) {
        if (group.bodies.size() < 2 || group.surfaces.size() != group.bodies.size()) __builtin_trap();
    }
    mesh::MeshSettings settings;
    settings.size = 4;
    settings.order = 1;
    Progress silent;
    const auto mesh = mesh::mesh_bodies(bodies, settings, silent);
    if (mesh) trap_on_bad_mesh(*mesh, bodies.size());
    return 0;
}

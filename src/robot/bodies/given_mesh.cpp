#include "robot/bodies/given_mesh.hpp"

#include <fmt/core.h>

#include <utility>
#include <vector>

#include "base/core/text.hpp"
#include "geometry/files/tet_file.hpp"
#include "robot/bodies/body_errors.hpp"
#include "robot/description/regions.hpp"

namespace pliant::robot {
namespace {

bool box_holds_centroid(const BoxSelector& box, const mesh::TetMesh& mesh, std::size_t tet) {
    Vec3 centroid;
    for (std::size_t i = 0; i < 4; ++i) centroid += 0.25 * mesh.points[static_cast<std::size_t>(mesh.tet(tet)[i])];
    return Box3{box.low, box.high}.contains(centroid, 0);
}

/// Assigns to user `u` the tets of its region. A region has one user, but a box may take tets from earlier users.
Status claim_tets(const Robot& robot, const mesh::TetMesh& mesh, const std::vector<Region>& users, std::size_t u,
                  std::vector<int>& user_of_tet) {
    const Region& user = users[u];
    const auto& wanted = std::get<MeshRegion>(*user.geometry);
    const auto wrong = [&](std::string text) {
        return tl::unexpected(at(place(robot, user.line, user.kind, user.name), {Cause::input, std::move(text)}));
    };
    std::size_t found = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const std::string& region = mesh.region_names[static_cast<std::size_t>(mesh.region[t])];
        if (wanted.name != "all" && wanted.name != region) continue;
        if (wanted.box && !box_holds_centroid(*wanted.box, mesh, t)) continue;
        ++found;
        if (user_of_tet[t] >= 0 && !wanted.box) {
            const Region& first = users[static_cast<std::size_t>(user_of_tet[t])];
            return wrong(fmt::format("region \"{}\" already belongs to {} \"{}\"", region, first.kind, first.name));
        }
        user_of_tet[t] = static_cast<int>(u);
    }
    if (found > 0) return {};
    if (wanted.box) return wrong("the box holds no centroid of a tetrahedron of the region");
    return wrong(fmt::format("the mesh has no region \"{}\"; it has {}", wanted.name, join_names(mesh.region_names)));
}

/// Straight tets of the corners of a quadratic mesh, without its other nodes. A linear mesh comes back unchanged.
mesh::TetMesh to_linear(mesh::TetMesh mesh) {
    if (mesh.order == 1) return mesh;
    std::vector<int> corners;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t)
        corners.insert(corners.end(), mesh.tet(t).begin(), mesh.tet(t).begin() + 4);
    std::vector<int> place(mesh.points.size(), -1);
    for (const int node : corners) place[static_cast<std::size_t>(node)] = 0;
    std::vector<Vec3> points;
    for (std::size_t n = 0; n < place.size(); ++n) {
        if (place[n] < 0) continue;
        place[n] = static_cast<int>(points.size());
        points.push_back(mesh.points[n]);
    }
    for (int& node : corners) node = place[static_cast<std::size_t>(node)];
    mesh.order = 1;
    mesh.points = std::move(points);
    mesh.nodes = std::move(corners);
    return mesh;
}

}  // namespace

Result<mesh::TetMesh> give_regions(const Robot& robot, mesh::TetMesh mesh) {
    if (const auto pair = mesh::overlapping_tets(mesh)) {
        if (pair->same)
            return tl::unexpected(
                at(place(robot, robot.mesh.line, "mesh", ""), {Cause::input, mesh::overlap_text(*pair)}));
        mesh.notes.push_back(mesh::overlap_text(*pair));  // as slivers of published meshes do
    }
    const std::vector<Region> users = regions_of(robot);
    std::vector<int> user_of_tet(mesh.tet_count(), -1);
    for (std::size_t u = 0; u < users.size(); ++u) {
        if (Status status = claim_tets(robot, mesh, users, u, user_of_tet); !status)
            return tl::unexpected(status.error());
    }
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (user_of_tet[t] < 0) {
            return tl::unexpected(at(place(robot, robot.mesh.line, "mesh", ""),
                                     {Cause::input, fmt::format("no body names region \"{}\" of the mesh",
                                                                mesh.region_names[mesh.region[t]])}));
        }
    }
    mesh.region = std::move(user_of_tet);
    mesh.region_names.clear();
    for (const Region& user : users) mesh.region_names.emplace_back(user.name);
    return robot.mesh.order == 2 ? mesh::to_quadratic(mesh) : to_linear(std::move(mesh));
}

Result<mesh::TetMesh> read_mesh_file(const Robot& robot) {
    if (*robot.mesh.file == mesh_in_memory)
        return tl::unexpected(at(place(robot, robot.mesh.line, "mesh", ""),
                                 {Cause::input, "file: a mesh in memory can only be given by a program; name a file"}));
    Result<mesh::TetMesh> mesh = mesh::read_tet_mesh(*robot.mesh.file);
    if (!mesh) return tl::unexpected(at(place(robot, robot.mesh.line, "mesh", ""), mesh.error()));
    return give_regions(robot, mesh::placed(std::move(*mesh), robot.mesh.placement));
}

}  // namespace pliant::robot

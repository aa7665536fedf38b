#include "robot/build.hpp"

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "mesh/mesher.hpp"
#include "mesh/surface_file.hpp"
#include "mesh/tet_file.hpp"

namespace pliant::robot {
namespace {

/// "file:line: [[kind]] \"name\": ".
std::string place(const Robot& robot, int line, std::string_view kind, std::string_view name) {
    const std::string where = line > 0 ? fmt::format("{}:{}", robot.file.string(), line) : robot.file.string();
    return name.empty() ? fmt::format("{}: {}: ", where, kind) : fmt::format("{}: {} \"{}\": ", where, kind, name);
}

Error at(const std::string& place, const Error& error) {
    return {error.cause, place + error.message};
}

Result<mesh::TriMesh> read_body_surface(const Robot& robot, const BodySpec& body, const SurfaceFile& file) {
    Result<mesh::SurfaceFile> surface = mesh::read_surface(file.path);
    if (!surface) return tl::unexpected(at(place(robot, body.line, "body", body.name), surface.error()));
    return std::move(surface->mesh);
}

double automatic_size(const std::vector<mesh::BodyGeometry>& bodies) {
    Box3 box;
    for (const auto& body : bodies) {
        const Box3 one = mesh::bounds(body);
        box.add(one.low);
        box.add(one.high);
    }
    return std::max({box.size().x, box.size().y, box.size().z}) / 24;
}

Result<mesh::TetMesh> mesh_drawn_bodies(const Robot& robot, Progress& progress) {
    std::vector<mesh::BodyGeometry> bodies;
    for (const BodySpec& body : robot.bodies) {
        if (const auto* solid = std::get_if<mesh::Solid>(&body.geometry)) {
            bodies.push_back({body.name, *solid});
        } else {
            Result<mesh::TriMesh> surface = read_body_surface(robot, body, std::get<SurfaceFile>(body.geometry));
            if (!surface) return tl::unexpected(surface.error());
            bodies.push_back({body.name, std::move(*surface)});
        }
    }
    mesh::MeshSettings settings;
    settings.size = robot.mesh.size > 0 ? robot.mesh.size : automatic_size(bodies);
    settings.order = robot.mesh.order;
    Result<mesh::TetMesh> mesh = mesh::mesh_bodies(bodies, settings, progress);
    if (!mesh) {
        // The mesher names bodies; the line is that of the last one it names.
        int line = robot.bodies.front().line;
        for (const BodySpec& body : robot.bodies) {
            if (mesh.error().message.find('"' + body.name + '"') != std::string::npos) line = body.line;
        }
        return tl::unexpected(at(place(robot, line, "body", ""), mesh.error()));
    }
    return mesh;
}

/// Gives every region of the file to the body that names it.
Result<mesh::TetMesh> read_mesh_file(const Robot& robot) {
    Result<mesh::TetMesh> mesh = mesh::read_tet_mesh(*robot.mesh.file);
    if (!mesh) return tl::unexpected(at(place(robot, robot.mesh.line, "mesh", ""), mesh.error()));
    std::vector<int> body_of_region(mesh->region_names.size(), -1);
    for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
        const BodySpec& body = robot.bodies[b];
        const std::string& wanted = std::get<MeshRegion>(body.geometry).name;
        bool found = false;
        for (std::size_t r = 0; r < mesh->region_names.size(); ++r) {
            if (wanted != "all" && wanted != mesh->region_names[r]) continue;
            found = true;
            if (body_of_region[r] >= 0) {
                return input_error("{}region \"{}\" already belongs to body \"{}\"",
                                   place(robot, body.line, "body", body.name), mesh->region_names[r],
                                   robot.bodies[body_of_region[r]].name);
            }
            body_of_region[r] = static_cast<int>(b);
        }
        if (!found) {
            return input_error("{}the mesh has no region \"{}\"; it has {}", place(robot, body.line, "body", body.name),
                               wanted, join_names(mesh->region_names));
        }
    }
    for (std::size_t t = 0; t < mesh->tet_count(); ++t) {
        const int body = body_of_region[mesh->region[t]];
        if (body < 0) {
            return input_error("{}no body names region \"{}\" of the mesh", place(robot, robot.mesh.line, "mesh", ""),
                               mesh->region_names[mesh->region[t]]);
        }
        mesh->region[t] = body;
    }
    mesh->region_names.clear();
    for (const BodySpec& body : robot.bodies) mesh->region_names.push_back(body.name);
    return robot.mesh.order == 2 ? mesh::to_quadratic(*mesh) : std::move(*mesh);
}

}  // namespace

Result<mesh::TetMesh> build_mesh(const Robot& robot, Progress& progress) {
    Result<mesh::TetMesh> mesh = robot.mesh.file ? read_mesh_file(robot) : mesh_drawn_bodies(robot, progress);
    if (!mesh) return mesh;
    return mesh::scaled(std::move(*mesh), robot.unit_m);
}

Result<std::vector<BodySurface>> body_surfaces(const Robot& robot, Progress& progress) {
    std::vector<BodySurface> surfaces;
    Result<mesh::TetMesh> regions;
    if (robot.mesh.file) {
        regions = read_mesh_file(robot);
        if (!regions) return tl::unexpected(regions.error());
    }
    for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
        if (progress.cancelled()) return cancelled();
        progress.advance("surfaces", static_cast<double>(b) / static_cast<double>(robot.bodies.size()));
        const BodySpec& body = robot.bodies[b];
        Result<mesh::TriMesh> surface;
        if (const auto* solid = std::get_if<mesh::Solid>(&body.geometry)) {
            constexpr double printable_m = 10e-6;  // chords may leave a curve by a fraction of a pixel
            surface = mesh::tessellate(*solid, printable_m / robot.unit_m);
        } else if (const auto* file = std::get_if<SurfaceFile>(&body.geometry)) {
            surface = read_body_surface(robot, body, *file);
        } else {
            surface = mesh::region_surface(*regions, static_cast<int>(b));
        }
        if (!surface) return tl::unexpected(at(place(robot, body.line, "body", body.name), surface.error()));
        surfaces.push_back({body.name, body.material, mesh::scaled(std::move(*surface), robot.unit_m)});
    }
    return surfaces;
}

}  // namespace pliant::robot

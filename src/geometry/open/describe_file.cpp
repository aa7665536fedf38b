#include "geometry/open/describe_file.hpp"

#include <fmt/format.h>

#include "base/core/counted.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/mesher/step_file.hpp"
#include "geometry/open/open_geometry.hpp"

namespace pliant::mesh {
namespace {

std::string surface_text(const SurfaceFile& surface) {
    const Vec3 size = bounds(surface.mesh).size();
    std::string text = fmt::format("surface, {} points, {} triangles, volume {:.6g}, {:.6g} x {:.6g} x {:.6g}",
                                   surface.mesh.points.size(), surface.mesh.triangles.size(),
                                   signed_volume(surface.mesh), size.x, size.y, size.z);
    for (const std::string& warning : surface.warnings) text += "\n  note: " + warning;
    return text;
}

std::string plate_text(const threemf::ThreeMf& plate) {
    std::string text =
        fmt::format("3MF file: {} {}", plate.bodies.size(), plate.bodies.size() == 1 ? "body" : "bodies");
    for (const threemf::Body& body : plate.bodies) {
        text += body.slices.empty()
                    ? fmt::format("\n  {} ({}): {} triangles, {:.6g} mm^3", body.name, body.material,
                                  body.mesh_mm.triangles.size(), signed_volume(body.mesh_mm))
                    : fmt::format("\n  {} ({}): {} slices", body.name, body.material, body.slices.size());
    }
    for (const std::string& warning : plate.warnings) text += "\n  warning: " + warning;
    return text;
}

Result<std::string> solids_text(const std::filesystem::path& path) {
    const Result<Solid> solids = read_step(path, "", 1);
    if (!solids) return tl::unexpected(solids.error());
    const Result<double> volume = solid_volume(*solids);
    if (!volume) return tl::unexpected(volume.error());
    const std::size_t count = std::get<StepSolid>((*solids)->shape).numbers.size();
    const Vec3 size = bounds(*solids).size();
    return fmt::format("STEP file: {}, volume {:.6g} mm^3, {:.6g} x {:.6g} x {:.6g} mm", counted(count, "solid"),
                       *volume, size.x, size.y, size.z);
}

}  // namespace

Result<std::string> describe_mesh_file(const std::filesystem::path& path) {
    const Result<Geometry> geometry = open_geometry(path);
    if (!geometry) return tl::unexpected(geometry.error());
    if (const auto* tets = std::get_if<TetMesh>(&*geometry)) return report_text(report_on(*tets));
    if (const auto* surface = std::get_if<SurfaceFile>(&*geometry)) return surface_text(*surface);
    if (const auto* plate = std::get_if<threemf::ThreeMf>(&*geometry)) return plate_text(*plate);
    return solids_text(std::get<StepPath>(*geometry).path);
}

Result<MeshReport> report_on_file(const std::filesystem::path& path) {
    const Result<TetMesh> mesh = read_tet_mesh(path);
    if (!mesh) return tl::unexpected(mesh.error());
    return report_on(*mesh);
}

}  // namespace pliant::mesh

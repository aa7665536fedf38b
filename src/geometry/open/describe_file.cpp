#include "geometry/open/describe_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/core/counted.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/mesh/triangle_corners.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/mesher/step_file.hpp"
#include "geometry/open/open_geometry.hpp"
#include "geometry/repair/surface_crossings.hpp"
#include "geometry/repair/surface_seams.hpp"

namespace pliant::mesh {
namespace {

/// Why its triangles enclose no volume that could be told; "" if they do.
std::string no_volume(const TriMesh& surface) {
    constexpr double flat = 1e-9;
    const std::vector<BorderEdge> border = border_edges(surface);
    if (!border.empty()) {
        const double missing = surface_area(border_caps(surface)), whole = surface_area(surface);
        if (!(missing > flat * whole))
            return fmt::format("triangles are listed twice: {} have no neighbour of their own; it has no volume",
                               counted(border.size(), "edge"));
        return fmt::format(
            "the surface is open: {} without a neighbour, and an area of about {:.3g} is missing, of "
            "{:.3g} in all; it has no volume",
            counted(border.size(), "edge"), missing, whole);
    }
    const double size = bounds(surface).diagonal();
    if (!(std::fabs(signed_volume(surface)) > flat * size * size * size))
        return "the surface is flat: it encloses no volume";
    return "";
}

std::string surface_text(const SurfaceFile& surface) {
    const Vec3 size = bounds(surface.mesh).size();
    const std::string none = no_volume(surface.mesh);
    const std::string volume = none.empty() ? fmt::format("{:.6g}", signed_volume(surface.mesh)) : "unknown";
    std::string text = fmt::format("surface, {}, {}, volume {}, {:.6g} x {:.6g} x {:.6g}",
                                   counted(surface.mesh.points.size(), "point"),
                                   counted(surface.mesh.triangles.size(), "triangle"), volume, size.x, size.y, size.z);
    for (const std::string& warning : surface.warnings) text += "\n  note: " + warning;
    if (!none.empty())
        text += "\n  note: " + none;
    else if (cuts_itself(surface.mesh))
        text += "\n  note: the surface cuts or touches itself: the volume counts what lies in two of its parts twice";
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

Result<std::string> describe_mesh_file(const std::filesystem::path& path, double factor) {
    Result<Geometry> geometry = open_geometry(path);
    if (!geometry) return tl::unexpected(geometry.error());
    if (auto* tets = std::get_if<TetMesh>(&*geometry)) return report_text(report_on(scaled(std::move(*tets), factor)));
    if (auto* surface = std::get_if<SurfaceFile>(&*geometry)) {
        surface->mesh = scaled(std::move(surface->mesh), factor);
        return surface_text(*surface);
    }
    if (factor != 1) return input_error("{}: carries its own unit; leave --from and --to out", path.string());
    if (const auto* plate = std::get_if<threemf::ThreeMf>(&*geometry)) return plate_text(*plate);
    return solids_text(std::get<StepPath>(*geometry).path);
}

Result<MeshReport> report_on_file(const std::filesystem::path& path, double factor) {
    Result<TetMesh> mesh = read_tet_mesh(path);
    if (!mesh) return tl::unexpected(mesh.error());
    return report_on(scaled(std::move(*mesh), factor));
}

}  // namespace pliant::mesh

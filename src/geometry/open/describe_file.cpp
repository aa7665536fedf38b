#include "geometry/open/describe_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/core/counted.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/mesh/triangle_corners.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/mesher/step_file.hpp"
#include "geometry/open/open_geometry.hpp"
#include "geometry/repair/surface_crossings.hpp"
#include "geometry/repair/surface_orientation.hpp"
#include "geometry/repair/surface_seams.hpp"

namespace pliant::mesh {
namespace {

constexpr double flat = 1e-9;  // of the cube of its size, or of its area

/// What its triangles enclose, or why that is nothing that could be told.
struct Enclosed {
    std::optional<double> volume;
    std::vector<std::string> notes;
};

bool encloses_nothing(const TriMesh& surface, double size) {
    return !(std::fabs(signed_volume(surface)) > flat * size * size * size);
}

std::string open_text(const JudgedSurface& judged, double missing) {
    return fmt::format(
        "the surface is open: {} without a neighbour, and an area of about {:.3g} is missing, of {:.3g} in all; it has "
        "no volume",
        counted(judged.damage.open_edges, "edge"), missing, surface_area(judged.sound));
}

/// Judged as the mesher does. A T-junction leaves open edges, but no hole: the volume is that of the drawing.
Enclosed enclosed_by(const TriMesh& surface) {
    const double size = bounds(surface).diagonal();
    const JudgedSurface judged = mesh::judged(surface);
    Enclosed result;
    if (encloses_nothing(surface, size) && encloses_nothing(judged.sound, size) && border_edges(surface).empty()) {
        result.notes.emplace_back("the surface is flat: it encloses no volume");
        return result;
    }
    const double missing = surface_area(border_caps(judged.sound));
    const bool open = missing > flat * surface_area(judged.sound);
    if (open) {
        result.notes.push_back(open_text(judged, missing));
        SurfaceDamage rest = judged.damage;
        rest.open_edges = 0;
        if (const std::string more = describe(rest); !more.empty())
            result.notes.push_back(fmt::format("the surface is damaged ({})", more));
        return result;
    }
    if (encloses_nothing(judged.sound, size)) {
        result.notes.emplace_back("the surface encloses no volume");
        return result;
    }
    result.volume = signed_volume(judged.sound);
    if (const std::string damage = describe(judged.damage); !damage.empty())
        result.notes.push_back(fmt::format(
            "the surface is damaged ({}){}", damage,
            judged.damage.open_edges > 0 ? ": no area is missing, but corners lie on edges of other triangles" : ""));
    if (judged.damage.open_edges == 0 && cuts_itself(judged.sound))
        result.notes.emplace_back(
            "the surface cuts or touches itself: the volume counts what lies in two of its parts twice");
    return result;
}

std::string surface_text(const SurfaceFile& surface) {
    const Vec3 size = bounds(surface.mesh).size();
    const Enclosed enclosed = enclosed_by(surface.mesh);
    const std::string volume = enclosed.volume ? fmt::format("{:.6g}", *enclosed.volume) : "unknown";
    std::string text = fmt::format("surface, {}, {}, volume {}, {:.6g} x {:.6g} x {:.6g}",
                                   counted(surface.mesh.points.size(), "point"),
                                   counted(surface.mesh.triangles.size(), "triangle"), volume, size.x, size.y, size.z);
    for (const std::string& warning : surface.warnings) text += "\n  note: " + warning;
    for (const std::string& note : enclosed.notes) text += "\n  note: " + note;
    return text;
}

std::string body_text(const threemf::Body& body) {
    const std::string name = fmt::format("\n  {} ({}): ", body.name, body.material);
    if (!body.slices.empty()) return name + counted(body.slices.size(), "slice");
    const Enclosed enclosed = enclosed_by(body.mesh_mm);
    std::string text = name + counted(body.mesh_mm.triangles.size(), "triangle") + ", " +
                       (enclosed.volume ? fmt::format("{:.6g} mm^3", *enclosed.volume) : "volume unknown");
    for (const std::string& note : enclosed.notes) text += "\n    note: " + note;
    return text;
}

std::string plate_text(const threemf::ThreeMf& plate) {
    std::string text = "3MF file: " + counted(plate.bodies.size(), "body", "bodies");
    for (const threemf::Body& body : plate.bodies) text += body_text(body);
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

#include "mesh/mesh_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/files.hpp"
#include "mesh/surface_file.hpp"
#include "mesh/tet_file.hpp"

namespace pliant::mesh {
namespace {

double quality(const TetMesh& mesh, std::size_t t) {
    const auto n = mesh.tet(t);
    double longest = 0;
    for (const auto& [a, b] : edge_corners) longest = std::max(longest, norm(mesh.points[n[a]] - mesh.points[n[b]]));
    const double volume = signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]);
    return longest > 0 ? 6 * std::sqrt(2.0) * volume / (longest * longest * longest) : 0;
}

/// The smallest angle between two of the tet's faces, by its corners.
double min_dihedral(const TetMesh& mesh, std::size_t t) {
    const auto n = mesh.tet(t);
    std::array<Vec3, 4> normal;  // of the face opposite to each corner, outwards
    for (std::size_t f = 0; f < 4; ++f) {
        const auto& c = face_corners[f];
        const Vec3& a = mesh.points[n[c[0]]];
        normal[f] = cross(mesh.points[n[c[1]]] - a, mesh.points[n[c[2]]] - a);
    }
    double smallest = std::numbers::pi;
    for (std::size_t f = 0; f < 4; ++f) {
        for (std::size_t g = 0; g < f; ++g) {
            const double between = std::atan2(norm(cross(normal[f], normal[g])), dot(normal[f], normal[g]));
            smallest = std::min(smallest, std::numbers::pi - between);
        }
    }
    return smallest;
}

std::string surface_text(const SurfaceFile& surface) {
    const Vec3 size = bounds(surface.mesh).size();
    std::string text = fmt::format("surface, {} points, {} triangles, volume {:.6g}, {:.6g} x {:.6g} x {:.6g}",
                                   surface.mesh.points.size(), surface.mesh.triangles.size(),
                                   signed_volume(surface.mesh), size.x, size.y, size.z);
    for (const std::string& warning : surface.warnings) text += "\n  note: " + warning;
    return text;
}

}  // namespace

MeshReport report_on(const TetMesh& mesh) {
    MeshReport report;
    report.order = mesh.order;
    report.points = mesh.points.size();
    report.tets = mesh.tet_count();
    for (const Vec3& p : mesh.points) report.box.add(p);
    report.region_names = mesh.region_names;
    report.notes = mesh.notes;
    for (std::size_t r = 0; r < mesh.region_names.size(); ++r)
        report.region_volumes.push_back(volume(mesh, static_cast<int>(r)));
    std::vector<double> all;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) all.push_back(quality(mesh, t));
    std::sort(all.begin(), all.end());
    double angle = mesh.tet_count() > 0 ? std::numbers::pi : 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) angle = std::min(angle, min_dihedral(mesh, t));
    report.min_dihedral_deg = angle * 180 / std::numbers::pi;
    if (!all.empty()) {
        report.worst_quality = all.front();
        report.median_quality = all[all.size() / 2];
    }
    return report;
}

std::string report_text(const MeshReport& report) {
    const Vec3 size = report.box.size();
    std::string text = fmt::format(
        "{} nodes, {} {} tets, {:.6g} x {:.6g} x {:.6g}, quality worst {:.3f} median {:.3f}, "
        "smallest dihedral angle {:.1f} degrees",
        report.points, report.tets, report.order == 2 ? "quadratic" : "linear", size.x, size.y, size.z,
        report.worst_quality, report.median_quality, report.min_dihedral_deg);
    for (std::size_t r = 0; r < report.region_names.size(); ++r) {
        text += fmt::format("\n  region \"{}\": volume {:.6g}", report.region_names[r], report.region_volumes[r]);
    }
    for (const std::string& note : report.notes) text += "\n  note: " + note;
    return text;
}

Result<std::string> describe_mesh_file(const std::filesystem::path& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    if (looks_like_tet_mesh(*bytes)) {
        const Result<TetMesh> mesh = parse_tet_mesh(*bytes, path.string());
        if (!mesh) return tl::unexpected(mesh.error());
        return report_text(report_on(*mesh));
    }
    if (bytes->empty() || looks_like_surface(*bytes)) {
        const Result<SurfaceFile> surface = parse_surface(*bytes, path.string());
        if (!surface) return tl::unexpected(surface.error());
        return surface_text(*surface);
    }
    return input_error(
        "{}: is no mesh that Pliant reads (tet meshes: .vtk, .vtu or .msh; surfaces: .stl, .obj or .ply; by content)",
        path.string());
}

}  // namespace pliant::mesh

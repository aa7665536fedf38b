#include "geometry/mesh/mesh_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/core/boxes.hpp"
#include "base/core/counted.hpp"
#include "geometry/mesh/curved_tets.hpp"

namespace pliant::mesh {
namespace {

double quality(const TetMesh& mesh, std::size_t t) {
    const auto n = mesh.tet(t);
    double longest = 0;
    for (const auto& [a, b] : edge_corners) longest = std::max(longest, norm(mesh.points[n[a]] - mesh.points[n[b]]));
    const double volume = signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]);
    return longest > 0 ? 6 * std::sqrt(2.0) * volume / (longest * longest * longest) : 0;
}

/// The six angles between the tet's faces, in degrees.
std::array<double, 6> dihedral_angles(const TetMesh& mesh, std::size_t t) {
    const auto n = mesh.tet(t);
    std::array<Vec3, 4> normal;  // of the face opposite to each corner, outwards
    for (std::size_t f = 0; f < 4; ++f) {
        const auto& c = face_corners[f];
        const Vec3& a = mesh.points[n[c[0]]];
        normal[f] = cross(mesh.points[n[c[1]]] - a, mesh.points[n[c[2]]] - a);
    }
    std::array<double, 6> angles{};
    std::size_t k = 0;
    for (std::size_t f = 0; f < 4; ++f) {
        for (std::size_t g = 0; g < f; ++g) {
            const double between = std::atan2(norm(cross(normal[f], normal[g])), dot(normal[f], normal[g]));
            angles[k++] = 180 - between * 180 / std::numbers::pi;
        }
    }
    return angles;
}

/// The bin of `value` among `bins` bins from 0 to `end`.
std::size_t bin(double value, double end, std::size_t bins) {
    const double at = value / end * static_cast<double>(bins);
    return at > 0 ? std::min(static_cast<std::size_t>(at), bins - 1) : 0;
}

void add_shapes(const TetMesh& mesh, MeshReport& report) {
    std::vector<double> all(mesh.tet_count());
    report.worst_quality = std::numeric_limits<double>::infinity();
    report.min_dihedral_deg = 180;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        all[t] = quality(mesh, t);
        ++report.quality_counts[bin(all[t], 1, MeshReport::quality_bins)];
        for (const double angle : dihedral_angles(mesh, t)) {
            report.min_dihedral_deg = std::min(report.min_dihedral_deg, angle);
            report.max_dihedral_deg = std::max(report.max_dihedral_deg, angle);
            ++report.dihedral_counts[bin(angle, 180, MeshReport::dihedral_bins)];
        }
        if (mesh.order == 2 && all[t] > 0)
            report.worst_jacobian = std::min(report.worst_jacobian, worst_scaled_jacobian(mesh, t));
        if (all[t] >= report.worst_quality) continue;
        report.worst_quality = all[t];
        report.worst_at = {};
        for (std::size_t c = 0; c < 4; ++c) report.worst_at += 0.25 * mesh.points[mesh.tet(t)[c]];
    }
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    report.median_quality = *middle;
}

void add_regions(const TetMesh& mesh, MeshReport& report) {
    for (const std::string& name : mesh.region_names) report.regions.push_back({name, 0, 0});
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        RegionReport& region = report.regions[static_cast<std::size_t>(mesh.region[t])];
        ++region.tets;
        region.volume += curved_volume(mesh, t);
    }
}

}  // namespace

double smallest_dihedral_deg(const TetMesh& mesh) {
    double smallest = 180;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        for (const double angle : dihedral_angles(mesh, t)) smallest = std::min(smallest, angle);
    }
    return smallest;
}

std::size_t sliver_count(const TetMesh& mesh, double below_deg) {
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const std::array<double, 6> angles = dihedral_angles(mesh, t);
        count += *std::min_element(angles.begin(), angles.end()) < below_deg ? 1 : 0;
    }
    return count;
}

MeshReport report_on(const TetMesh& mesh) {
    MeshReport report;
    report.order = mesh.order;
    report.points = mesh.points.size();
    report.tets = mesh.tet_count();
    report.box = bounds_of(mesh.points);
    report.notes = mesh.notes;
    if (const auto pair = overlapping_tets(mesh)) report.notes.push_back(overlap_text(*pair));
    add_regions(mesh, report);
    if (mesh.tet_count() > 0) add_shapes(mesh, report);
    return report;
}

std::string report_text(const MeshReport& report) {
    const Vec3 size = report.box.size();
    std::string text = fmt::format(
        "{}, {}, {:.6g} x {:.6g} x {:.6g}, quality worst {:.3f} median {:.3f}, "
        "smallest dihedral angle {:.1f} degrees",
        counted(report.points, "node"), counted(report.tets, report.order == 2 ? "quadratic tet" : "linear tet"),
        size.x, size.y, size.z, report.worst_quality, report.median_quality, report.min_dihedral_deg);
    if (report.order == 2) text += fmt::format(", smallest J {:.3f}", report.worst_jacobian);
    for (const RegionReport& region : report.regions)
        text += fmt::format("\n  region \"{}\": {}, volume {:.6g}", region.name, counted(region.tets, "tet"),
                            region.volume);
    for (const std::string& note : report.notes) text += "\n  note: " + note;
    return text;
}

}  // namespace pliant::mesh

#include "mesh/mesh_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pliant::mesh {
namespace {

double quality(const TetMesh& mesh, std::size_t t) {
    const auto n = mesh.tet(t);
    double longest = 0;
    for (const auto& [a, b] : edge_corners) longest = std::max(longest, norm(mesh.points[n[a]] - mesh.points[n[b]]));
    const double volume = signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]);
    return longest > 0 ? 6 * std::sqrt(2.0) * volume / (longest * longest * longest) : 0;
}

}  // namespace

MeshReport report_on(const TetMesh& mesh) {
    MeshReport report;
    report.order = mesh.order;
    report.points = mesh.points.size();
    report.tets = mesh.tet_count();
    for (const Vec3& p : mesh.points) report.box.add(p);
    report.region_names = mesh.region_names;
    for (std::size_t r = 0; r < mesh.region_names.size(); ++r)
        report.region_volumes.push_back(volume(mesh, static_cast<int>(r)));
    std::vector<double> all;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) all.push_back(quality(mesh, t));
    std::sort(all.begin(), all.end());
    if (!all.empty()) {
        report.worst_quality = all.front();
        report.median_quality = all[all.size() / 2];
    }
    return report;
}

std::string report_text(const MeshReport& report) {
    const Vec3 size = report.box.size();
    std::string text = fmt::format("{} nodes, {} {} tets, {:.6g} x {:.6g} x {:.6g}, quality worst {:.3f} median {:.3f}",
                                   report.points, report.tets, report.order == 2 ? "quadratic" : "linear", size.x,
                                   size.y, size.z, report.worst_quality, report.median_quality);
    for (std::size_t r = 0; r < report.region_names.size(); ++r) {
        text += fmt::format("\n  region \"{}\": volume {:.6g}", report.region_names[r], report.region_volumes[r]);
    }
    return text;
}

}  // namespace pliant::mesh

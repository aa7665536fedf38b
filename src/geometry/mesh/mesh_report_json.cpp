#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "geometry/mesh/mesh_report.hpp"

namespace pliant::mesh {
namespace {

nlohmann::json numbers(const Vec3& v) {
    return {v.x, v.y, v.z};
}

}  // namespace

std::string report_json(const MeshReport& report, std::optional<double> unit_mm) {
    nlohmann::ordered_json out;
    out["order"] = report.order;
    out["nodes"] = report.points;
    out["tets"] = report.tets;
    out["low"] = numbers(report.box.low);
    out["high"] = numbers(report.box.high);
    if (unit_mm) {
        out["low_mm"] = numbers(*unit_mm * report.box.low);
        out["high_mm"] = numbers(*unit_mm * report.box.high);
    }
    out["quality"] = {{"worst", report.worst_quality},
                      {"worst_at", numbers(report.worst_at)},
                      {"median", report.median_quality},
                      {"counts", report.quality_counts}};
    out["dihedral_deg"] = {{"smallest", report.min_dihedral_deg},
                           {"largest", report.max_dihedral_deg},
                           {"counts", report.dihedral_counts}};
    out["smallest_J"] = report.worst_jacobian;
    if (unit_mm) out["quality"]["worst_at_mm"] = numbers(*unit_mm * report.worst_at);
    out["regions"] = nlohmann::json::array();
    for (const RegionReport& region : report.regions) {
        nlohmann::ordered_json one = {{"name", region.name}, {"tets", region.tets}, {"volume", region.volume}};
        if (unit_mm) one["volume_mm3"] = *unit_mm * *unit_mm * *unit_mm * region.volume;
        out["regions"].push_back(std::move(one));
    }
    out["notes"] = report.notes;
    return json_text(out, 2);
}

}  // namespace pliant::mesh

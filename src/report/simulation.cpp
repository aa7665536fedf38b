#include "report/simulation.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace pliant::report {
namespace {

Status check_mesh(const Simulation& s) {
    const std::size_t regions = s.mesh.region_names.size();
    if (s.mesh.tet_count() == 0) return input_error("report: the mesh has no tets");
    if (s.materials.empty()) return input_error("report: at least one material is needed");
    if (s.region_material.size() != regions) {
        return input_error("report: region_material has {} entries, the mesh {} regions", s.region_material.size(),
                           regions);
    }
    for (const int material : s.region_material) {
        if (material < -1 || material >= static_cast<int>(s.materials.size())) {
            return input_error("report: region_material names material {} of {}", material, s.materials.size());
        }
    }
    if (s.mesh.region.size() != s.mesh.tet_count()) {
        return input_error("report: {} tets have a region, the mesh has {}", s.mesh.region.size(), s.mesh.tet_count());
    }
    for (const int node : s.mesh.nodes) {
        if (node < 0 || static_cast<std::size_t>(node) >= s.mesh.points.size()) {
            return input_error("report: a tet names node {} of {}", node, s.mesh.points.size());
        }
    }
    for (const int region : s.mesh.region) {
        if (region < 0 || region >= static_cast<int>(regions)) {
            return input_error("report: a tet names region {} of {}", region, regions);
        }
    }
    return {};
}

Status check_step(const Simulation& s, std::size_t i) {
    const sim::Step& step = s.result.steps[i];
    const sim::Step& rest = s.result.steps.front();
    if (step.positions.size() != s.mesh.points.size()) {
        return input_error("report: step {} has {} positions, the mesh {} points", step.index, step.positions.size(),
                           s.mesh.points.size());
    }
    if (!std::all_of(step.positions.begin(), step.positions.end(), is_finite)) {
        return input_error("report: step {} has positions that are not numbers", step.index);
    }
    if (step.cables.size() != rest.cables.size() || step.chambers.size() != rest.chambers.size() ||
        step.supports.size() != rest.supports.size() || step.markers.size() != rest.markers.size()) {
        return input_error("report: step {} has other cables, chambers, supports or markers than the rest state",
                           step.index);
    }
    if (!rest.cables.empty() && s.cable_points[i].size() != rest.cables.size()) {
        return input_error("report: cable_points of step {} has {} cables of {}", step.index, s.cable_points[i].size(),
                           rest.cables.size());
    }
    return {};
}

}  // namespace

Status check(const Simulation& s) {
    if (Status status = check_mesh(s); !status) return status;
    if (s.result.steps.empty()) return input_error("report: the result has no rest state");
    if (!s.result.steps.front().cables.empty() && s.cable_points.size() != s.result.steps.size()) {
        return input_error("report: cable_points has {} steps of {}", s.cable_points.size(), s.result.steps.size());
    }
    for (std::size_t i = 0; i < s.result.steps.size(); ++i) {
        if (Status status = check_step(s, i); !status) return status;
    }
    if (!s.fields) return input_error("report: no function for the fields");
    return {};
}

Colour colour_of(const Simulation& simulation, int material) {
    const auto& colour = simulation.materials[static_cast<std::size_t>(material)].colour;
    return colour ? *colour : palette(material);
}

}  // namespace pliant::report

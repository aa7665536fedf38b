#include "presentation/report/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/core/error.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/simulate.hpp"

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
        step.supports.size() != rest.supports.size() || step.markers.size() != rest.markers.size() ||
        step.contacts.size() != rest.contacts.size()) {
        return input_error("report: step {} has other cables, chambers, supports, markers or obstacles than at rest",
                           step.index);
    }
    if (!rest.cables.empty() && s.cable_points[i].size() != rest.cables.size()) {
        return input_error("report: cable_points of step {} has {} cables of {}", step.index, s.cable_points[i].size(),
                           rest.cables.size());
    }
    return {};
}

Status check_obstacles(const Simulation& s) {
    for (const Obstacle& obstacle : s.obstacles) {
        const auto points = static_cast<int>(obstacle.surface.points.size());
        if (obstacle.offset_m.size() != s.result.steps.size()) {
            return input_error("report: obstacle \"{}\" has {} places, the result {} steps", obstacle.name,
                               obstacle.offset_m.size(), s.result.steps.size());
        }
        for (const auto& triangle : obstacle.surface.triangles) {
            if (std::any_of(triangle.begin(), triangle.end(), [&](int i) { return i < 0 || i >= points; })) {
                return input_error("report: a triangle of obstacle \"{}\" names a point that is not there",
                                   obstacle.name);
            }
        }
    }
    return {};
}

/// "neo-hookean, E 12 MPa, Poisson ratio 0.45": the law in the file, for people.
std::string law_text(const robot::MaterialSpec& material) {
    return fmt::format("{}, E {:.6g} MPa, Poisson ratio {:.4g}", material::name(material.law),
                       material.youngs_modulus_Pa / 1e6, material.poisson_ratio);
}

}  // namespace

Simulation simulation_of(const robot::Robot& robot, const sim::Model& model, const sim::Trajectory& trajectory) {
    Simulation simulation{.robot = robot.name, .mesh = model.mesh(), .result = trajectory};
    for (const robot::MaterialSpec& m : robot.materials) {
        Material material{m.name, law_text(m), m.resin, m.density_kg_m3, {}};
        if (m.colour) material.colour = Colour{(*m.colour)[0], (*m.colour)[1], (*m.colour)[2]};
        simulation.materials.push_back(std::move(material));
    }
    for (const robot::BodySpec& body : robot.bodies) simulation.region_material.push_back(body.material);
    simulation.region_material.resize(model.mesh().region_names.size(), -1);  // actuated space carries no material
    simulation.fields = [&model](std::span<const Vec3> positions) { return sim::compute_fields(model, positions); };
    for (const sim::Step& step : trajectory.steps)
        simulation.cable_points.push_back(sim::cable_points(model, step.positions));
    simulation.region_actuates = regions_that_actuate(model);
    simulation.obstacles = obstacles_of(model, trajectory);
    if (has_contact(trajectory))
        simulation.contact_pressure_Pa = [&model](const sim::Step& step) { return sim::contact_pressure(model, step); };
    simulation.tolerance = robot.program.tolerance;
    return simulation;
}

Status check(const Simulation& s) {
    if (Status status = check_mesh(s); !status) return status;
    if (s.result.steps.empty()) return input_error("report: the result has no rest state");
    if (!s.result.steps.front().cables.empty() && s.cable_points.size() != s.result.steps.size()) {
        return input_error("report: cable_points has {} steps of {}", s.cable_points.size(), s.result.steps.size());
    }
    for (std::size_t i = 0; i < s.result.steps.size(); ++i) {
        if (Status status = check_step(s, i); !status) return status;
    }
    if (!s.region_actuates.empty() && s.region_actuates.size() != s.mesh.region_names.size())
        return input_error("report: region_actuates has {} regions of {}", s.region_actuates.size(),
                           s.mesh.region_names.size());
    if (Status status = check_obstacles(s); !status) return status;
    if (!s.fields) return input_error("report: no function for the fields");
    return {};
}

bool has_contact(const sim::Trajectory& result) {
    return std::any_of(result.steps.begin(), result.steps.end(), [](const sim::Step& step) {
        return !step.contacts.empty() || step.self_contact_N > 0 || std::isfinite(step.smallest_distance_m);
    });
}

std::vector<bool> regions_that_actuate(const sim::Model& model) {
    const sim::Description& d = model.description();
    std::vector<bool> regions;
    for (const int material : d.material_of_region)
        regions.push_back(std::any_of(d.growths.begin(), d.growths.end(),
                                      [&](const sim::Growth& growth) { return growth.material == material; }));
    return regions;
}

Colour colour_of(const Simulation& simulation, int material) {
    const auto& colour = simulation.materials[static_cast<std::size_t>(material)].colour;
    return colour ? *colour : palette(material);
}

}  // namespace pliant::report

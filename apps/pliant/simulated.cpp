#include "simulated.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include "simulation/run/fields.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::app {
namespace {

double peak_memory_MB() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// "neo-hookean, E 12 MPa, Poisson ratio 0.45": what the file says, for people.
std::string law_text(const robot::MaterialSpec& material) {
    return fmt::format("{}, E {:.6g} MPa, Poisson ratio {:.4g}", material::name(material.law),
                       material.youngs_modulus_Pa / 1e6, material.poisson_ratio);
}

}  // namespace

report::Simulation describe(const robot::Robot& robot, const sim::Model& model, const sim::Trajectory& trajectory) {
    report::Simulation simulation{.robot = robot.name, .mesh = model.mesh(), .result = trajectory};
    for (const robot::MaterialSpec& m : robot.materials) {
        report::Material material{m.name, law_text(m), m.resin, m.density_kg_m3, {}};
        if (m.colour) material.colour = report::Colour{(*m.colour)[0], (*m.colour)[1], (*m.colour)[2]};
        simulation.materials.push_back(std::move(material));
    }
    for (const robot::BodySpec& body : robot.bodies) simulation.region_material.push_back(body.material);
    simulation.region_material.resize(model.mesh().region_names.size(), -1);  // actuated space carries no material
    simulation.fields = [&model](std::span<const Vec3> positions) { return sim::compute_fields(model, positions); };
    for (const sim::Step& step : trajectory.steps)
        simulation.cable_points.push_back(sim::cable_points(model, step.positions));
    simulation.region_actuates = report::regions_that_actuate(model);
    simulation.obstacles = report::obstacles_of(model, trajectory);
    if (report::has_contact(trajectory)) {
        simulation.contact_pressure_Pa = [&model](const sim::Step& step) { return sim::contact_pressure(model, step); };
    }
    simulation.tolerance = robot.program.tolerance;
    simulation.peak_memory_MB = peak_memory_MB();
    return simulation;
}

}  // namespace pliant::app

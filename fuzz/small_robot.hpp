// A robot that is solved in a moment.
#pragma once

#include "simulation/peers/reference_problems.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::fuzz {

/// A block of 2 x 1 x 1 cm, clamped at x = 0, with a cable along it.
inline sim::Description block() {
    using namespace sim;
    Description d;
    d.mesh = reference::kuhn_box({0.02, 0.01, 0.01}, 2, 1, 1, [](Vec3) { return 0; });
    d.materials = {{"A", material::neo_hookean(1e5, 0.4), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    Cable cable{"cable", {}, {}};
    for (const double x : {0.0, 0.01, 0.02})
        cable.points.push_back(reference::mean_of(
            reference::nodes_where(d.mesh, [x](Vec3 p) { return p.x > x - 1e-9 && p.x < x + 1e-9 && p.z > 0.005; })));
    cable.target.value = 0.95;
    d.cables.push_back(cable);
    return d;
}

struct SmallRobot {
    sim::Model model = sim::Model::create(block()).value();
    sim::Stepper stepper{model, {.iteration_limit = 3}};
};

}  // namespace pliant::fuzz

// A state and a step of a small block, as read from a file: the simulation can continue from whatever is accepted.
#include "input.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/step_record.hpp"
#include "simulation/stepper/state_file.hpp"

namespace {

using namespace pliant;
using namespace pliant::sim;

/// A block of 2 x 1 x 1 cm, clamped at x = 0, with a cable along it.
Description block() {
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

struct Small {
    Model model = Model::create(block()).value();
    Stepper stepper{model, {.iteration_limit = 3}};
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Small small;
    const std::string_view bytes = as_text(data, size);
    (void)step_from_bytes(bytes, small.model.mesh().points.size());
    auto robot = state_from_bytes(small.stepper, bytes);
    if (!robot) return 0;
    (void)state_bytes(small.model, *robot);
    Inputs wanted = robot->inputs;
    for (Drive& drive : wanted.drives) drive.value *= 0.999;
    (void)small.stepper.drive(*robot, wanted, Progress());
    return 0;
}

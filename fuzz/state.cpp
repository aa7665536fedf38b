// A state and a step of a small block, as read from a file: the simulation can continue from whatever is accepted.
#include "input.hpp"
#include "simulation/run/step_record.hpp"
#include "simulation/stepper/cbor_numbers.hpp"
#include "simulation/stepper/state_file.hpp"
#include "small_robot.hpp"

using namespace pliant;
using namespace pliant::sim;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static pliant::fuzz::SmallRobot small;
    const std::string_view bytes = as_text(data, size);
    (void)step_from_bytes(bytes, small.model.mesh().points.size());
    auto robot = state_from_bytes(small.stepper, cbor::sealed(std::string(bytes)));
    if (!robot) return 0;
    (void)state_bytes(small.model, *robot);
    Inputs wanted = robot->inputs;
    for (Drive& drive : wanted.drives) drive.value *= 0.999;
    (void)small.stepper.drive(*robot, wanted, Progress());
    return 0;
}

// A reduced model of a small block, as read from a file: whatever is accepted can be solved.
#include "input.hpp"
#include "simulation/reduced/error_estimate.hpp"
#include "simulation/reduced/reduced_solver.hpp"
#include "simulation/reduced/reduction_file.hpp"
#include "simulation/stepper/cbor_numbers.hpp"
#include "small_robot.hpp"

using namespace pliant;
using namespace pliant::sim;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static pliant::fuzz::SmallRobot small;
    auto reduction =
        reduced::reduction_from_bytes(small.model, cbor::sealed(std::string(as_text(data, size))), "block");
    if (!reduction) return 0;
    (void)reduced::reduction_bytes(*reduction, "block");
    const auto model = reduced::ReducedModel::create(small.model, std::move(*reduction));
    if (!model) return 0;
    reduced::ReducedSolver solver(*model);
    const Inputs wanted{1, {{Drive::Kind::measure, 0.0195}}};
    reduced::ReducedState state = solver.start(wanted);
    if (!solver.solve(state, wanted).found) return 0;
    reduced::ErrorEstimator estimator(*model, small.stepper);
    (void)estimator.estimate(state);
    return 0;
}

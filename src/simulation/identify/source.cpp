#include "simulation/identify/source.hpp"

#include <utility>

#include "simulation/scene/build_model.hpp"

namespace pliant::sim::identify {
namespace {

/// Derivatives are as accurate as the solution of the equations; a looser tolerance would add noise to what the search
/// compares.
constexpr double tolerance = 1e-8;

}  // namespace

Result<std::unique_ptr<Variant>> Source::with(std::span<const Unknown> unknowns, std::span<const double> values) const {
    std::vector<std::string> assignments;
    for (std::size_t k = 0; k < unknowns.size(); ++k) assignments.push_back(unknowns[k].assignment(values[k]));
    Result<robot::Robot> robot = read_(assignments);
    if (!robot) return tl::unexpected(robot.error());
    Result<sim::Model> model = robot::build_model(*robot, mesh_);
    if (!model) return tl::unexpected(model.error());
    robot::Program program = robot->program;
    using robot::Solver;
    if (program.solver == Solver::automatic || program.solver == Solver::newton)
        program.tolerance = std::min(program.tolerance, tolerance);
    return std::make_unique<Variant>(Variant{program, std::move(*model)});
}

}  // namespace pliant::sim::identify

#include "library/simulation/unfinished_run.hpp"

#include "simulation/run/checkpoint.hpp"

namespace pliant::library {

std::optional<int> unfinished_step(const Model::Data& model, const std::filesystem::path& folder) {
    const sim::Program& program = model.scene.robot.program;
    const auto kept = sim::Checkpoint::open(folder, model.robot->origin(), model.scene.model, program);
    if (!kept || kept->run.step == 0 || kept->run.step >= program.steps) return std::nullopt;
    return kept->run.step;
}

}  // namespace pliant::library

// Implementation data of an InverseResult.
#pragma once

#include <memory>

#include "library/simulation/data.hpp"
#include "pliant/inverse.hpp"
#include "presentation/report/inverse_tables.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant {

struct InverseResult::Data {
    std::shared_ptr<const Model::Data> model;
    sim::InverseTask task;
    sim::inverse::InverseResult result;
    std::vector<SteeredInput> inputs;
    std::shared_ptr<const sim::Equilibrium> system{};

    [[nodiscard]] report::InverseReport report() const {
        return {model->scene.robot.name, model->scene.model, task, result};
    }
};

}  // namespace pliant

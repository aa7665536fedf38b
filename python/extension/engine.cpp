#include "engine.hpp"

namespace pliant::python {

/// The first stepper is created at once, so that invalid options are reported immediately.
Engine::Engine(const Model& model, const StepOptions& options) : model_(model), options_(options) {
    idle_.push_back(std::make_unique<Stepper>(model_, options_));
}

std::unique_ptr<Stepper> Engine::take() {
    {
        const std::lock_guard lock(mutex_);
        if (!idle_.empty()) {
            std::unique_ptr<Stepper> stepper = std::move(idle_.back());
            idle_.pop_back();
            return stepper;
        }
    }
    return std::make_unique<Stepper>(model_, options_);
}

void Engine::give(std::unique_ptr<Stepper> stepper) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(stepper));
}

}  // namespace pliant::python

#include "engine.hpp"

namespace pliant::python {

Engine::Engine(const Model& model) : model_(model) {
    idle_.push_back(std::make_unique<Stepper>(model_));
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
    return std::make_unique<Stepper>(model_);
}

void Engine::give(std::unique_ptr<Stepper> stepper) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(stepper));
}

}  // namespace pliant::python

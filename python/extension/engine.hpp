// A pool of steppers for one model, shared by threads: any of them gives the same bits.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "pliant/simulation.hpp"

namespace pliant::python {

class Engine {
public:
    explicit Engine(const Model& model);

    [[nodiscard]] const Model& model() const { return model_; }
    /// Calls `use` with a stepper that nothing else uses meanwhile.
    template <class Use>
    auto with(const Use& use) {
        Borrowed borrowed(*this);
        return use(*borrowed.stepper);
    }

private:
    struct Borrowed {
        explicit Borrowed(Engine& from) : engine(from), stepper(from.take()) {}
        ~Borrowed() { engine.give(std::move(stepper)); }
        Borrowed(const Borrowed&) = delete;
        Borrowed& operator=(const Borrowed&) = delete;
        Engine& engine;
        std::unique_ptr<Stepper> stepper;
    };
    [[nodiscard]] std::unique_ptr<Stepper> take();
    void give(std::unique_ptr<Stepper> stepper);

    Model model_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Stepper>> idle_;
};

}  // namespace pliant::python

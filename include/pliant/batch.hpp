/// @file
/// Many robots, or many states of one, at the same time: one core for each.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// Calls `work(i)` for each i below `n`, on so many threads (0: one for each core). What is called keeps to its thread:
/// loops in it that use all cores elsewhere use one here, and give the same bits. The Watch is asked on the thread that
/// calls; once it asks for an end no more work is begun.
/// @throws Failure of kind `cancelled`; or what `work` throws, of the lowest i.
PLIANT_API void on_each_core(std::size_t n, const std::function<void(std::size_t)>& work, int threads = 0,
                             const Watch& watch = {});

/// Steppers side by side. Robots that are small are solved many at a time more quickly than one after the other on all
/// cores. The bits are those of a Stepper for each of them, on any number of threads.
class PLIANT_API Batch {
public:
    /// A stepper for each of the models, of which many may be the same.
    /// @throws Failure of the options.
    explicit Batch(const std::vector<Model>& models, const StepOptions& options = {}, int threads = 0);
    /// Moves it; the other one is of no use afterwards.
    Batch(Batch&&) noexcept;
    /// Moves it; the other one is of no use afterwards.
    Batch& operator=(Batch&&) noexcept;
    ~Batch();

    /// Robots.
    [[nodiscard]] std::size_t size() const;
    /// Threads that are used.
    [[nodiscard]] int threads() const;
    /// Stepper of one of them.
    /// @throws Failure where there is none of that index.
    [[nodiscard]] Stepper& stepper(std::size_t index);

    /// (robots) Stepper::rest of each.
    [[nodiscard]] std::vector<State> rest() const;
    /// (robots) Stepper::step of each: leaves the new states in `states`. A step that does not arrive says so in its
    /// result.
    /// @throws Failure of kind `input` where there are not as many states or inputs as robots, or as of Stepper::step:
    /// the message names the robot, and all states are as before; or of kind `cancelled`: each is then as far as it
    /// got.
    std::vector<StepResult> step(std::vector<State>& states, const std::vector<Inputs>& inputs,
                                 const Watch& watch = {});
    /// (robots) Stepper::observe of each.
    [[nodiscard]] std::vector<Observation> observe(const std::vector<State>& states);

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pliant

/// @file
/// Many robots, or many states of one robot, in parallel: one core for each.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// Calls `work(i)` for 0 <= i < n on the given number of threads (0: one per core), so that `work` must be safe to call
/// from several threads at once. Parallel loops inside `work` run on its thread alone and give the same bits. Once the
/// Watch asks to stop or `work` throws, no further work is started.
/// @throws Failure if the number of threads is negative, or when cancelled. If `work` throws, the exception with the
/// lowest i of those that were thrown.
PLIANT_API void on_each_core(std::size_t n, const std::function<void(std::size_t)>& work, int threads = 0,
                             const Watch& watch = {});

/// Several steppers in parallel. Small robots are solved faster side by side, one per core, than one after the other on
/// all cores. The results have the same bits as those of separate Steppers, on any number of threads.
class PLIANT_API Batch {
public:
    /// One stepper for each model; the same model may occur several times. `threads`: 0 for one per core; never more
    /// than there are models.
    /// @throws Failure if an option is out of range, or the number of threads is negative; or when cancelled.
    explicit Batch(const std::vector<Model>& models, const StepOptions& options = {}, int threads = 0,
                   const Watch& watch = {});
    /// Moves; the moved-from batch may only be assigned to or destroyed.
    Batch(Batch&&) noexcept;
    /// Moves; the moved-from batch may only be assigned to or destroyed.
    Batch& operator=(Batch&&) noexcept;
    ~Batch();

    /// Number of robots.
    [[nodiscard]] std::size_t size() const;
    /// Number of threads used.
    [[nodiscard]] int threads() const;
    /// The stepper of one robot.
    /// @throws Failure if the index is out of range.
    [[nodiscard]] Stepper& stepper(std::size_t index);

    /// (robots) Stepper::rest of each.
    [[nodiscard]] std::vector<State> rest() const;
    /// (robots) Stepper::step for each robot; stores the new states in `states`. Whether a step arrived is in its
    /// result.
    /// @throws Failure of kind `input` if the number of states or inputs differs from that of the robots, or as for
    /// Stepper::step: the message names the robot, and all states are unchanged; of kind `cancelled`: each state is
    /// then as far as its solver got.
    std::vector<StepResult> step(std::vector<State>& states, const std::vector<Inputs>& inputs,
                                 const Watch& watch = {});
    /// (robots) Stepper::observe of each.
    /// @throws Failure if the number of states differs from that of the robots, or as for Stepper::observe: the message
    /// names the robot.
    [[nodiscard]] std::vector<Observation> observe(const std::vector<State>& states);

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pliant

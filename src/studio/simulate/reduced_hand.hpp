// A reduced model of the robot with all its quadratic tets behind it, made in the background: it follows sliders at
// once, with numbers that are nearly those of the whole robot.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "robot/description/robot.hpp"
#include "simulation/parts/inverse_task.hpp"
#include "simulation/reduced/error_estimate.hpp"
#include "simulation/run/live.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::studio {

class ReducedHand {
public:
    /// Begins to make the model on a thread of its own, within the ranges of these inputs. `robot` and `model` must
    /// outlive it. Robots that cannot be reduced never become ready.
    ReducedHand(const robot::Robot& robot, const sim::Model& model, std::vector<sim::Steered> inputs, double size_m);
    /// Ends the work at once.
    ~ReducedHand();
    ReducedHand(const ReducedHand&) = delete;
    ReducedHand& operator=(const ReducedHand&) = delete;

    struct Shown {
        sim::Step step;
        double error_m = 0;  ///< estimated: largest error of a node
    };
    /// The state at a target. Empty: the model is not ready, a point of the body is pulled, the robot would pass
    /// through itself, or the estimate says that the error may be seen. Always called from the same thread.
    [[nodiscard]] std::optional<Shown> at(const sim::LiveTarget& target);

private:
    class Cancel;
    struct Ready;
    void make();

    const robot::Robot* robot_;
    const sim::Model* model_;
    std::vector<sim::Steered> inputs_;
    double size_m_;
    std::atomic<bool> stopping_ = false;
    std::mutex mutex_;
    std::unique_ptr<Ready> made_;   ///< guarded by mutex_
    std::unique_ptr<Ready> ready_;  ///< of the caller's thread
    std::thread thread_;
};

}  // namespace pliant::studio

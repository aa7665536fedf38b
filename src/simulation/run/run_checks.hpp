// What a run looks for beside equilibrium: jumps, unstable states, surfaces that have passed through each other, gaps
// that have closed.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/run/stability.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim {

/// What they have to remember from step to step.
struct ChecksState {
    Moment reported;                       ///< after the last step of the program
    double last_way = 0;                   ///< that this step took: norm of the motion of all nodes, m
    std::vector<std::size_t> before_jump;  ///< steps
    std::set<std::size_t> warned;          ///< cables
};

/// Both must outlive it.
class RunChecks {
public:
    RunChecks(Stepper& stepper, const Program& program, const RobotState& rest);

    /// Of a robot at rest at every instant, after each step: whether it jumped on the way. If the program says by how
    /// much to push it, it also goes on from where it is unstable to where it is stable.
    void after_step(RobotState& robot, Step& step, StepReport& report, std::vector<std::string>& warnings,
                    const Progress& progress);
    /// Gaps that have closed between two guide points: from here on the flanks would touch.
    void warn_of_closed_gaps(const RobotState& robot, int step, std::vector<std::string>& warnings);
    /// Whether surfaces have passed through each other: looked for in every 32nd step and the last, as a search takes
    /// half as long as a step, and from one in which they have back to the last in which they had not.
    void look_for_crossings(const RobotState& robot, std::vector<Step>& steps, bool last) const;
    /// At the end: what an equilibrium leaves open (left_open.hpp); whether the last state is stable, and those before a
    /// jump. Of the first that is not, the first step that was not is sought by halving; a look at every step would
    /// take as long as the steps.
    void at_end(const RobotState& robot, Trajectory& result);

    [[nodiscard]] const ChecksState& state() const { return state_; }
    void set_state(ChecksState state) { state_ = std::move(state); }

private:
    [[nodiscard]] State state_of(const Step& step) const;
    void warn_of_open_places(const RobotState& robot, Trajectory& result) const;
    [[nodiscard]] bool is_unstable(const RobotState& robot, const Step& step);
    [[nodiscard]] bool jumped(const RobotState& robot, const Progress& progress);
    [[nodiscard]] bool leave(RobotState& robot, const Eigen::VectorXd& motion, StepReport& report,
                             const Progress& progress);

    Stepper& stepper_;
    const Equilibrium& system_;
    const Program& program_;
    Stability stability_;
    ChecksState state_;
    double size_ = 0;  ///< of the robot at rest
};

/// What a program that stopped before `time` should do instead; empty if nothing is known.
[[nodiscard]] std::string advice(Stepper& stepper, const Program& program, const RobotState& robot, double time,
                                 const Progress& progress);

}  // namespace pliant::sim

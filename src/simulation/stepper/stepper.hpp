// Takes a robot from one state to the next: the one engine under programs, live robots and the library.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/parts/robot_names.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/solver_chain.hpp"
#include "simulation/stepper/motion_in_time.hpp"
#include "simulation/stepper/robot_state.hpp"

namespace pliant::sim {

struct StepperOptions {
    Solver solver = Solver::automatic;
    double tolerance = 1e-4;
    int iteration_limit = 0;                          ///< for one piece of a step; 0: the solver's own
    std::optional<Dynamics> dynamics = std::nullopt;  ///< none: at rest at every instant
    std::size_t most_past = RotatingStep::most_past;  ///< states that a prediction may look back on
    double time_unit = 1;                             ///< of the model's program: what usually goes in one step
};

/// Of a step of the program or to inputs: shorter pieces than this share are not tried where their error decides.
inline constexpr double smallest_adaptive_share = 1.0 / (1 << 20);

/// Where a step leads, and on which way: what is wanted at each place on it.
struct Way {
    double end = 0;  ///< how far the step goes; Moment::along says where it begins
    std::function<Controls(double along)> at;
    double shortest_piece = 0;        ///< shorter ones are not tried
    bool onward = true;               ///< it goes on as the last steps did, so that they tell where it leads
    const State* expected = nullptr;  ///< about what the state at its end will be; null: not known
    /// Called with every state that a step passes, its end too. May be empty.
    std::function<void(const RobotState&)> after_piece{};
};

/// What a step did.
struct StepReport {
    bool arrived = false;
    bool loose = false;  ///< a piece of it was accepted on looser terms than the tolerance: friction_rounds.hpp
    std::string reason;  ///< why it did not arrive, or on which terms
    int iterations = 0;
    int pieces = 0;                        ///< that were accepted
    int refused = 0;                       ///< that were solved, but for their error in time, or were not solved
    Solver solver = Solver::automatic;     ///< that finished the last of them
    std::vector<IterationRecord> history;  ///< `step` is not filled in
};

/// Not for two threads at once. The same state and the same way give the same bits, whatever was asked before.
class Stepper {
public:
    /// `model` must outlive it.
    Stepper(const Model& model, const StepperOptions& options);
    Stepper(const Stepper&) = delete;
    Stepper& operator=(const Stepper&) = delete;
    ~Stepper();

    /// Undeformed and, with dynamics, still; at the start of the model's program.
    [[nodiscard]] RobotState rest() const;
    /// What the program wants at `time` of a robot in this state.
    [[nodiscard]] Controls controls(const RobotState& robot, double time) const;
    /// The same as inputs.
    [[nodiscard]] Inputs program(double time) const;
    /// What these inputs want; without their force, which belongs to a point that they do not know.
    [[nodiscard]] Controls controls(const RobotState& robot, const Inputs& inputs) const;
    /// A drive of `kind` that keeps actuator `a` as it is.
    [[nodiscard]] Drive hold(const RobotState& robot, std::size_t a, Drive::Kind kind) const;
    /// Prepares a step from `robot.inputs` to `wanted` on a way from 0 to 1: true if it goes on, or back, along that of
    /// the last step, which then tells where it leads.
    [[nodiscard]] bool set_course(RobotState& robot, const Inputs& wanted) const;
    [[nodiscard]] const InputUnits& units() const { return units_; }

    /// Goes to the end of the way, halving what does not converge. Where it does not arrive `robot` is as far as it
    /// got. With dynamics `along` is time in seconds.
    [[nodiscard]] StepReport step(RobotState& robot, const Way& way, const Progress& progress);
    /// In one piece; `robot` keeps its positions where that does not converge.
    [[nodiscard]] StepReport leap(RobotState& robot, const Way& way, const Progress& progress);
    /// To equilibrium from `guess`, with `robot` standing still otherwise: on another branch of equilibria than that
    /// of the last steps, which are forgotten. Without convergence `robot` is as before.
    [[nodiscard]] StepReport settle_beside(RobotState& robot, State guess, const Progress& progress);
    /// To where the inputs are wanted, on a straight way from where they are, halving what does not converge; what is
    /// driven by another kind than before begins as it is. With
    /// dynamics the step takes the time until `wanted.time`, which must be later. Where it does not arrive `robot` and
    /// its inputs are as far as they got. `expected`: about what the state will be; null: not known.
    [[nodiscard]] StepReport drive(RobotState& robot, const Inputs& wanted, const Progress& progress,
                                   const State* expected = nullptr);
    /// An equilibrium at `controls` from `state`, as a trial. False: none was found, and `state` is of no use.
    [[nodiscard]] bool find(const Controls& controls, State& state, const Progress& progress);

    [[nodiscard]] double kinetic_energy_J(const RobotState& robot) const;
    /// What a step in time of `dt` from where `history` ends adds to the equations. Precondition: has_inertia().
    [[nodiscard]] std::shared_ptr<const Inertia> inertia(const History& history, double dt,
                                                         Scheme scheme = Scheme::even) const;
    /// Steps are as long as their error in time allows.
    [[nodiscard]] bool is_adaptive() const { return options_.dynamics && options_.dynamics->time_tolerance_m > 0; }
    /// In a motion in time and, as a tether, where something is held by nothing: see theory.md.
    [[nodiscard]] bool has_inertia() const { return motion_.has_value(); }
    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const Equilibrium& system() const { return system_; }
    [[nodiscard]] const FactoredLaplacian& laplacian() const { return laplacian_; }
    [[nodiscard]] const StepperOptions& options() const { return options_; }
    [[nodiscard]] SolverChain& solvers() { return solvers_; }

private:
    struct Target;
    [[nodiscard]] std::size_t steered() const;
    [[nodiscard]] StepOutcome go(RobotState& robot, const Target& target, StepReport& report, const Progress& progress);
    [[nodiscard]] StepOutcome attempt(const RobotState& robot, const Target& target, Scheme scheme, Controls& controls,
                                      State& next, const Progress& progress);
    [[nodiscard]] StepOutcome attempt_in_time(const RobotState& robot, const Target& target, Controls& controls,
                                              State& next, const Progress& progress);
    [[nodiscard]] bool chooses_scheme() const;
    [[nodiscard]] Scheme scheme(const RobotState& robot, const Controls& controls) const;
    void take_mean_inputs(const RobotState& robot, Controls& controls) const;
    [[nodiscard]] double time_error_m(const Controls& controls, const State& next) const;
    [[nodiscard]] StepReport step_by_error(RobotState& robot, const Way& way, const Progress& progress);
    [[nodiscard]] StepOutcome settle(const RobotState& from, Controls& controls, State& next, const Progress& progress,
                                     std::optional<Evaluation> known);
    void accept(RobotState& robot, const Target& target, Controls controls, State next, StepOutcome outcome);
    void recall(const RobotState& robot);
    void remember(RobotState& robot);

    const Model& model_;
    const StepperOptions options_;
    Equilibrium system_;
    FactoredLaplacian laplacian_;
    SolverChain solvers_;
    InputUnits units_;
    mutable std::optional<MotionInTime> motion_;  ///< keeps a pattern that it has made; of a tether too
    double tether_dt_s_ = 0;                    ///< above 0: at rest at every instant, and something is held by nothing
    std::shared_ptr<const SolverMemory> live_;  ///< what the solvers remember; null: nothing that a state has
};

}  // namespace pliant::sim

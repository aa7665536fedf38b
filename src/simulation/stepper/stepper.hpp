// Advances a robot from one state to the next: the common engine of programs, interactive robots and the library.
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
    int iteration_limit = 0;                          ///< for each piece of a step; 0: that of the solver
    std::optional<Dynamics> dynamics = std::nullopt;  ///< empty: quasi-static
    std::size_t most_past = RotatingStep::most_past;  ///< number of states that a prediction may use
    double time_unit = 1;                             ///< of the model's program: usually one step
};

/// For a step of the program or to inputs: smallest share of a step in adaptive time stepping.
inline constexpr double smallest_adaptive_share = 1.0 / (1 << 20);

/// The path of a step: the controls at each point of it.
struct StepPath {
    double end = 0;  ///< end of the step; Moment::along is its start
    std::function<Controls(double along)> at;
    double shortest_piece = 0;        ///< shortest piece that is tried
    bool onward = true;               ///< it continues the last steps, so that they can be extrapolated
    const State* expected = nullptr;  ///< approximate state at its end; null: unknown
    /// Called with every intermediate state of a step, including its end. May be empty.
    std::function<void(const RobotState&)> after_piece{};
    double longest_piece = 0;  ///< 0: the whole step
    int most_iterations = 0;   ///< of all pieces together, after which it has not arrived; 0: no such limit
};

/// Result of a step.
struct StepReport {
    bool arrived = false;
    bool loose = false;     ///< a piece was accepted at a looser tolerance: friction_rounds.hpp
    bool no_start = false;  ///< it did not arrive because the prescribed motion is impossible
    std::string reason;     ///< why it did not arrive, or at which tolerance
    int iterations = 0;
    int pieces = 0;                        ///< number of accepted pieces
    int refused = 0;                       ///< number of rejected pieces: too large an error in time, or not converged
    Solver solver = Solver::automatic;     ///< of the last piece
    std::vector<IterationRecord> history;  ///< `step` is not filled in
};

/// Not thread-safe. The same state and path give the same bits, whatever was solved before.
class Stepper {
public:
    /// `model` must outlive it.
    Stepper(const Model& model, const StepperOptions& options);
    Stepper(const Stepper&) = delete;
    Stepper& operator=(const Stepper&) = delete;
    ~Stepper();

    /// The rest state: undeformed and, with dynamics, with zero velocity; at the start of the model's program.
    [[nodiscard]] RobotState rest() const;
    /// The controls of the program at `time` for a robot in this state.
    [[nodiscard]] Controls controls(const RobotState& robot, double time) const;
    /// The same as inputs.
    [[nodiscard]] Inputs program(double time) const;
    /// The controls for these inputs; without their force, which belongs to a point that is not part of them.
    [[nodiscard]] Controls controls(const RobotState& robot, const Inputs& inputs) const;
    /// A drive of the given kind that keeps actuator `a` as it is.
    [[nodiscard]] Drive hold(const RobotState& robot, std::size_t a, Drive::Kind kind) const;
    /// Prepares a step from `robot.inputs` to `wanted` on a path from 0 to 1: true if it continues, or reverses, the
    /// path of the last step, which can then be extrapolated.
    [[nodiscard]] bool set_course(RobotState& robot, const Inputs& wanted) const;
    [[nodiscard]] const InputUnits& units() const { return units_; }

    /// Steps to the end of the path, halving pieces that do not converge. If it does not arrive, `robot` is as far as
    /// it got. With dynamics `along` is time in seconds.
    [[nodiscard]] StepReport step(RobotState& robot, const StepPath& path, const Progress& progress);
    /// In one piece; `robot` keeps its positions if that does not converge.
    [[nodiscard]] StepReport leap(RobotState& robot, const StepPath& path, const Progress& progress);
    /// Solves for equilibrium from `guess`, with everything else of `robot` unchanged: on another branch of equilibria
    /// than that of the last steps, which are forgotten. Without convergence `robot` is unchanged.
    [[nodiscard]] StepReport settle_beside(RobotState& robot, State guess, const Progress& progress);
    /// Steps to the wanted inputs on a straight path from the current ones, halving pieces that do not converge; an
    /// actuator driven by another kind than before starts from its current value. With dynamics the step takes the time
    /// until `wanted.time`, which must be later; at the same time, up to rounding, it arrives without a change of
    /// `robot` if the drives are the same too. If it does not arrive, `robot` and its inputs are as far as they got.
    /// `expected`: approximate final state; null: unknown. `after_piece` is told the share of the path that is done;
    /// may be empty. `most_iterations`: as in StepPath; not with an adapted step length.
    [[nodiscard]] StepReport drive(RobotState& robot, const Inputs& wanted, const Progress& progress,
                                   const State* expected = nullptr,
                                   const std::function<void(double share)>& after_piece = {}, int most_iterations = 0);
    /// True if two times differ by no more than rounding: a step in time so short would divide rounding errors by it.
    [[nodiscard]] bool is_same_time(double a, double b) const;
    /// Tries to find an equilibrium at `controls` from `state`. False: none was found, and `state` is unusable.
    [[nodiscard]] bool find(const Controls& controls, State& state, const Progress& progress);

    [[nodiscard]] double kinetic_energy_J(const RobotState& robot) const;
    /// The inertia of a step in time of `dt` from the end of `history`. Precondition: has_inertia().
    [[nodiscard]] std::shared_ptr<const Inertia> inertia(const History& history, double dt,
                                                         Scheme scheme = Scheme::even) const;
    /// True if the step length is adapted to the error in time.
    [[nodiscard]] bool is_adaptive() const { return options_.dynamics && options_.dynamics->time_tolerance_m > 0; }
    /// True for a motion in time and, through the tether, if something is not held: see theory.md.
    [[nodiscard]] bool has_inertia() const { return motion_.has_value(); }
    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const Equilibrium& system() const { return system_; }
    [[nodiscard]] const FactoredLaplacian& laplacian() const { return laplacian_; }
    [[nodiscard]] const StepperOptions& options() const { return options_; }
    [[nodiscard]] SolverChain& solvers() { return solvers_; }
    /// Frees the solvers' factors, which are most of the memory of a large robot; the next step makes them anew.
    void release();

private:
    struct Target;
    [[nodiscard]] std::size_t steered() const;
    [[nodiscard]] StepReport stay(const RobotState& robot, Inputs wanted) const;
    [[nodiscard]] StepOutcome go(RobotState& robot, const Target& target, StepReport& report, const Progress& progress);
    [[nodiscard]] StepOutcome attempt(const RobotState& robot, const Target& target, Scheme scheme, Controls& controls,
                                      State& next, const Progress& progress);
    /// `touching` receives History::touching of the end.
    [[nodiscard]] StepOutcome attempt_in_time(const RobotState& robot, const Target& target, Controls& controls,
                                              State& next, int& touching, const Progress& progress);
    [[nodiscard]] bool chooses_scheme() const;
    /// History::touching if a step ends at `next`: 1 if things touch there that do not at its start.
    [[nodiscard]] int touching_after(const RobotState& robot, const State& next, const Controls& controls) const;
    [[nodiscard]] Scheme scheme(const RobotState& robot, const Controls& controls) const;
    void take_mean_inputs(const RobotState& robot, Controls& controls) const;
    [[nodiscard]] double time_error_m(const Controls& controls, const State& next) const;
    /// For the end of a step with a tether that is not solved in pieces either.
    [[nodiscard]] bool ends_by_relaxing(RobotState& robot, const StepPath& path, StepReport& report,
                                        const Progress& progress);
    /// An approximate state at the end of such a step; nullopt: none was found.
    [[nodiscard]] std::optional<State> relax(const RobotState& robot, Controls controls, StepReport& report,
                                             const Progress& progress);
    [[nodiscard]] StepReport step_by_error(RobotState& robot, const StepPath& path, const Progress& progress);
    [[nodiscard]] StepOutcome settle(const RobotState& from, Controls& controls, State& next, const Progress& progress,
                                     std::optional<Evaluation> known, int iteration_limit);
    void settle_tether(const Controls& controls, State& next, const Progress& progress, StepOutcome& outcome);
    void accept(RobotState& robot, const Target& target, Controls controls, State next, int touching,
                StepOutcome outcome);
    void recall(const RobotState& robot);
    void remember(RobotState& robot);

    const Model& model_;
    const StepperOptions options_;
    Equilibrium system_;
    FactoredLaplacian laplacian_;
    SolverChain solvers_;
    InputUnits units_;
    mutable std::optional<MotionInTime> motion_;  ///< caches a pattern; also used for a tether
    double tether_dt_s_ = 0;                      ///< above 0: quasi-static, and something is not held
    std::shared_ptr<const SolverMemory> live_;    ///< current memory of the solvers; null: that of no state
};

}  // namespace pliant::sim

// Interactive control of a robot: it moves to any actuator targets in bounded increments, and every intermediate state
// is in equilibrium.
//
//     Live live(model, program);
//     LiveTarget target = live.target_at(0);
//     target.drives[0].value = 0.08;                  // a cable, 80 mm
//     while (!live.advance(target, progress).arrived) show(live.describe());
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/actuators/actuator.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/live_pull.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim {

/// The target of a robot. `time` (of the program) sets supports, loads, gravity and obstacles.
struct LiveTarget {
    double time = 0;
    std::vector<Drive> drives;  ///< (cables, then chambers)
    std::optional<Pull> pull = std::nullopt;
};

/// Result of one call of advance().
struct LiveProgress {
    bool moved = false;    ///< a new state was accepted; Step::converged tells at which tolerance
    bool arrived = false;  ///< the state has reached the target
    int iterations = 0;
    double wall_s = 0;
    std::string reason;  ///< why it is stuck, if it is
};

/// Quasi-static: inertia of a program's motion in time is ignored. Deterministic for equal sequences of calls.
class Live {
public:
    /// Starts at rest. `model` must outlive it.
    Live(const Model& model, const Program& program);
    ~Live();
    Live(Live&&) noexcept;
    Live& operator=(Live&&) noexcept;

    /// The target that the program prescribes at `time`.
    [[nodiscard]] LiveTarget target_at(double time) const;
    /// A drive of the given kind that keeps actuator `a` at its current state.
    [[nodiscard]] Drive hold(std::size_t a, Drive::Kind kind) const;

    /// One increment towards `target`, of a size adapted to recent success. Precondition: as many drives as cables and
    /// chambers; finite values; those that act through elements (Growth) are driven by their measure.
    [[nodiscard]] LiveProgress advance(const LiveTarget& target, const Progress& progress);
    void return_to_rest();

    /// The current state as a step of a trajectory.
    [[nodiscard]] Step describe() const;
    /// Reasons not to trust the current state, one sentence each; without those of warnings_at_rest().
    [[nodiscard]] std::vector<std::string> warnings(const Step& described) const;
    /// Force of the pull spring on the body; zero without one.
    [[nodiscard]] Vec3 pull_force_N() const;
    /// The stepper and the current state, for control by other means. A state that is set replaces the current one,
    /// without pull; `wall_s` is the time that it took to compute.
    [[nodiscard]] Stepper& stepper();
    [[nodiscard]] const RobotState& state() const;
    void set_state(RobotState state, double wall_s);
    /// (cables, then chambers) length or volume at rest.
    [[nodiscard]] std::vector<double> rest_measures() const;

private:
    class Walk;
    std::unique_ptr<Walk> walk_;
};

}  // namespace pliant::sim

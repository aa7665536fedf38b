// A robot that is steered by hand: wherever its actuators are wanted, it goes there in bounded pieces, and every state
// on the way is at equilibrium.
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

/// Where the robot is wanted. `time` (of the program) drives supports, loads, gravity and obstacles.
struct LiveTarget {
    double time = 0;
    std::vector<Drive> drives;  ///< (cables, then chambers)
    std::optional<Pull> pull = std::nullopt;
};

/// What one call of advance() did.
struct LiveProgress {
    bool moved =
        false;  ///< the state is another one than before, and was accepted: Step::converged says on which terms
    bool arrived = false;  ///< the state is that of the target
    int iterations = 0;
    double wall_s = 0;
    std::string reason;  ///< why it went no further, where it is stuck
};

/// Equilibrium at every instant; a program's motion in time is not followed. Deterministic for equal sequences of
/// calls.
class Live {
public:
    /// Starts at rest. `model` must outlive it.
    Live(const Model& model, const Program& program);
    ~Live();
    Live(Live&&) noexcept;
    Live& operator=(Live&&) noexcept;

    /// What the program asks for at `time`.
    [[nodiscard]] LiveTarget target_at(double time) const;
    /// A drive of `kind` that keeps actuator `a` as it is now.
    [[nodiscard]] Drive hold(std::size_t a, Drive::Kind kind) const;

    /// One piece of the way to `target`, as large as lately went well. Precondition: as many drives as cables and
    /// chambers; finite values; those that act through elements (Growth) are driven by their measure.
    [[nodiscard]] LiveProgress advance(const LiveTarget& target, const Progress& progress);
    void return_to_rest();

    /// The state at hand as a step of a trajectory.
    [[nodiscard]] Step describe() const;
    /// What should not be trusted about the state at hand, a sentence each; what warnings_at_rest() says is left out.
    [[nodiscard]] std::vector<std::string> warnings(const Step& described) const;
    /// Force of the spring on the body; zero without one.
    [[nodiscard]] Vec3 pull_force_N() const;
    /// Its engine and its state, for those who lead it otherwise. A state that is set takes the place of the one at
    /// hand, nothing pulls at it, and it took `wall_s` to come there.
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

// An interactively controlled model: its target, in the page's units, and the motion towards it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robot/description/robot.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/run/live.hpp"
#include "studio/requests/message.hpp"
#include "studio/simulate/led_marker.hpp"

namespace pliant::studio {

/// A point of the body that the user pulls.
struct Pulled {
    int vertex = 0;  ///< of the page's surface mesh
    Vec3 rest_m;
    Vec3 to_m;
};

class LiveRobot {
public:
    /// At rest. `robot` and `model` must outlive it; `size_m` is the size of the robot.
    LiveRobot(const robot::Robot& robot, const sim::Model& model, double size_m);
    LiveRobot(const LiveRobot&) = delete;
    LiveRobot& operator=(const LiveRobot&) = delete;

    void to_rest();
    /// Sets everything to the program at `time`.
    void follow(double time);
    /// False for impossible values: unknown names and kinds, negative lengths.
    [[nodiscard]] bool can_be(const ActuatorValue& value) const;
    /// Sets loads and supports to the program at `time`, and these actuators to the requested values; all others keep
    /// their targets. Impossible values are skipped.
    void drive(double time, const std::vector<ActuatorValue>& actuators);
    void pull(const std::optional<Pulled>& pulled);
    /// Drags a marker to the wanted position. False, without effect, if there is no such marker or no actuator.
    bool lead(const LeadMessage& message);
    [[nodiscard]] bool is_led() const { return led_.has_value(); }
    /// Ends dragging; the targets before it apply again.
    void stop_leading() { led_.reset(); }
    /// Ends all interaction; everything stays where it was dragged to.
    void let_go();

    /// One increment of the motion.
    [[nodiscard]] sim::LiveProgress advance(const Progress& progress);

    [[nodiscard]] const sim::Model& model() const { return *model_; }
    [[nodiscard]] const sim::Live& live() const { return live_; }
    [[nodiscard]] const sim::LiveTarget& target() const { return target_; }
    /// Manually set targets; empty: everything follows the program.
    [[nodiscard]] const std::vector<ActuatorValue>& driven() const { return driven_; }
    [[nodiscard]] const std::optional<LedMarker>& led() const { return led_; }
    [[nodiscard]] int pulled_vertex() const { return pulled_vertex_; }

private:
    const robot::Robot* robot_;
    const sim::Model* model_;
    double size_m_;
    sim::Live live_;
    sim::Attacher attacher_;
    sim::LiveTarget target_;
    std::optional<LedMarker> led_;  ///< the dragged marker
    Vec3 led_to_m_;
    std::vector<ActuatorValue> driven_;
    int pulled_vertex_ = -1;
};

}  // namespace pliant::studio

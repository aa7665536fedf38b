// A model in somebody's hand: where a page wants it, in the page's units, and its way there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "presentation/studio/led_marker.hpp"
#include "presentation/studio/message.hpp"
#include "robot/description/robot.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/run/live.hpp"

namespace pliant::studio {

/// A point of the body that a hand pulls at.
struct Pulled {
    int vertex = 0;  ///< of the page's surface
    Vec3 rest_m;
    Vec3 to_m;
};

class LiveRobot {
public:
    /// At rest. `robot` and `model` must outlive it; `size_m` is how large the robot is.
    LiveRobot(const robot::Robot& robot, const sim::Model& model, double size_m);
    LiveRobot(const LiveRobot&) = delete;
    LiveRobot& operator=(const LiveRobot&) = delete;

    void to_rest();
    /// All of it where the program has it at `time`.
    void follow(double time);
    /// False for what cannot be: strange names and kinds, a length below nothing.
    [[nodiscard]] bool can_be(const ActuatorValue& value) const;
    /// Loads and supports where the program has them at `time`, these actuators where they are asked for, all others as
    /// they are wanted already. What cannot be is left out.
    void drive(double time, const std::vector<ActuatorValue>& actuators);
    void pull(const std::optional<Pulled>& pulled);
    /// Brings a marker to where it is wanted. False, and nothing happens, if there is no such marker or no actuator.
    bool lead(const LeadMessage& message);
    [[nodiscard]] bool is_led() const { return led_.has_value(); }
    /// Nobody leads it any more; what it is driven by stays as it was wanted before.
    void stop_leading() { led_.reset(); }
    /// Everything stays where the hand has led it.
    void let_go();

    /// A piece of the way.
    [[nodiscard]] sim::LiveProgress advance(const Progress& progress);

    [[nodiscard]] const sim::Model& model() const { return *model_; }
    [[nodiscard]] const sim::Live& live() const { return live_; }
    [[nodiscard]] const sim::LiveTarget& target() const { return target_; }
    /// What the target has by hand; empty: all of it follows the program.
    [[nodiscard]] const std::vector<ActuatorValue>& driven() const { return driven_; }
    [[nodiscard]] const std::optional<LedMarker>& led() const { return led_; }
    [[nodiscard]] int pulled_vertex() const { return pulled_vertex_; }

private:
    struct ActuatorDrive {
        std::size_t actuator = 0;
        sim::Drive drive;
    };
    /// Nothing for what cannot be.
    [[nodiscard]] std::optional<ActuatorDrive> drive_of(const ActuatorValue& value) const;
    [[nodiscard]] std::optional<ActuatorDrive> cable_drive(std::size_t cable, const ActuatorValue& value) const;
    [[nodiscard]] std::optional<ActuatorDrive> chamber_drive(std::size_t chamber, const ActuatorValue& value) const;

    const robot::Robot* robot_;
    const sim::Model* model_;
    double size_m_;
    sim::Live live_;
    sim::Attacher attacher_;
    sim::LiveTarget target_;
    std::optional<LedMarker> led_;  ///< a marker in somebody's hand
    Vec3 led_to_m_;
    std::vector<ActuatorValue> driven_;
    int pulled_vertex_ = -1;
};

}  // namespace pliant::studio

// A marker that the page leads: the actuators follow, and the page is told what they do and what stops them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "presentation/studio/message.hpp"
#include "robot/description/robot.hpp"
#include "simulation/inverse/marker_drag.hpp"
#include "simulation/run/live.hpp"

namespace pliant::studio {

/// The actuators that may follow: those that have a range in the file; where none has one, all, as far as their sliders
/// go. Empty: the robot has none.
[[nodiscard]] std::vector<sim::Steered> led_inputs(const robot::Robot& robot, const sim::Model& model,
                                                   const std::vector<double>& rest_measures);

class LedMarker {
public:
    /// `live` must outlive it, and stay where it is. Preconditions: at least one input, a marker of the model.
    LedMarker(sim::Live& live, const sim::Model& model, std::vector<sim::Steered> inputs, std::size_t marker);

    [[nodiscard]] std::size_t marker() const { return drag_.marker(); }
    /// A piece of the way to where it is wanted.
    [[nodiscard]] sim::LiveProgress lead(const Vec3& wanted_m, const Progress& progress);
    /// What the actuators are now, as a page would have asked for it.
    [[nodiscard]] std::vector<ActuatorValue> actuators() const;
    /// JSON: {"marker": "tip", "to_mm": [x, y, z], "settled": true, "reached": false, "error_mm": 1.2, "limits": [...]}
    [[nodiscard]] std::string json() const;

private:
    sim::Live* live_;
    const sim::Model* model_;
    sim::inverse::MarkerDrag drag_;
    Vec3 wanted_m_;
    sim::inverse::Led led_;
};

}  // namespace pliant::studio

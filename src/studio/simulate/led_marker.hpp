// A marker dragged on the page: the actuators follow, and the page is told their values and what limits them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robot/description/robot.hpp"
#include "simulation/inverse/marker_drag.hpp"
#include "simulation/run/live.hpp"
#include "studio/requests/message.hpp"

namespace pliant::studio {

/// The actuators that may follow: those that have a range in the file; if none has one, all, within the range of their
/// sliders. Empty: the robot has none.
[[nodiscard]] std::vector<sim::Steered> led_inputs(const robot::Robot& robot, const sim::Model& model,
                                                   const std::vector<double>& rest_measures);

class LedMarker {
public:
    /// `live` must outlive it, and not be moved. Preconditions: at least one input, a marker of the model.
    LedMarker(sim::Live& live, const sim::Model& model, std::vector<sim::Steered> inputs, std::size_t marker);

    [[nodiscard]] std::size_t marker() const { return drag_.marker(); }
    /// One increment towards the wanted position.
    [[nodiscard]] sim::LiveProgress lead(const Vec3& wanted_m, const Progress& progress);
    /// The current actuator values, in the format of a page's request.
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

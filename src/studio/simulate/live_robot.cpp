#include "studio/simulate/live_robot.hpp"

#include <algorithm>

#include "presentation/report/units.hpp"
#include "studio/simulate/actuator_drive.hpp"

namespace pliant::studio {
namespace {

constexpr double patch_share = 0.04;  // of the robot's size: radius of the pulled patch

}  // namespace

LiveRobot::LiveRobot(const robot::Robot& robot, const sim::Model& model, double size_m)
    : robot_(&robot),
      model_(&model),
      size_m_(size_m),
      live_(model, robot.program),
      attacher_(model.mesh()),
      target_(live_.target_at(0)) {}

void LiveRobot::to_rest() {
    led_.reset();
    live_.return_to_rest();
    target_ = live_.target_at(0);
    driven_.clear();
    pulled_vertex_ = -1;
}

void LiveRobot::follow(double time) {
    sim::LiveTarget there = live_.target_at(std::min(time, robot_->program.duration));
    target_.time = there.time;
    target_.drives = std::move(there.drives);
    driven_.clear();
}

void LiveRobot::drive(double time, const std::vector<ActuatorValue>& actuators) {
    driven_.clear();
    target_.time = std::min(time, robot_->program.duration);
    for (const ActuatorValue& value : actuators) {
        const Result<ActuatorDrive> wanted = drive_of(*model_, live_.rest_measures(), value);
        if (!wanted) continue;
        target_.drives[wanted->actuator] = wanted->drive;
        driven_.push_back(value);
    }
}

bool LiveRobot::lead(const LeadMessage& message) {
    const auto& markers = model_->description().markers;
    const auto named = [&](const sim::Marker& marker) { return marker.name == message.marker; };
    const auto marker = static_cast<std::size_t>(std::ranges::find_if(markers, named) - markers.begin());
    if (marker == markers.size()) return false;
    if (!led_ || led_->marker() != marker) {
        auto inputs = led_inputs(*robot_, *model_, live_.rest_measures());
        if (inputs.empty()) return false;
        led_.emplace(live_, *model_, std::move(inputs), marker);
    }
    led_to_m_ = 1 / report::mm_per_m * Vec3{message.to_mm[0], message.to_mm[1], message.to_mm[2]};
    return true;
}

void LiveRobot::let_go() {
    driven_ = led_->actuators();
    led_.reset();
    target_.time = live_.state().inputs.time;
    target_.drives = live_.state().inputs.drives;
    target_.pull.reset();
}

void LiveRobot::pull(const std::optional<Pulled>& pulled) {
    if (!pulled) {
        target_.pull.reset();
        pulled_vertex_ = -1;
        return;
    }
    if (target_.pull && pulled_vertex_ == pulled->vertex) {
        target_.pull->handle_m = pulled->to_m;
        return;
    }
    Result<sim::Attachment> patch = attacher_.spread(pulled->rest_m, patch_share * size_m_, 1e-3 * size_m_);
    if (!patch) patch = attacher_.carried_by_tet(pulled->rest_m, size_m_);
    if (!patch) return;
    pulled_vertex_ = pulled->vertex;
    target_.pull = sim::Pull{std::move(*patch), pulled->to_m};
}

sim::LiveProgress LiveRobot::advance(const Progress& progress) {
    if (!led_) return live_.advance(target_, progress);
    sim::LiveProgress done = led_->lead(led_to_m_, progress);
    driven_ = led_->actuators();
    return done;
}

bool LiveRobot::can_be(const ActuatorValue& value) const {
    return drive_of(*model_, live_.rest_measures(), value).has_value();
}

}  // namespace pliant::studio

#include "presentation/studio/live_robot.hpp"

#include <algorithm>

namespace pliant::studio {
namespace {

constexpr double mm = 1e3;
constexpr double patch_share = 0.04;  // of the robot's size: what a hand takes hold of

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
        if (set_actuator(value)) driven_.push_back(value);
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
    led_to_m_ = 1 / mm * Vec3{message.to_mm[0], message.to_mm[1], message.to_mm[2]};
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

bool LiveRobot::set_actuator(const ActuatorValue& value) {
    using Kind = sim::Drive::Kind;
    const sim::Description& d = model_->description();
    const std::vector<double> rest = live_.rest_measures();
    const double v = value.value;
    bool possible = false;
    // The thesis' elements know lengths and volumes only.
    const auto by_elements = [&](std::size_t a) {
        return std::any_of(d.growths.begin(), d.growths.end(),
                           [&](const sim::Growth& growth) { return growth.actuator == static_cast<int>(a); });
    };
    const auto set = [&](sim::Drive& drive, const char* kind, bool can_be, const sim::Drive& next) {
        if (value.kind != kind || !can_be) return;
        drive = next;
        possible = true;
    };
    for (std::size_t c = 0; c < d.cables.size(); ++c) {
        if (d.cables[c].name != value.name) continue;
        sim::Drive& drive = target_.drives[c];
        set(drive, "length_ratio", v > 0, {Kind::measure, v * rest[c]});
        set(drive, "shortening_mm", v / mm < rest[c], {Kind::measure, rest[c] - v / mm});
        set(drive, "tension_N", !by_elements(c), {Kind::multiplier, std::max(v, 0.0)});
    }
    for (std::size_t k = 0; k < d.chambers.size(); ++k) {
        if (d.chambers[k].name != value.name) continue;
        const std::size_t a = d.cables.size() + k;
        sim::Drive& drive = target_.drives[a];
        set(drive, "volume_ratio", v > 0, {Kind::measure, v * rest[a]});
        set(drive, "volume_change_mm3", rest[a] + 1e-9 * v > 0, {Kind::measure, rest[a] + 1e-9 * v});
        set(drive, "pressure_kPa", !by_elements(a), {Kind::multiplier, 0 - 1e3 * v});
        set(drive, "gas_ratio", v > 0 && !by_elements(a), {Kind::gas, v * d.ambient_pressure_Pa * rest[a]});
    }
    return possible;
}

}  // namespace pliant::studio

#include "presentation/studio/live_robot.hpp"

#include <algorithm>

#include "presentation/studio/millimetres.hpp"

namespace pliant::studio {
namespace {

constexpr double patch_share = 0.04;  // of the robot's size: radius of the pulled patch

/// The thesis' elements support lengths and volumes only.
bool is_by_elements(const sim::Model& model, std::size_t actuator) {
    return std::ranges::any_of(model.description().growths, [&](const sim::Growth& growth) {
        return growth.actuator == static_cast<int>(actuator);
    });
}

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
        const std::optional<ActuatorDrive> wanted = drive_of(value);
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
    led_to_m_ = 1 / mm_per_m * Vec3{message.to_mm[0], message.to_mm[1], message.to_mm[2]};
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
    return drive_of(value).has_value();
}

std::optional<LiveRobot::ActuatorDrive> LiveRobot::drive_of(const ActuatorValue& value) const {
    const sim::Description& d = model_->description();
    const auto named = [&](const auto& actuator) { return actuator.name == value.name; };
    if (const auto cable = std::ranges::find_if(d.cables, named); cable != d.cables.end())
        return cable_drive(static_cast<std::size_t>(cable - d.cables.begin()), value);
    if (const auto chamber = std::ranges::find_if(d.chambers, named); chamber != d.chambers.end())
        return chamber_drive(static_cast<std::size_t>(chamber - d.chambers.begin()), value);
    return std::nullopt;
}

std::optional<LiveRobot::ActuatorDrive> LiveRobot::cable_drive(std::size_t cable, const ActuatorValue& value) const {
    using Kind = sim::Drive::Kind;
    const double rest = live_.rest_measures()[cable], v = value.value;
    const auto drive = [&](Kind kind, double target) { return ActuatorDrive{cable, {kind, target}}; };
    if (value.kind == "length_ratio" && v > 0) return drive(Kind::measure, v * rest);
    if (value.kind == "shortening_mm" && v / mm_per_m < rest) return drive(Kind::measure, rest - v / mm_per_m);
    if (value.kind == "tension_N" && !is_by_elements(*model_, cable)) return drive(Kind::multiplier, std::max(v, 0.0));
    return std::nullopt;
}

std::optional<LiveRobot::ActuatorDrive> LiveRobot::chamber_drive(std::size_t chamber,
                                                                 const ActuatorValue& value) const {
    using Kind = sim::Drive::Kind;
    const sim::Description& d = model_->description();
    const std::size_t a = d.cables.size() + chamber;
    const double rest = live_.rest_measures()[a], v = value.value;
    const bool by_elements = is_by_elements(*model_, a);
    const auto drive = [&](Kind kind, double target) { return ActuatorDrive{a, {kind, target}}; };
    if (value.kind == "volume_ratio" && v > 0) return drive(Kind::measure, v * rest);
    if (value.kind == "volume_change_mm3" && rest + 1e-9 * v > 0) return drive(Kind::measure, rest + 1e-9 * v);
    if (value.kind == "pressure_kPa" && !by_elements) return drive(Kind::multiplier, 0 - 1e3 * v);
    if (value.kind == "gas_ratio" && v > 0 && !by_elements) return drive(Kind::gas, v * d.ambient_pressure_Pa * rest);
    return std::nullopt;
}

}  // namespace pliant::studio

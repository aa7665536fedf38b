#include "studio/simulate/led_marker.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/core/stopwatch.hpp"
#include "presentation/scene/actuator_kind.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/scene/build_goals.hpp"
#include "studio/base/dumped.hpp"

namespace pliant::studio {
namespace {

using sim::CableTarget;
using sim::ChamberTarget;

/// The range of the page's sliders.
std::pair<double, double> usual_range(const CableTarget& target, double rest_m) {
    switch (target.kind) {
        case CableTarget::Kind::shortening_m:
            return {0, std::max(0.5 * rest_m, target.value)};
        case CableTarget::Kind::tension_N:
            return {0, std::max(10.0, 1.5 * target.value)};
        case CableTarget::Kind::length_ratio:
            break;
    }
    return {std::min(0.5, target.value - 0.1), 1};
}

std::pair<double, double> usual_range(const ChamberTarget& target, double rest_m3) {
    switch (target.kind) {
        case ChamberTarget::Kind::volume_change_m3:
            return {std::min(-0.1 * rest_m3, target.value), std::max(0.5 * rest_m3, target.value)};
        case ChamberTarget::Kind::pressure_Pa:
            return {std::min(0.0, target.value), std::max(20e3, 1.5 * target.value)};
        case ChamberTarget::Kind::gas_ratio:
            return {std::min(0.8, target.value), std::max(2.0, target.value)};
        case ChamberTarget::Kind::volume_ratio:
            break;
    }
    return {std::min(0.9, target.value), std::max(1.5, 1 + 1.5 * (target.value - 1))};
}

}  // namespace

std::vector<sim::Steered> led_inputs(const robot::Robot& robot, const sim::Model& model,
                                     const std::vector<double>& rest_measures) {
    if (auto task = robot::build_goals(robot, model, false)) return std::move(task->inputs);
    const sim::Description& d = model.description();
    std::vector<sim::Steered> inputs;
    for (std::size_t c = 0; c < d.cables.size(); ++c) {
        const CableTarget& target = d.cables[c].target;
        const auto [low, high] = usual_range(target, rest_measures[c]);
        inputs.push_back(
            {c, d.cables[c].name, low, high, target.kind == CableTarget::Kind::length_ratio ? 1.0 : 0.0, {}, 0, 0});
    }
    for (std::size_t k = 0; k < d.chambers.size(); ++k) {
        const ChamberTarget& target = d.chambers[k].target;
        const std::size_t a = d.cables.size() + k;
        const auto [low, high] = usual_range(target, rest_measures[a]);
        const bool ratio =
            target.kind == ChamberTarget::Kind::volume_ratio || target.kind == ChamberTarget::Kind::gas_ratio;
        inputs.push_back({a, d.chambers[k].name, low, high, ratio ? 1.0 : 0.0, {}, 0, 0});
    }
    return inputs;
}

LedMarker::LedMarker(sim::Live& live, const sim::Model& model, std::vector<sim::Steered> inputs, std::size_t marker)
    : live_(&live), model_(&model), drag_(live.stepper(), std::move(inputs), marker) {}

sim::LiveProgress LedMarker::lead(const Vec3& wanted_m, const Progress& progress) {
    Stopwatch watch;
    wanted_m_ = wanted_m;
    sim::RobotState robot = live_->state();
    led_ = drag_.lead(robot, wanted_m, progress);
    sim::LiveProgress done;
    done.moved = true;
    done.arrived = led_.settled;
    done.wall_s = watch.read_s();
    live_->set_state(std::move(robot), done.wall_s);
    return done;
}

std::vector<ActuatorValue> LedMarker::actuators() const {
    const sim::Description& d = model_->description();
    const std::vector<double> values = drag_.values(live_->state());
    std::vector<ActuatorValue> out;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const sim::Steered& input = drag_.inputs()[i];
        const view::ActuatorKind kind = view::kind_of(d, input.actuator);
        out.push_back({input.name, kind.name, kind.per_unit * values[i]});
    }
    return out;
}

std::string LedMarker::json() const {
    nlohmann::json limits = nlohmann::json::array();
    for (const sim::inverse::Limit& limit : led_.limits) limits.push_back(text(limit));
    const nlohmann::json json = {{"marker", model_->description().markers[marker()].name},
                                 {"to_mm", {1e3 * wanted_m_.x, 1e3 * wanted_m_.y, 1e3 * wanted_m_.z}},
                                 {"settled", led_.settled},
                                 {"reached", led_.reached},
                                 {"error_mm", 1e3 * led_.error_m},
                                 {"limits", limits}};
    return dumped(json);
}

}  // namespace pliant::studio

#include "printing/plan/passage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "printing/machine/motion.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Position;
using machine::Printer;
using machine::Store;

// Feed rates are written in tenths of a millimetre per minute, dwells in whole milliseconds.
constexpr double speed_tolerance = 0.02;
constexpr double share_tolerance = 0.005;
constexpr double time_tolerance_s = 0.005;
// Cleaning by other programs may last longer than required, but not so long that the part swells.
constexpr double most_cleaning_share = 1.5;
constexpr double most_cleaning_more_s = 10;
constexpr int many_strokes = 1000;  // the planner makes at most this many, and rests afterwards

bool enough(double seconds, double asked_s) {
    return seconds >= asked_s * (1 - share_tolerance) - time_tolerance_s;
}

/// Speed of one axis during the move.
double axis_mm_s(const machine::Profile& profile, const Step& step, Axis axis) {
    if (!(profile.length_mm > 0)) return 0;
    return profile.speed_mm_s * std::abs(step.to[axis] - step.from[axis]) / 1000.0 / profile.length_mm;
}

Axis stroke_axis(const Printer& p) {
    return p.has_carriage() ? Axis::carriage : Axis::platform;
}

/// The speed that the stroke axis can reach in this move, at most the cleaning speed.
double stroke_mm_s(const Printer& p, const Step& step) {
    const Axis lead = stroke_axis(p);
    const machine::Profile fastest = machine::profile(p, step.from, step.to, 0);
    return std::min(p.cleaning.speed_mm_s, axis_mm_s(fastest, step, lead));
}

int way_um(const Step& step, Axis axis) {
    return std::abs(step.to[axis] - step.from[axis]);
}

}  // namespace

void Passage::restart(int z_um) {
    std::vector<bool> fans = std::move(fan_on_);
    *this = Passage(*printer_);
    fan_on_ = std::move(fans);
    light_um_ = z_um;
}

bool Passage::fans_run() const {
    return std::find(fan_on_.begin(), fan_on_.end(), true) != fan_on_.end();
}

void Passage::add(const Step& step) {
    if (step.command == nullptr) return;
    for (std::size_t f = 0; f < fan_on_.size(); ++f) {
        if (const auto on = machine::switched(printer_->fans[f], *step.command)) fan_on_[f] = *on;
    }
    if (step.from != step.to) {
        add_move(step);
    } else {
        rest_s_ += step.seconds;
        if (!moved_) rest_after_light_s_ += step.seconds;
    }
    add_cleaning(step);
    const bool all_fans = std::find(fan_on_.begin(), fan_on_.end(), false) == fan_on_.end();
    if (all_fans && !cleans(step)) dried_s_ += step.seconds;
}

void Passage::add_move(const Step& step) {
    moved_ = true;
    rest_s_ = 0;
    top_um_ = std::max(top_um_, step.to[Axis::platform]);
    if (step.from[Axis::platform] == light_um_ && step.to[Axis::platform] == light_um_)
        sheared_um_ = std::max(sheared_um_, step.to[Axis::carriage] - printer_->carriage.print_um);
    brush_.move(step.from, step.to, step.machine->part_height_um());
    if (step.machine->vat_under_platform() && step.from[Axis::platform] != step.to[Axis::platform])
        add_vat_move(step,
                     axis_mm_s(machine::profile(*printer_, step.from, step.to, step.feed_mm_s), step, Axis::platform));
}

void Passage::add_vat_move(const Step& step, double platform_mm_s) {
    const machine::Platform& platform = printer_->platform;
    const int from_um = step.from[Axis::platform], to_um = step.to[Axis::platform];
    const auto faster = [&](double limit) { return limit > 0 && platform_mm_s > limit * (1 + speed_tolerance); };
    if (to_um < from_um && faster(platform.approach_speed_mm_s)) {
        fast_down_to_um_ = went_down_fast_ ? std::min(fast_down_to_um_, to_um) : to_um;
        went_down_fast_ = true;
    }
    if (to_um > from_um && faster(platform.lift_speed_mm_s)) {
        fast_up_from_um_ = went_up_fast_ ? std::min(fast_up_from_um_, from_um) : from_um;
        went_up_fast_ = true;
    }
}

/// The part is at its cleaning position, and the pump, if any, runs.
bool Passage::cleans(const Step& step) const {
    if (!printer_->pump.on.empty() && !step.machine->pump_runs()) return false;
    if (!step.machine->over_drain(step.from) || !step.machine->over_drain(step.to)) return false;
    if (printer_->store() != Store::table) return true;
    const int deepest_um = step.machine->part_height_um() + printer_->table.bath_gap_um;
    return std::max(step.from[Axis::platform], step.to[Axis::platform]) <= deepest_um + printer_->cleaning.stroke_z_um;
}

bool Passage::asks_for_strokes() const {
    const bool tower = printer_->has_carriage();
    return printer_->cleaning.stroke_z_um > 0 || (tower && printer_->cleaning.stroke_x_um > 0);
}

void Passage::add_cleaning(const Step& step) {
    if (step.seconds <= 0 || !cleans(step)) return;
    const bool tower = printer_->has_carriage();
    cleaned_s_ += step.seconds;
    const bool far = (!tower || way_um(step, Axis::carriage) >= printer_->cleaning.stroke_x_um) &&
                     way_um(step, Axis::platform) >= printer_->cleaning.stroke_z_um;
    const machine::Profile profile = machine::profile(*printer_, step.from, step.to, step.feed_mm_s);
    const Axis lead = stroke_axis(*printer_);
    const bool fast = axis_mm_s(profile, step, lead) >= stroke_mm_s(*printer_, step) * (1 - speed_tolerance);
    const bool moves_part = way_um(step, Axis::carriage) > 0 || way_um(step, Axis::platform) > 0;
    if (moves_part && far && fast) {
        ++strokes_;
        stroke_s_ += step.seconds;
    } else if (step.from == step.to || (moves_part && !fast)) {
        still_s_ += step.seconds;
    }
}

Status Passage::check_approach(int z_um) const {
    const machine::Platform& platform = printer_->platform;
    if (went_down_fast_ && fast_down_to_um_ < z_um + platform.approach_um)
        return input_error("the platform goes down faster than {:g} mm/s within {:g} mm of the layer",
                           platform.approach_speed_mm_s, platform.approach_um / 1000.0);
    if (!enough(rest_s_, platform.settle_s))
        return input_error("the resin rests for {:g} s before the exposure, {} asks for {:g} s", rest_s_,
                           printer_->name, platform.settle_s);
    return {};
}

Status Passage::check_peel(int z_um) const {
    const machine::Platform& platform = printer_->platform;
    if (!enough(rest_after_light_s_, printer_->projector.delay_s))
        return input_error("the machine moves {:g} s after the exposure, the projector is dark after {:g} s",
                           rest_after_light_s_, printer_->projector.delay_s);
    if (printer_->has_carriage() && sheared_um_ < printer_->carriage.shear_um)
        return input_error("the carriage moves {:g} mm aside to loosen the layer, {} asks for {:g} mm",
                           sheared_um_ / 1000.0, printer_->name, printer_->carriage.shear_um / 1000.0);
    if (top_um_ < z_um + platform.lift_um)
        return input_error("the platform lifts {:g} mm after the exposure, {} asks for {:g} mm",
                           std::max(0, top_um_ - z_um) / 1000.0, printer_->name, platform.lift_um / 1000.0);
    if (went_up_fast_ && fast_up_from_um_ < z_um + platform.lift_um)
        return input_error("the platform peels the layer faster than {:g} mm/s", platform.lift_speed_mm_s);
    return {};
}

/// Apart from a rest shorter than two strokes, all of the cleaning is motion.
Status Passage::check_strokes() const {
    if (!asks_for_strokes() || strokes_ >= many_strokes) return {};
    const double pair_s = strokes_ > 0 ? 2 * stroke_s_ / strokes_ : 0;
    if (strokes_ >= 2 && still_s_ <= 1.5 * pair_s + time_tolerance_s) return {};
    return input_error(
        "the part hangs still for {:.1f} of {:.1f} s of cleaning, {} asks for strokes of {:g} and {:g} mm", still_s_,
        cleaned_s_, printer_->name, printer_->cleaning.stroke_x_um / 1000.0, printer_->cleaning.stroke_z_um / 1000.0);
}

Status Passage::check_brush() const {
    if (!printer_->has_brush() || brush_.wiped()) return {};
    return input_error("the vat is put away with the part {:g} mm above its rim, its brush reaches {:g} mm",
                       brush_.highest_um() / 1000.0, printer_->cleaning.brush_um / 1000.0);
}

Status Passage::check_cleaning(double seconds) const {
    if (!enough(cleaned_s_, seconds))
        return input_error("the part is cleaned for {:.1f} s, {} asks for {:g} s", cleaned_s_, printer_->name, seconds);
    if (seconds > 0) {
        if (Status moved = check_strokes(); !moved) return moved;
    }
    const double working_s = still_s_ + stroke_s_, most_s = most_cleaning_share * seconds + most_cleaning_more_s;
    if (working_s > std::max(most_s, strokes_ <= 2 ? stroke_s_ : 0))
        return input_error("the part is cleaned for {:.1f} s, {} asks for {:g} s", working_s, printer_->name, seconds);
    const double least_s = fan_on_.empty() ? 0 : printer_->cleaning.dry_s;
    if (!fan_on_.empty() && dried_s_ <= 0 && least_s <= 0)
        return input_error("the part is not dried: {} has {} fans, and they never run all at once", printer_->name,
                           fan_on_.size());
    if (!enough(dried_s_, least_s))
        return input_error("the part dries for {:.1f} s with all fans on, {} asks for {:g} s", dried_s_, printer_->name,
                           least_s);
    return {};
}

}  // namespace pliant::plan

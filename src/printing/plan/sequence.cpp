#include "printing/plan/sequence.hpp"

#include <cmath>
#include <utility>

#include "base/core/letters.hpp"
#include "printing/machine/motion.hpp"

namespace pliant::plan {

using machine::Axis;
using machine::Position;

Seconds& Seconds::operator+=(const Seconds& other) {
    total += other.total;
    swap += other.swap;
    clean += other.clean;
    expose += other.expose;
    move += other.move;
    return *this;
}

Seconds Seconds::operator-(const Seconds& other) const {
    return {total - other.total, swap - other.swap, clean - other.clean, expose - other.expose, move - other.move};
}

void Sequence::spend(double seconds) {
    seconds_.total += seconds;
    switch (activity_) {
        case Activity::swap:
            seconds_.swap += seconds;
            break;
        case Activity::clean:
            seconds_.clean += seconds;
            break;
        case Activity::expose:
            seconds_.expose += seconds;
            break;
        case Activity::move:
            seconds_.move += seconds;
            break;
    }
}

void Sequence::record(std::vector<Stretch>* stretches) {
    stretches_ = stretches;
    last_stretch_.fill(SIZE_MAX);
}

/// Consecutive moves without a pause are one stretch.
void Sequence::note(Device device, double begin_s, double end_s) {
    if (stretches_ == nullptr) return;
    std::size_t& last = last_stretch_[static_cast<std::size_t>(device)];
    if (last < stretches_->size() && (*stretches_)[last].end_s == begin_s) {
        (*stretches_)[last].end_s = end_s;
        return;
    }
    last = stretches_->size();
    stretches_->push_back({device, begin_s, end_s});
}

void Sequence::note_switch(Device device, bool on, double& on_s) {
    if (!on && on_s >= 0) note(device, on_s, seconds_.total);
    on_s = on ? seconds_.total : -1;
}

void Sequence::comment(std::string_view text) {
    if (muted_) return;
    text_ += "; ";
    text_ += one_line(text.substr(0, machine::max_line_chars - 2));
    text_ += '\n';
}

void Sequence::command(std::string_view line) {
    if (line.empty() || muted_) return;
    text_ += line;
    text_ += '\n';
}

void Sequence::home(Axis axis) {
    const machine::AxisSpec& spec = printer_->axis(axis);
    spend(machine::home_seconds(*printer_, axis, spec.homes_to_max ? spec.min_um : spec.max_um));
    position_[axis] = spec.home_um();
    if (!muted_) command(machine::write_home(*printer_, axis));
}

void Sequence::move(Axis axis, int um, double feed_mm_s) {
    Position to = position_;
    to[axis] = um;
    move_to(to, feed_mm_s);
}

void Sequence::move_to(const Position& to, double feed_mm_s) {
    const machine::Profile profile = machine::profile(*printer_, position_, to, feed_mm_s);
    if (profile.length_mm == 0) return;
    const double begin_s = seconds_.total;
    spend(profile.seconds());
    for (const Axis axis : {Axis::platform, Axis::carriage, Axis::tower, Axis::table}) {
        if (to[axis] != position_[axis]) note(device_of(*printer_, axis), begin_s, seconds_.total);
    }
    if (!muted_) command(machine::write_move(*printer_, position_, to, profile.speed_mm_s));
    position_ = to;
}

void Sequence::dwell(double seconds) {
    const double whole_ms = std::round(seconds * 1000) / 1000;
    if (whole_ms <= 0) return;
    spend(whole_ms);
    if (!muted_) command(machine::write_dwell(whole_ms));
}

void Sequence::fence() {
    command("M400");
}

void Sequence::pump(bool on) {
    const machine::Switch& pump = printer_->pump;
    if (pump.on.empty()) return;
    fence();
    command(on ? pump.on : pump.off);
    note_switch(Device::pump, on, pump_on_s_);
}

void Sequence::fans(bool on) {
    if (printer_->fans.empty()) return;
    fence();
    for (const machine::Switch& fan : printer_->fans) command(on ? fan.on : fan.off);
    note_switch(Device::fans, on, fans_on_s_);
}

void Sequence::magnet(bool holds) {
    const machine::Magnet& magnet = printer_->hooks.magnet;
    if (!magnet.present()) return;
    const double seconds = holds ? magnet.engage_s : magnet.release_s;
    fence();
    command(holds ? magnet.coil.on : magnet.coil.off);
    note(Device::magnet, seconds_.total, seconds_.total + seconds);
    dwell(seconds);
}

void Sequence::fork(bool out) {
    const machine::Wall& wall = printer_->wall;
    fence();
    command(out ? wall.fork.on : wall.fork.off);
    note(Device::fork, seconds_.total, seconds_.total + wall.fork_s);
}

void Sequence::expose(const machine::Expose& expose) {
    const Activity before = activity_;
    fence();
    if (!muted_) command(machine::write_expose(expose));
    activity(Activity::expose);
    const double begin_s = seconds_.total;
    spend(expose.seconds);
    note(Device::light, begin_s, seconds_.total);
    activity(before);
}

void approach(Sequence& sequence, int z_um) {
    const machine::Platform& platform = sequence.printer().platform;
    if (sequence.position()[Axis::platform] > z_um + platform.approach_um)
        sequence.move(Axis::platform, z_um + platform.approach_um);
    sequence.move(Axis::platform, z_um, platform.approach_speed_mm_s);
    sequence.dwell(platform.settle_s);
}

}  // namespace pliant::plan

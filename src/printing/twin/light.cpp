// Exposures of the virtual printer, the opening of its door meanwhile, and the growing part.
#include <algorithm>
#include <limits>
#include <utility>

#include "printing/twin/twin.hpp"

namespace pliant::twin {
namespace {

constexpr double never_shuts = std::numeric_limits<double>::infinity();

}  // namespace

void Twin::light_on(const job::Image& image) {
    if (shown_) light_off();
    ++log_.exposures;
    open_door();
    const bool fits =
        image.width_px == printer_.projector.width_px && image.height_px == printer_.projector.height_px &&
        image.pixels.size() == static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px);
    if (!fits) return violation("an image that is not of the projector's size");
    if (Status status = motors_.interlock().light_on(motors_.moving(now_s_)); !status) {
        return violation(status.error().message);
    }
    if (last_vat_ < 0) last_vat_ = interlock().hooked_vat().value_or(-1);
    Screen::Picture picture = screen_.coverage(runs_of(image));
    log_.overlit_pixels += picture.overlit_px;
    shown_ = std::move(picture.runs);
    shown_since_s_ = now_s_;
    shown_vat_ = vat_under_light();
    if (shown_vat_ >= 0) change_vat_part(shown_vat_);
    if (fault_hits(Fault::Kind::dark_projector, log_.exposures)) {
        mishap("the projector stays dark");
        shown_vat_ = -1;
    } else if (shown_vat_ < 0) {
        mishap("light without a vat in its place");
    }
    sprayed_s_ = 0;
}

/// The fault of that exposure; the controller only sees its switch.
void Twin::open_door() {
    const Fault* fault = fault_at(Fault::Kind::door_open, log_.exposures);
    if (fault == nullptr) return;
    constexpr double after_s = 0.5, usual_s = 30;
    door_opens_s_ = now_s_ + after_s;
    door_shuts_s_ = door_opens_s_ + (fault->amount > 0 ? fault->amount : usual_s);
    mishap("somebody opens the door");
}

void Twin::set_door(bool open) {
    if (open == door_is_open()) return;
    if (open) {
        door_opens_s_ = now_s_;
        door_shuts_s_ = never_shuts;
        mishap("somebody opens the door");
    } else {
        door_shuts_s_ = now_s_;
    }
}

void Twin::take_part_off() {
    cure_.clear();
    sprayed_.clear();
    fluids_.wipe();
    contamination_.clear();
    log_ = {};
    log_.fan_s.resize(printer_.fans.size());
    part_vat_ = last_vat_ = -1;
    residue_ = sprayed_s_ = 0;
    machine::Interlock::State state = interlock().state();
    state.part_height_um = 0;
    if (auto without = machine::Interlock::restored(printer_, state)) motors_.interlock() = std::move(*without);
}

void Twin::light_off() {
    motors_.interlock().light_off();
    if (!shown_) return;
    const int z_um =
        interlock().position()[machine::Axis::platform] + slip_um_[static_cast<std::size_t>(machine::Axis::platform)];
    log_.lit_while_open_s += std::max(0.0, std::min(now_s_, door_shuts_s_) - std::max(shown_since_s_, door_opens_s_));
    if (shown_vat_ >= 0) cure_.expose(*shown_, shown_vat_, now_s_ - shown_since_s_, z_um);
    shown_.reset();
}

const Cure& Twin::cured() {
    cure_.finish();
    return cure_;
}

}  // namespace pliant::twin

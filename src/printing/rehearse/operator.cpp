#include "printing/rehearse/operator.hpp"

#include <utility>

namespace pliant::rehearse {

WillingOperator::WillingOperator(twin::Twin& twin, std::vector<host::Refill> refills)
    : twin_(twin), refills_(std::move(refills)) {}

void WillingOperator::look(host::Control& control) {
    if (control.state() != host::State::paused) return;
    const host::Snapshot now = control.snapshot();
    // The state stays paused until the resume is carried out, and the next request may have the same text.
    for (const host::Event& event : control.events_since(last_event_)) {
        last_event_ = event.number;
        if (event.kind == "prompt") do_as_asked(event.text);
    }
    if (!now.door_open.value_or(false)) (void)control.resume();
}

/// A prompt contains everything requested before one layer. Each request is met once: the search begins after the last
/// one met, and a prompt for something else (a door to be shut) matches none.
void WillingOperator::do_as_asked(const std::string& prompt) {
    for (std::size_t first = done_; first < refills_.size(); ++first) {
        if (refills_[first].text != prompt) continue;
        const int layer = refills_[first].layer;
        for (done_ = first; done_ < refills_.size() && refills_[done_].layer == layer; ++done_) {
            if (refills_[done_].slot > 0)
                twin_.fill_vat(refills_[done_].slot);
            else
                twin_.care(refills_[done_].care);
        }
        return;
    }
}

}  // namespace pliant::rehearse

#include "printing/rehearse/virtual_devices.hpp"

namespace pliant::rehearse {

Status TwinWire::write(std::string_view bytes) {
    twin_.receive(bytes);
    return {};
}

Result<std::string> TwinWire::read(double timeout_s) {
    if (look_) look_();
    const double end_s = twin_.now() + timeout_s;
    for (;;) {
        if (std::string said = twin_.take_output(); !said.empty()) return said;
        const auto next = twin_.next_event();
        if (!next || *next > end_s) break;
        twin_.advance_to(*next);
    }
    twin_.advance_to(end_s);
    return twin_.take_output();
}

Status TwinProjector::show(const job::Image& image) {
    twin_.light_on(image);
    return {};
}

Status TwinProjector::black() {
    twin_.light_off();
    return {};
}

Status TwinGuard::announced(long light) {
    light_ = light;
    on_s_ = 0;
    return {};
}

void TwinGuard::lit(double now_s) {
    lit_at_s_ = now_s;
    on_s_.reset();
}

void TwinGuard::dark(double now_s) {
    on_s_ = now_s - lit_at_s_;
}

std::optional<double> TwinGuard::lit_s(long light) {
    return light == seen_ ? std::optional(seen_on_s_) : std::nullopt;
}

void TwinGuard::host_died() {
    seen_ = light_;
    seen_on_s_ = on_s_.value_or(twin_.now() - lit_at_s_);
}

}  // namespace pliant::rehearse

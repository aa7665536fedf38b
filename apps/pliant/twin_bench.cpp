#include "twin_bench.hpp"

#include <utility>

namespace pliant::app {

Status TwinWire::write(std::string_view bytes) {
    twin_.receive(bytes);
    return {};
}

Result<std::string> TwinWire::read(double timeout_s) {
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

TwinBench::TwinBench(const machine::Printer& printer, twin::Options options)
    : twin_(printer, std::move(options)), wire_(twin_), projector_(twin_), clock_(twin_) {}

}  // namespace pliant::app

#include "printing/operate/programs.hpp"

#include <memory>

#include "printing/plan/recover.hpp"
#include "printing/plan/safe_stop.hpp"

namespace pliant::operate {

using machine::Interlock;

host::Programs programs_of(const machine::Printer& printer) {
    const auto p = std::make_shared<const machine::Printer>(printer);
    host::Programs programs;
    programs.cancel = [p](const Interlock& state) -> Result<std::string> { return plan::cancel_program(state, *p); };
    programs.pause_begin = [p](const Interlock& state) -> Result<std::string> {
        return plan::pause_program(state, *p).begin;
    };
    programs.pause_end = [p](const Interlock& before) -> Result<std::string> {
        return plan::pause_program(before, *p).end;
    };
    programs.hold_begin = [p](const Interlock& state) -> Result<std::string> {
        return plan::hold_program(state, *p).begin;
    };
    programs.hold_end = [p](const Interlock& before) -> Result<std::string> {
        return plan::hold_program(before, *p).end;
    };
    programs.bring_vat = [p](const Interlock& state, int slot) { return plan::vat_program(state, *p, slot); };
    programs.clean = [p](const Interlock& state, double seconds) { return plan::clean_program(state, *p, seconds); };
    programs.resume = [p](const host::Recovery& r) {
        return plan::resume_program({r.state, r.target, r.finished, r.last_lit_vat, r.on_hooks}, *p);
    };
    return programs;
}

host::LinkOptions link_options(const machine::Controller& controller) {
    host::LinkOptions options;
    options.window_lines = controller.window_lines;
    options.window_bytes = controller.window_bytes;
    return options;
}

}  // namespace pliant::operate

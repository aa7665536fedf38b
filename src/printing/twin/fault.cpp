#include "printing/twin/fault.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/core/parse_all.hpp"
#include "printing/machine/switches.hpp"

namespace pliant::twin {
namespace {

using FaultKind = Fault::Kind;

constexpr std::array<std::pair<std::string_view, FaultKind>, 20> kinds = {
    {{"corrupt-line", FaultKind::corrupt_byte},
     {"lose-line", FaultKind::lose_line},
     {"lose-ok", FaultKind::lose_ok},
     {"lose-resend", FaultKind::lose_resend},
     {"reset", FaultKind::reset},
     {"lose-byte", FaultKind::lose_byte},
     {"flip-byte", FaultKind::flip_byte},
     {"lose-number", FaultKind::lose_number},
     {"resend-loop", FaultKind::resend_loop},
     {"stall", FaultKind::stall},
     {"missed-steps", FaultKind::missed_steps},
     {"stuck-hook", FaultKind::stuck_hook},
     {"empty-vat", FaultKind::empty_vat},
     {"dead-pump", FaultKind::dead_pump},
     {"dark-projector", FaultKind::dark_projector},
     {"door-open", FaultKind::door_open},
     {"stuck-switch", FaultKind::stuck_switch},
     {"dead-switch", FaultKind::dead_switch},
     {"weak-magnet", FaultKind::weak_magnet},
     {"stuck-fork", FaultKind::stuck_fork}}};

/// Removes the text up to the next colon from `rest` and returns it.
std::string_view take_part(std::string_view& rest) {
    const std::string_view part = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
    return part;
}

/// "" if the machine has what fails, else what it lacks.
std::string lacking(const Fault& fault, const machine::Printer& printer) {
    const auto fewer = [&](std::size_t switches) {
        if (static_cast<std::size_t>(fault.n) <= switches) return std::string();
        return fmt::format("has {} limit switch{}", switches, switches == 1 ? "" : "es");
    };
    switch (fault.kind) {
        case FaultKind::stuck_switch:
            return printer.limit_switches.empty() ? "lists no [[limit_switch]] for the host to look at"
                                                  : fewer(printer.limit_switches.size());
        case FaultKind::dead_switch:
            return fewer(machine::switches_of(printer).size());
        case FaultKind::weak_magnet:
            return printer.hooks.magnet.present() ? "" : "has no magnet";
        case FaultKind::stuck_fork:
            return printer.store() == machine::Store::wall ? "" : "has no retriever with a fork";
        case FaultKind::stuck_hook:
            return printer.has_carriage() ? "" : "has no hooks";
        case FaultKind::empty_vat:
            return printer.vat_of_slot(fault.n) != nullptr ? "" : fmt::format("has no vat in slot {}", fault.n);
        case FaultKind::dead_pump:
            return printer.pump.on.empty() ? "has no pump" : "";
        case FaultKind::door_open:
            return printer.door.present() ? "" : "has no [door] switch, so that nobody would notice";
        default:
            return "";
    }
}

}  // namespace

Status check_faults(const std::vector<Fault>& faults, const machine::Printer& printer) {
    for (const Fault& fault : faults) {
        const std::string lack = lacking(fault, printer);
        if (!lack.empty())
            return input_error("--fault {}: cannot occur: the {} {}", fault_text(fault), printer.name, lack);
    }
    return {};
}

std::string fault_text(const Fault& fault) {
    const auto entry = std::find_if(kinds.begin(), kinds.end(), [&](auto& kind) { return kind.second == fault.kind; });
    return fmt::format("{}:{}{}", entry->first, fault.n, fault.amount > 0 ? fmt::format(":{:g}", fault.amount) : "");
}

std::string fault_names() {
    std::string names;
    for (const auto& [name, kind] : kinds) names += (names.empty() ? "" : ", ") + std::string(name);
    return names;
}

Result<Fault> parse_fault(std::string_view text) {
    std::string_view rest = text;
    const std::string_view wanted = take_part(rest);
    for (const auto& [name, kind] : kinds) {
        if (name != wanted) continue;
        Fault fault{kind, 1, 0};
        if (const auto n = take_part(rest); !n.empty() && !(parse_all(n, fault.n) && fault.n >= 1)) {
            return input_error("fault \"{}\": \"{}\" is not a number from 1", text, n);
        }
        if (!rest.empty() && !(parse_all(rest, fault.amount) && fault.amount > 0 && fault.amount <= 1e6)) {
            return input_error("fault \"{}\": \"{}\" is not an amount above 0", text, rest);
        }
        return fault;
    }
    return input_error("fault \"{}\" is not known; write KIND, KIND:N or KIND:N:AMOUNT, where KIND is one of {}", text,
                       fault_names());
}

}  // namespace pliant::twin

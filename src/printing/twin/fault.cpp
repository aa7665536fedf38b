#include "printing/twin/fault.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

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

template <class Number>
bool parse_whole(std::string_view text, Number& value) {
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return code == std::errc() && end == text.data() + text.size();
}

/// Removes the text up to the next colon from `rest` and returns it.
std::string_view take_part(std::string_view& rest) {
    const std::string_view part = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
    return part;
}

}  // namespace

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
        if (const auto n = take_part(rest); !n.empty() && !(parse_whole(n, fault.n) && fault.n >= 1)) {
            return input_error("fault \"{}\": \"{}\" is not a number from 1", text, n);
        }
        if (!rest.empty() && !(parse_whole(rest, fault.amount) && fault.amount > 0 && fault.amount <= 1e6)) {
            return input_error("fault \"{}\": \"{}\" is not an amount above 0", text, rest);
        }
        return fault;
    }
    return input_error("fault \"{}\" is not known; write KIND, KIND:N or KIND:N:AMOUNT, where KIND is one of {}", text,
                       fault_names());
}

}  // namespace pliant::twin

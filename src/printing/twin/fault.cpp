#include "printing/twin/fault.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace pliant::twin {
namespace {

using Kind = Fault::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 20> kinds = {{{"corrupt-line", Kind::corrupt_byte},
                                                                      {"lose-line", Kind::lose_line},
                                                                      {"lose-ok", Kind::lose_ok},
                                                                      {"lose-resend", Kind::lose_resend},
                                                                      {"reset", Kind::reset},
                                                                      {"lose-byte", Kind::lose_byte},
                                                                      {"flip-byte", Kind::flip_byte},
                                                                      {"lose-number", Kind::lose_number},
                                                                      {"resend-loop", Kind::resend_loop},
                                                                      {"stall", Kind::stall},
                                                                      {"missed-steps", Kind::missed_steps},
                                                                      {"stuck-hook", Kind::stuck_hook},
                                                                      {"empty-vat", Kind::empty_vat},
                                                                      {"dead-pump", Kind::dead_pump},
                                                                      {"dark-projector", Kind::dark_projector},
                                                                      {"door-open", Kind::door_open},
                                                                      {"stuck-switch", Kind::stuck_switch},
                                                                      {"dead-switch", Kind::dead_switch},
                                                                      {"weak-magnet", Kind::weak_magnet},
                                                                      {"stuck-fork", Kind::stuck_fork}}};

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

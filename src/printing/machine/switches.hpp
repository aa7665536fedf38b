// Limit switches and the door as the controller reports them (M119), and what they must not say.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// The switches that the printer file lists; if it lists none, one for each axis where it homes.
[[nodiscard]] std::vector<LimitSwitch> switches_of(const Printer& printer);

/// What M119 may call it: "a_min" by the axis' letter; with Marlin's extra axes also "i_min" by their own name.
[[nodiscard]] std::vector<std::string> switch_names(const Printer& printer, const LimitSwitch& which);

struct SwitchReading {
    std::string name;
    bool pressed = false;

    bool operator==(const SwitchReading&) const = default;
};

/// Reads "x_min: TRIGGERED" or "y_max: open"; nullopt for any other line, also for one that is not whole.
[[nodiscard]] std::optional<SwitchReading> parse_switch(std::string_view line);

/// nullopt: the readings do not name it.
[[nodiscard]] std::optional<bool> door_open(const Printer& printer, const std::vector<SwitchReading>& readings);

/// How far from the end of its travel an axis may stand with the switch there pressed, in um.
inline constexpr int switch_reach_um = 5000;

/// What the switches must not say of a machine that stands still in `state`: nothing of one that the file lists;
/// pressed, though the axis is homed and stands elsewhere; both ends of an axis pressed at once. The error names the
/// switch and what to look at. A machine whose file lists no switches and has no door passes.
[[nodiscard]] Status check_switches(const Printer& printer, const Interlock& state,
                                    const std::vector<SwitchReading>& readings);

}  // namespace pliant::machine

// Limit and door switches as the controller reports them (M119), and checks of their readings.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// The switches in the printer file; if it lists none, one for each axis where it homes.
[[nodiscard]] std::vector<LimitSwitch> switches_of(const Printer& printer);

/// Its possible names in M119: "a_min" by the axis' letter; for Marlin's extra axes also "i_min" by Marlin's name.
[[nodiscard]] std::vector<std::string> switch_names(const Printer& printer, const LimitSwitch& which);

struct SwitchReading {
    std::string name;
    bool pressed = false;

    bool operator==(const SwitchReading&) const = default;
};

/// Parses "x_min: TRIGGERED" or "y_max: open"; nullopt for any other line, incomplete ones included.
[[nodiscard]] std::optional<SwitchReading> parse_switch(std::string_view line);

/// nullopt: not in the readings.
[[nodiscard]] std::optional<bool> door_open(const Printer& printer, const std::vector<SwitchReading>& readings);

/// Maximum distance of an axis from the end of its travel with the switch there pressed, in um.
inline constexpr int switch_reach_um = 5000;

/// Checks the readings of a machine at rest in `state`. Errors: a listed switch without reading; one that is pressed
/// although its axis is homed and elsewhere; both ends of an axis pressed. The error names the switch and what to look
/// at. A machine whose file lists no switches and has no door passes.
[[nodiscard]] Status check_switches(const Printer& printer, const Interlock& state,
                                    const std::vector<SwitchReading>& readings);

}  // namespace pliant::machine

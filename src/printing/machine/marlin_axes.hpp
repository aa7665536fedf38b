// Which place of Marlin's an axis beyond X, Y and Z takes.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// The letters that Marlin 2.1 knows, and what it calls its places beyond X, Y and Z, of which Pliant uses three.
inline constexpr std::string_view marlin_letters = "XYZABCUVW";
inline constexpr std::array<char, 3> marlin_extra_places = {'I', 'J', 'K'};

/// The machine's axes beyond X, Y and Z in the order in which they take the places: those that turn first, which
/// Marlin insists on, then by the alphabet. Axes whose letter Marlin does not know are left out.
[[nodiscard]] std::vector<const AxisSpec*> extra_axes(const Printer& printer);

/// What Marlin's settings call `axis`, one of the printer's: X, Y, Z, I, J or K; nullopt: there is no place for it.
[[nodiscard]] std::optional<char> marlin_place(const Printer& printer, const AxisSpec& axis);

}  // namespace pliant::machine

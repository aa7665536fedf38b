// Maps axes beyond X, Y and Z to Marlin's axis names.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// The axis letters that Marlin 2.1 knows, and its names for axes beyond X, Y and Z, of which Pliant uses three.
inline constexpr std::string_view marlin_letters = "XYZABCUVW";
inline constexpr std::array<char, 3> marlin_extra_places = {'I', 'J', 'K'};

/// The machine's axes beyond X, Y and Z in the order of Marlin's names: rotary axes first, as Marlin requires, then
/// alphabetically. Axes whose letter Marlin does not know are left out.
[[nodiscard]] std::vector<const AxisSpec*> extra_axes(const Printer& printer);

/// Marlin's name for `axis`, one of the printer's: X, Y, Z, I, J or K; nullopt if none is left.
[[nodiscard]] std::optional<char> marlin_place(const Printer& printer, const AxisSpec& axis);

}  // namespace pliant::machine

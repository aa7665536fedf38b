// What printers can be compared by: the figures of the thesis' chapter 4, reckoned from the machines' files.
#pragma once

#include <string>
#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// Square inch, the unit of the thesis' comparison, in mm^2.
inline constexpr double square_inch_mm2 = 25.4 * 25.4;

/// One change of vats between neighbours, step by step as the thesis lists it.
struct SwapSteps {
    double push_s = 0;   ///< the vat goes into the tower (a table: way to the cleaning station, down into it)
    double hooks_s = 0;  ///< off the hooks; within the cleaning
    double clean_s = 0;  ///< all the time that the pump runs
    double pull_s = 0;   ///< the next vat comes (a table: out of the station, way to the vat), dried
    double total_s = 0;  ///< push + clean + pull
};

struct PrinterFigures {
    std::string name;
    double area_mm2 = 0;  ///< of the platform
    int places = 0;       ///< for vats
    SwapSteps swap;
    double mean_swap_s = 0;     ///< over all pairs of vats
    double longest_swap_s = 0;  ///< of any pair
    double removed = 0;         ///< share of the resin film that its cleaning removes, by the law of table 4.2
    double packing = 0;         ///< share of the store that vats fill; 0 for a single vat
    double store_mm = 0;        ///< height of a tower, length of a row, diameter of a turntable
};

[[nodiscard]] PrinterFigures figures(const machine::Printer& printer);

/// Height of a tower of n vats, in mm: n vats and n - 1 clearances.
[[nodiscard]] double tower_height_mm(const machine::Printer& printer, int vats);
/// Share of a tower's height that its vats fill.
[[nodiscard]] double tower_packing(const machine::Printer& printer, int vats);
/// Share of the smallest disc around n rectangles that stand in a ring, their short sides inwards.
[[nodiscard]] double ring_packing(double long_mm, double short_mm, int vats);
[[nodiscard]] double ring_diameter_mm(double long_mm, double short_mm, int vats);

/// The same machine with a store for `vats` vats, all fitted: a longer tower, a longer row, a larger turntable whose
/// rim is no faster than before.
[[nodiscard]] machine::Printer with_vats(const machine::Printer& printer, int vats);

struct SwapTimes {
    int vats = 0;
    double next_s = 0;  ///< to the neighbour
    double mean_s = 0;  ///< over all pairs
};

/// The same machine with a bed that is `bed` times as long along the way of its vats (and that way with it), and with
/// carriage, tower and table `motors` times as fast. Accelerations stay.
[[nodiscard]] machine::Printer with_bed(const machine::Printer& printer, double bed, double motors);

/// How a change of vats grows with the store.
[[nodiscard]] std::vector<SwapTimes> swap_over_vats(const machine::Printer& printer, const std::vector<int>& vats);

}  // namespace pliant::plan

// Figures for comparing printers, as in chapter 4 of the thesis, computed from the printer files.
#pragma once

#include <string>
#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// Square inch, the unit of the thesis' comparison, in mm^2.
inline constexpr double square_inch_mm2 = 25.4 * 25.4;

/// One swap between neighbouring vats, by the steps of the thesis.
struct SwapSteps {
    double push_s = 0;   ///< the vat goes into the tower (table: travel to the cleaning station and down into it)
    double hooks_s = 0;  ///< release from the hooks; part of the cleaning
    double clean_s = 0;  ///< total time that the pump runs
    double pull_s = 0;   ///< the next vat is pulled in (table: out of the station, travel to the vat), with drying
    double total_s = 0;  ///< push + clean + pull
};

struct PrinterFigures {
    std::string name;
    double area_mm2 = 0;  ///< of the platform
    int places = 0;       ///< for vats
    SwapSteps swap;
    double mean_swap_s = 0;     ///< over all pairs of vats
    double longest_swap_s = 0;  ///< of any pair
    double removed = 0;         ///< fraction of the resin film that its cleaning removes, by the law fitted to table
                                ///< 4.2
    double packing = 0;         ///< fraction of the store filled by vats; 0 for a single vat
    double store_mm = 0;        ///< height of a tower, length of a row, diameter of a turntable
};

[[nodiscard]] PrinterFigures figures(const machine::Printer& printer);

/// Height of a tower of n vats, in mm: n vats and n - 1 clearances.
[[nodiscard]] double tower_height_mm(const machine::Printer& printer, int vats);
/// Fraction of a tower's height filled by its vats.
[[nodiscard]] double tower_packing(const machine::Printer& printer, int vats);
/// Fraction filled of the smallest disc around n rectangles in a ring, short sides inwards.
[[nodiscard]] double ring_packing(double long_mm, double short_mm, int vats);
[[nodiscard]] double ring_diameter_mm(double long_mm, double short_mm, int vats);

/// The same machine with a store for `vats` vats, all fitted: a taller tower, a longer row, or a larger turntable with
/// the same rim speed.
[[nodiscard]] machine::Printer with_vats(const machine::Printer& printer, int vats);

struct SwapTimes {
    int vats = 0;
    double next_s = 0;  ///< to a neighbouring vat
    double mean_s = 0;  ///< over all pairs
};

/// The same machine with a bed `bed` times as long in the direction of vat travel (and that travel with it), and with
/// carriage, tower and table `motors` times as fast. Accelerations are unchanged.
[[nodiscard]] machine::Printer with_bed(const machine::Printer& printer, double bed, double motors);

/// Swap times against the number of vats.
[[nodiscard]] std::vector<SwapTimes> swap_over_vats(const machine::Printer& printer, const std::vector<int>& vats);

}  // namespace pliant::plan

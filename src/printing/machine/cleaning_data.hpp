// Resin removal by cleaning: the measurements of the thesis (table 4.2) and a law fitted to them.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Fraction of the removable resin that was removed from four test parts, computed from the weights in the thesis.
struct CleaningTest {
    std::string_view method;
    double seconds = 0;             ///< 0: does not depend on time
    std::array<double, 4> removed;  ///< cone, scaffold, cylinder, pyramids
    double printed_pyramids = 0;    ///< the value for the pyramids in the thesis' table; 0: the same

    [[nodiscard]] double pyramids() const { return removed[3]; }
    [[nodiscard]] double mean() const { return (removed[0] + removed[1] + removed[2] + removed[3]) / 4; }
};

inline constexpr std::array<std::string_view, 4> cleaning_test_parts = {"cone", "scaffold", "cylinder", "pyramids"};

/// The rows of table 4.2.
[[nodiscard]] std::span<const CleaningTest> cleaning_tests();

/// Fraction of the resin film removed by `seconds` of cleaning: reach (1 - exp(-t / tau)), fitted to the mean of the
/// tests.
struct CleaningLaw {
    double reach = 1;
    double tau_s = 1;
    [[nodiscard]] double removed(double seconds) const;
};

/// Spray: only one test, so it is assumed to remove everything in the end. Ultrasound: through its two tests. A bath
/// without ultrasound was not measured and is assumed to be no worse.
[[nodiscard]] CleaningLaw cleaning_law(CleaningMethod method);

}  // namespace pliant::machine

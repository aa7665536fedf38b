// How much resin cleaning takes off a part: the measurements of the thesis (table 4.2) and a law through them.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Share of the removable resin that was removed from four test parts, as the thesis' weights give it.
struct CleaningTest {
    std::string_view method;
    double seconds = 0;             ///< 0: not a matter of time
    std::array<double, 4> removed;  ///< cone, scaffold, cylinder, pyramids
    double printed_pyramids = 0;    ///< what the thesis' table says for the pyramids; 0: the same

    [[nodiscard]] double pyramids() const { return removed[3]; }
    [[nodiscard]] double mean() const { return (removed[0] + removed[1] + removed[2] + removed[3]) / 4; }
};

inline constexpr std::array<std::string_view, 4> cleaning_test_parts = {"cone", "scaffold", "cylinder", "pyramids"};

/// The rows of table 4.2.
[[nodiscard]] std::span<const CleaningTest> cleaning_tests();

/// Share of the resin film that `seconds` of cleaning remove: reach (1 - exp(-t / tau)), through the mean of the tests.
struct CleaningLaw {
    double reach = 1;
    double tau_s = 1;
    [[nodiscard]] double removed(double seconds) const;
};

/// Spray: one test, so it is taken to reach everything in the end. Ultrasound: through its two tests. A bath without
/// ultrasound has not been measured and is taken to be no worse.
[[nodiscard]] CleaningLaw cleaning_law(CleaningMethod method);

}  // namespace pliant::machine

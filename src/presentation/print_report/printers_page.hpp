// Comparison of printers on one page: that of the thesis (chapter 4), recomputed.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::report {

/// A self-contained HTML page: table of figures, a picture of one swap of each machine, swap time over the number of
/// vats, cleaning, and inconsistencies within the thesis. The first tower, turntable and row among `printers` represent
/// their kinds in the plot.
[[nodiscard]] Result<std::string> printers_page(const std::vector<machine::Printer>& printers);

/// The same figures as JSON.
[[nodiscard]] std::string printers_json(const std::vector<machine::Printer>& printers);

/// The same figures as a table for the terminal.
[[nodiscard]] std::string printers_text(const std::vector<machine::Printer>& printers);

}  // namespace pliant::report

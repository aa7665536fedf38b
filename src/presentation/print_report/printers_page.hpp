// Printers beside each other on one page: the comparison of the thesis (chapter 4), reckoned anew.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::report {

/// A self-contained HTML page: table of figures, a picture of one swap of each machine, swap time over the number of
/// vats, cleaning, and where the thesis disagrees with itself. The first tower, turntable and row among `printers`
/// stand for their kinds in the plot.
[[nodiscard]] Result<std::string> printers_page(const std::vector<machine::Printer>& printers);

/// The same figures for programs.
[[nodiscard]] std::string printers_json(const std::vector<machine::Printer>& printers);

/// And as a table for the terminal.
[[nodiscard]] std::string printers_text(const std::vector<machine::Printer>& printers);

}  // namespace pliant::report

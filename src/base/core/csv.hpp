// Tables of measurements as text: commas, semicolons or tabs, numbers with a decimal point, units in the columns'
// names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/units.hpp"

namespace pliant {

struct CsvRow {
    int line = 0;  ///< of the file, from 1
    std::vector<std::string> cells;
};

struct CsvTable {
    std::string file;
    int header_line = 0;
    std::vector<std::string> columns;  ///< as written, without quotes and blanks around them
    std::vector<CsvRow> rows;          ///< at least one

    /// "FILE:LINE", for messages.
    [[nodiscard]] std::string place(int line) const;
    /// The cell of a column, by its index. Error: the row is too short.
    [[nodiscard]] Result<std::string_view> cell(const CsvRow& row, std::size_t column) const;
    /// The finite number in it, which messages call `what`.
    [[nodiscard]] Result<double> number(const CsvRow& row, std::size_t column, std::string_view what) const;
};

/// Empty lines and those that begin with # are passed over; the first other line names the columns. `example` is what
/// it could be, for the message of an empty file. Errors: over 64 MB, no names, no rows.
[[nodiscard]] Result<CsvTable> parse_csv(std::string_view text, const std::string& file, std::string_view example);

/// What stands in brackets at the end of a column's name: "MPa" of "stress (MPa)"; "" without.
[[nodiscard]] std::string_view csv_unit(std::string_view column);

}  // namespace pliant

// Tables of measurements as text: comma, semicolon or tab separated, decimal points, units in the column names.
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
    std::vector<std::string> columns;  ///< as written, without surrounding quotes and blanks
    std::vector<CsvRow> rows;          ///< at least one

    /// "FILE:LINE", for messages.
    [[nodiscard]] std::string place(int line) const;
    /// The cell of a column, by index. Error: the row is too short.
    [[nodiscard]] Result<std::string_view> cell(const CsvRow& row, std::size_t column) const;
    /// The finite number in that cell, called `what` in messages.
    [[nodiscard]] Result<double> number(const CsvRow& row, std::size_t column, std::string_view what) const;
};

/// Empty lines, rows of empty cells and lines that begin with # are skipped; the first other line names the columns.
/// `example` is a valid header line, shown in the error for an empty file. Errors: over 64 MB, no names, no rows, a row
/// with values beyond the last name.
[[nodiscard]] Result<CsvTable> parse_csv(std::string_view text, const std::string& file, std::string_view example);

/// The text in brackets at the end of a column name: "MPa" for "stress (MPa)"; "" if there is none.
[[nodiscard]] std::string_view csv_unit(std::string_view column);
/// The column name without these brackets: "stress".
[[nodiscard]] std::string_view without_csv_unit(std::string_view column);

/// A field, quoted if it contains a comma, a quote or a line break. A leading =, +, -, @ is prefixed with an
/// apostrophe, so that no spreadsheet takes a name for a formula.
[[nodiscard]] std::string csv_field(std::string_view text);

/// The name in a column that csv_field() may have written: without its apostrophe. `column` itself if it has none.
[[nodiscard]] std::string_view csv_name(std::string_view column);

}  // namespace pliant

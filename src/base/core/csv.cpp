#include "base/core/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/core/letters.hpp"
#include "base/core/parse_all.hpp"

namespace pliant {
namespace {

constexpr std::size_t most_bytes = std::size_t{64} << 20;
constexpr double largest_number = 1e30;  // nothing measured comes near it, and its squares are numbers

/// Takes one cell and its separator: in quotes a separator is an ordinary character, and "" is a quote (RFC 4180).
std::string take_cell(std::string_view& line, char separator, bool& more) {
    std::string cell;
    bool quoted = false;
    std::size_t at = 0;
    for (; at < line.size() && (quoted || line[at] != separator); ++at) {
        if (line[at] != '"')
            cell += line[at];
        else if (quoted && at + 1 < line.size() && line[at + 1] == '"')
            cell += line[++at];
        else
            quoted = !quoted;
    }
    more = at < line.size();
    line.remove_prefix(more ? at + 1 : at);
    return std::string(trimmed(cell));
}

std::vector<std::string> split(std::string_view line, char separator) {
    std::vector<std::string> cells;
    for (bool more = true; more;) cells.push_back(take_cell(line, separator, more));
    return cells;
}

/// What a spreadsheet would compute.
bool begins_formula(std::string_view text) {
    return !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos;
}

/// The first tab or semicolon outside quotes, else a comma.
char separator_of(std::string_view line) {
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (!quoted && (c == '\t' || c == ';')) return c;
    }
    return ',';
}

bool is_empty(const std::vector<std::string>& cells) {
    return std::all_of(cells.begin(), cells.end(), [](const std::string& cell) { return cell.empty(); });
}

/// Empty, or a comment, which a spreadsheet may have quoted.
bool is_passed_over(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t\r\"");
    return first == std::string_view::npos || line[first] == '#';
}

/// True with values that no column names, as from decimal commas. Spreadsheets leave empty cells behind the last one.
bool surplus(const CsvRow& row, std::size_t columns) {
    return std::any_of(row.cells.begin() + static_cast<std::ptrdiff_t>(std::min(columns, row.cells.size())),
                       row.cells.end(), [](const std::string& cell) { return !cell.empty(); });
}

/// Where the brackets that end a column begin; npos if it ends otherwise. The index of an entry, as in cable[0], is
/// part of the name.
std::size_t start_of_unit(std::string_view column) {
    if (column.empty() || (column.back() != ')' && column.back() != ']')) return std::string_view::npos;
    const char close = column.back(), open = close == ')' ? '(' : '[';
    std::size_t at = column.size(), depth = 0;
    do {
        if (at == 0) return std::string_view::npos;
        --at;
        if (column[at] == close) ++depth;
        if (column[at] == open) --depth;
    } while (depth > 0);
    const std::string_view inside = column.substr(at + 1, column.size() - at - 2);
    const bool index =
        open == '[' && at > 0 && column[at - 1] != ' ' && std::all_of(inside.begin(), inside.end(), is_digit);
    return trimmed(inside).empty() || index ? std::string_view::npos : at;
}

}  // namespace

std::string CsvTable::place(int line) const {
    return fmt::format("{}:{}", file, line);
}

Result<std::string_view> CsvTable::cell(const CsvRow& row, std::size_t column) const {
    if (column < row.cells.size()) return std::string_view(row.cells[column]);
    return input_error_at(file, row.line, "{} columns, but the first line names more", row.cells.size());
}

Result<double> CsvTable::number(const CsvRow& row, std::size_t column, std::string_view what) const {
    const auto text = cell(row, column);
    if (!text) return tl::unexpected(text.error());
    double value = 0;
    if (parse_all(without_plus(*text), value) && std::isfinite(value)) {
        if (std::fabs(value) <= largest_number) return value;
        return input_error_at(file, row.line, "{} \"{}\" is too large", what, text->substr(0, 40));
    }
    if (text->find(',') != std::string_view::npos)
        return input_error_at(file, row.line, "{} \"{}\" has a comma; write numbers with a decimal point", what,
                              text->substr(0, 40));
    return input_error_at(file, row.line, "{} \"{}\" is not a number", what, text->substr(0, 40));
}

Result<CsvTable> parse_csv(std::string_view text, const std::string& file, std::string_view example) {
    if (text.size() > most_bytes) return input_error("{}: over 64 MB is more than a table of measurements has", file);
    constexpr std::string_view mark = "\xEF\xBB\xBF";  // spreadsheets put it at the start of UTF-8 files
    if (text.substr(0, mark.size()) == mark) text.remove_prefix(mark.size());
    CsvTable table;
    table.file = file;
    char separator = ',';
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (is_passed_over(line)) continue;
        const bool is_header = table.columns.empty();
        if (is_header) separator = separator_of(line);
        std::vector<std::string> cells = split(line, separator);
        if (is_empty(cells)) continue;  // a spreadsheet writes an empty row as separators
        if (is_header) {
            table.columns = std::move(cells);
            table.header_line = number;
        } else {
            table.rows.push_back({number, std::move(cells)});
        }
    }
    if (table.columns.empty()) return input_error("{}: is empty; the first line names the columns: {}", file, example);
    if (table.rows.empty()) return input_error("{}: has no rows below the names of the columns", file);
    for (const CsvRow& row : table.rows) {
        if (surplus(row, table.columns.size()))
            return input_error_at(file, row.line, "{} columns, the first line names {}", row.cells.size(),
                                  table.columns.size());
    }
    return table;
}

std::string_view csv_unit(std::string_view column) {
    column = trimmed(column);
    const std::size_t open = start_of_unit(column);
    return open == std::string_view::npos ? std::string_view{}
                                          : trimmed(column.substr(open + 1, column.size() - open - 2));
}

std::string_view without_csv_unit(std::string_view column) {
    column = trimmed(column);
    return trimmed(column.substr(0, start_of_unit(column)));
}

std::string csv_field(std::string_view text) {
    const bool formula = begins_formula(text);
    const std::string out = fmt::format("{}{}", formula ? "'" : "", text);
    if (out.find_first_of(",\"\r\n") == std::string::npos) return out;
    std::string quoted = "\"";
    for (const char c : out) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + "\"";
}

std::string_view csv_name(std::string_view column) {
    return column.starts_with('\'') && begins_formula(column.substr(1)) ? column.substr(1) : column;
}

}  // namespace pliant

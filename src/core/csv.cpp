#include "core/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace pliant {
namespace {

constexpr std::size_t most_bytes = std::size_t{64} << 20;

std::string_view trim(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\"";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string> split(std::string_view line, char separator) {
    std::vector<std::string> cells;
    while (true) {
        const std::size_t end = line.find(separator);
        cells.emplace_back(trim(line.substr(0, end)));
        if (end == std::string_view::npos) return cells;
        line.remove_prefix(end + 1);
    }
}

char separator_of(std::string_view line) {
    for (const char separator : {'\t', ';'}) {
        if (line.find(separator) != std::string_view::npos) return separator;
    }
    return ',';
}

}  // namespace

std::string CsvTable::place(int line) const {
    return fmt::format("{}:{}", file, line);
}

Result<std::string_view> CsvTable::cell(const CsvRow& row, std::size_t column) const {
    if (column < row.cells.size()) return std::string_view(row.cells[column]);
    return input_error("{}: {} columns, the first line names more", place(row.line), row.cells.size());
}

Result<double> CsvTable::number(const CsvRow& row, std::size_t column, std::string_view what) const {
    const auto text = cell(row, column);
    if (!text) return tl::unexpected(text.error());
    const char* first = text->data();
    const char* last = first + text->size();
    if (first != last && *first == '+') ++first;
    double value = 0;
    const auto [end, code] = std::from_chars(first, last, value);
    if (code == std::errc() && end == last && std::isfinite(value)) return value;
    if (text->find(',') != std::string_view::npos)
        return input_error("{}: {} \"{}\" has a comma; write numbers with a decimal point", place(row.line), what,
                           text->substr(0, 40));
    return input_error("{}: {} \"{}\" is not a number", place(row.line), what, text->substr(0, 40));
}

Result<CsvTable> parse_csv(std::string_view text, const std::string& file, std::string_view example) {
    if (text.size() > most_bytes) return input_error("{}: over 64 MB is more than a table of measurements has", file);
    constexpr std::string_view mark = "\xEF\xBB\xBF";  // spreadsheets begin UTF-8 files with it
    if (text.substr(0, mark.size()) == mark) text.remove_prefix(mark.size());
    CsvTable table;
    table.file = file;
    char separator = ',';
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view content = trim(line);
        if (content.empty() || content.front() == '#') continue;
        if (table.columns.empty()) {
            separator = separator_of(line);
            table.columns = split(line, separator);
            table.header_line = number;
        } else {
            table.rows.push_back({number, split(line, separator)});
        }
    }
    if (table.columns.empty()) return input_error("{}: is empty; the first line names the columns: {}", file, example);
    if (table.rows.empty()) return input_error("{}: has no rows below the names of the columns", file);
    return table;
}

std::string_view csv_unit(std::string_view column) {
    const std::size_t open = column.find_first_of("([");
    const std::size_t close = column.find_last_of(")]");
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) return {};
    return trim(column.substr(open + 1, close - open - 1));
}

}  // namespace pliant

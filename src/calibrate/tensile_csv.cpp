#include "calibrate/tensile_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/units.hpp"

namespace pliant::calibrate {
namespace {

constexpr std::size_t most_bytes = std::size_t{64} << 20;

std::string_view trim(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\"";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> split(std::string_view line, char separator) {
    std::vector<std::string_view> cells;
    while (true) {
        const std::size_t end = line.find(separator);
        cells.push_back(trim(line.substr(0, end)));
        if (end == std::string_view::npos) return cells;
        line.remove_prefix(end + 1);
    }
}

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return result;
}

/// What stands in brackets at the end of a column's name.
std::string_view unit_of(std::string_view cell) {
    const std::size_t open = cell.find_first_of("([");
    const std::size_t close = cell.find_last_of(")]");
    if (open == std::string_view::npos || close == std::string_view::npos || close < open) return {};
    return trim(cell.substr(open + 1, close - open - 1));
}

/// Which columns hold the test, and what turns their numbers into stretch and Pa.
struct Columns {
    char separator = ',';
    std::size_t strain = 0;
    std::size_t stress = 0;
    bool is_stretch = false;
    double strain_factor = 1;
    double stress_factor = 1;
};

bool names(const std::string& cell, std::string_view word) {
    return cell.find(word) != std::string::npos;
}

/// Index of the first column that names `word` and is not of true (Cauchy, logarithmic) quantities.
std::optional<std::size_t> find_column(const std::vector<std::string>& cells, std::string_view word) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const bool other = names(cells[i], "true") || names(cells[i], "cauchy") || names(cells[i], "log");
        if (names(cells[i], word) && !other) return i;
    }
    return std::nullopt;
}

Result<Columns> read_header(std::string_view line, const std::string& place) {
    Columns columns;
    for (const char separator : {';', '\t'}) {
        if (line.find(separator) != std::string_view::npos) columns.separator = separator;
    }
    const auto cells = split(line, columns.separator);
    std::vector<std::string> low;
    low.reserve(cells.size());
    for (const std::string_view cell : cells) low.push_back(lower(cell));
    const auto stretch = find_column(low, "stretch");
    const auto strain = stretch ? stretch : find_column(low, "strain");
    const auto stress = find_column(low, "stress");
    if (!strain)
        return input_error("{}: no column is named \"stretch\" or \"strain\" (of the engineer, not true strain)",
                           place);
    if (!stress)
        return input_error("{}: no column is named \"stress\", as in \"stress (MPa)\" (nominal, not true stress)",
                           place);
    columns.strain = *strain;
    columns.stress = *stress;
    columns.is_stretch = stretch.has_value();
    const std::string_view strain_unit = unit_of(cells[*strain]);
    if (strain_unit == "%")
        columns.strain_factor = 0.01;
    else if (!strain_unit.empty() && strain_unit != "-" && strain_unit != "1" && strain_unit != "mm/mm")
        return input_error("{}: unknown unit \"{}\" of strain; it is a pure number, or %", place, strain_unit);
    const std::string_view unit = unit_of(cells[*stress]);
    if (unit.empty()) return input_error("{}: the stress has no unit; write \"stress (MPa)\"", place);
    const Result<double> factor = unit_factor(unit, Dimension::pressure);
    if (!factor) return input_error("{}: stress: {}", place, factor.error().message);
    columns.stress_factor = *factor;
    return columns;
}

Result<double> read_number(std::string_view cell, const std::string& place, std::string_view what) {
    const char* first = cell.data();
    const char* last = first + cell.size();
    if (first != last && *first == '+') ++first;
    double value = 0;
    const auto [end, code] = std::from_chars(first, last, value);
    if (code == std::errc() && end == last && std::isfinite(value)) return value;
    if (cell.find(',') != std::string_view::npos)
        return input_error("{}: {} \"{}\" has a comma; write numbers with a decimal point", place, what, cell);
    return input_error("{}: {} \"{}\" is not a number", place, what, cell.substr(0, 40));
}

Status read_row(std::string_view line, const Columns& columns, const std::string& place, TensileTest& test) {
    const auto cells = split(line, columns.separator);
    if (cells.size() <= std::max(columns.strain, columns.stress))
        return input_error("{}: {} columns, the first line names more", place, cells.size());
    const Result<double> strain = read_number(cells[columns.strain], place, columns.is_stretch ? "stretch" : "strain");
    if (!strain) return tl::unexpected(strain.error());
    const Result<double> stress = read_number(cells[columns.stress], place, "stress");
    if (!stress) return tl::unexpected(stress.error());
    const double stretch = *strain * columns.strain_factor + (columns.is_stretch ? 0 : 1);
    if (!(stretch > 0 && stretch <= 100))
        return input_error("{}: the stretch is {:.4g}; it is length over rest length, between 0 and 100{}", place,
                           stretch, columns.is_stretch ? "" : ", and the strain is it less one");
    test.stretch.push_back(stretch);
    test.stress_Pa.push_back(*stress * columns.stress_factor);
    return {};
}

}  // namespace

Result<TensileTest> parse_tensile_csv(std::string_view text, const std::string& file) {
    if (text.size() > most_bytes) return input_error("{}: over 64 MB is no tensile test", file);
    constexpr std::string_view mark = "\xEF\xBB\xBF";  // spreadsheets begin UTF-8 files with it
    if (text.substr(0, mark.size()) == mark) text.remove_prefix(mark.size());
    TensileTest test;
    std::optional<Columns> columns;
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view content = trim(line);
        if (content.empty() || content.front() == '#') continue;
        const std::string place = fmt::format("{}:{}", file, number);
        if (!columns) {
            const Result<Columns> header = read_header(line, place);
            if (!header) return tl::unexpected(header.error());
            columns = *header;
        } else if (Status status = read_row(line, *columns, place, test); !status) {
            return tl::unexpected(status.error());
        }
    }
    if (!columns) return input_error("{}: is empty; the first line names the columns: stretch,stress (MPa)", file);
    if (test.stretch.empty()) return input_error("{}: has no rows below the names of the columns", file);
    return test;
}

}  // namespace pliant::calibrate

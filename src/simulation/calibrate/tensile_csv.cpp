#include "simulation/calibrate/tensile_csv.hpp"

#include <optional>

#include "base/core/csv.hpp"
#include "base/core/units.hpp"
#include "simulation/calibrate/named_column.hpp"

namespace pliant::calibrate {
namespace {

/// The columns of the test, and their factors to stretch and Pa.
struct Columns {
    std::size_t strain = 0;
    std::size_t stress = 0;
    bool is_stretch = false;
    bool has_strain_unit = false;
    double strain_factor = 1;
    double stress_factor = 1;
};

/// "strain rate", "strainrate" and "rate of strain" are, "calibrated strain" is not.
bool is_rate(std::string_view column, std::string_view word) {
    constexpr std::string_view rate = "rate";
    const auto is_letter = [&](std::size_t at) { return at < column.size() && column[at] >= 'a' && column[at] <= 'z'; };
    for (std::size_t at = column.find(rate); at != std::string_view::npos; at = column.find(rate, at + 1)) {
        const bool begins = at == 0 || !is_letter(at - 1) || column.substr(0, at).ends_with(word);
        if (begins && !is_letter(at + rate.size())) return true;
    }
    return false;
}

/// The column of `word`: not one of true (Cauchy, logarithmic) quantities, nor of a rate of it.
Result<std::optional<std::size_t>> find_column(const CsvTable& table, std::string_view word) {
    return named_column(table, word, [&](std::string_view column) {
        const auto names = [&](std::string_view part) { return column.find(part) != std::string_view::npos; };
        return names(word) && !names("true") && !names("cauchy") && !names("log") && !is_rate(column, word);
    });
}

Result<Columns> read_header(const CsvTable& table) {
    Columns columns;
    const auto stretch = find_column(table, "stretch");
    if (!stretch) return tl::unexpected(stretch.error());
    const auto strain = *stretch ? stretch : find_column(table, "strain");
    if (!strain) return tl::unexpected(strain.error());
    const auto stress = find_column(table, "stress");
    if (!stress) return tl::unexpected(stress.error());
    if (!*strain)
        return input_error_at(table.file, table.header_line,
                              "no column is named \"stretch\" or \"strain\" (engineering strain, not true strain)");
    if (!*stress)
        return input_error_at(table.file, table.header_line,
                              "no column is named \"stress\", as in \"stress (MPa)\" (nominal, not true stress)");
    columns.strain = **strain;
    columns.stress = **stress;
    columns.is_stretch = stretch->has_value();
    const std::string& strain_column = table.columns[columns.strain];
    const std::string_view strain_unit = csv_unit(strain_column);
    if (strain_unit.empty() && strain_column.find_first_of("([") != std::string::npos)
        return input_error_at(table.file, table.header_line, "column \"{}\": a unit stands in brackets at its end",
                              strain_column);
    columns.has_strain_unit = !strain_unit.empty();
    if (strain_unit == "%")
        columns.strain_factor = 0.01;
    else if (!strain_unit.empty() && strain_unit != "-" && strain_unit != "1" && strain_unit != "mm/mm")
        return input_error_at(table.file, table.header_line, "unknown unit \"{}\" of strain; it is a pure number, or %",
                              strain_unit);
    const std::string_view unit = csv_unit(table.columns[columns.stress]);
    if (unit.empty())
        return input_error_at(table.file, table.header_line, "the stress has no unit; write \"stress (MPa)\"");
    const Result<double> factor = unit_factor(unit, Dimension::pressure);
    if (!factor) return input_error_at(table.file, table.header_line, "stress: {}", factor.error().message);
    columns.stress_factor = *factor;
    return columns;
}

Status read_row(const CsvTable& table, const CsvRow& row, const Columns& columns, TensileTest& test) {
    const Result<double> strain = table.number(row, columns.strain, columns.is_stretch ? "stretch" : "strain");
    if (!strain) return tl::unexpected(strain.error());
    const Result<double> stress = table.number(row, columns.stress, "stress");
    if (!stress) return tl::unexpected(stress.error());
    const double stretch = *strain * columns.strain_factor + (columns.is_stretch ? 0 : 1);
    if (!(stretch > 0 && stretch <= 100))
        return input_error_at(table.file, row.line,
                              "the stretch is {:.4g}; it is length over rest length, between 0 and 100{}", stretch,
                              columns.is_stretch ? "" : ", and the strain is the stretch less 1");
    // The softest silicones tear at a strain of 10. A table in percent is easily written without its unit.
    constexpr double torn = 12;
    if (!columns.is_stretch && !columns.has_strain_unit && *strain > torn)
        return input_error_at(table.file, row.line,
                              "a strain of {:.6g} is {:.6g} %; name the column \"strain (%)\" if it is in percent, "
                              "\"strain (-)\" if not",
                              *strain, 100 * *strain);
    test.stretch.push_back(stretch);
    test.stress_Pa.push_back(*stress * columns.stress_factor);
    return {};
}

}  // namespace

Result<TensileTest> parse_tensile_csv(std::string_view text, const std::string& file) {
    const auto table = parse_csv(text, file, "stretch,stress (MPa)");
    if (!table) return tl::unexpected(table.error());
    const Result<Columns> columns = read_header(*table);
    if (!columns) return tl::unexpected(columns.error());
    TensileTest test;
    for (const CsvRow& row : table->rows) {
        if (Status status = read_row(*table, row, *columns, test); !status) return tl::unexpected(status.error());
    }
    return test;
}

}  // namespace pliant::calibrate

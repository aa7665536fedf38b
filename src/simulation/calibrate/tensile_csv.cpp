#include "simulation/calibrate/tensile_csv.hpp"

#include <optional>

#include "base/core/csv.hpp"
#include "base/core/letters.hpp"
#include "base/core/units.hpp"

namespace pliant::calibrate {
namespace {

/// The columns of the test, and their factors to stretch and Pa.
struct Columns {
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

Result<Columns> read_header(const CsvTable& table) {
    Columns columns;
    std::vector<std::string> low;
    low.reserve(table.columns.size());
    for (const std::string& column : table.columns) low.push_back(lower_case(column));
    const auto stretch = find_column(low, "stretch");
    const auto strain = stretch ? stretch : find_column(low, "strain");
    const auto stress = find_column(low, "stress");
    if (!strain)
        return input_error_at(table.file, table.header_line,
                              "no column is named \"stretch\" or \"strain\" (engineering strain, not true strain)");
    if (!stress)
        return input_error_at(table.file, table.header_line,
                              "no column is named \"stress\", as in \"stress (MPa)\" (nominal, not true stress)");
    columns.strain = *strain;
    columns.stress = *stress;
    columns.is_stretch = stretch.has_value();
    const std::string& strain_column = table.columns[*strain];
    const std::string_view strain_unit = csv_unit(strain_column);
    if (strain_unit.empty() && strain_column.find_first_of("([") != std::string::npos)
        return input_error_at(table.file, table.header_line, "column \"{}\": a unit stands in brackets at its end",
                              strain_column);
    if (strain_unit == "%")
        columns.strain_factor = 0.01;
    else if (!strain_unit.empty() && strain_unit != "-" && strain_unit != "1" && strain_unit != "mm/mm")
        return input_error_at(table.file, table.header_line, "unknown unit \"{}\" of strain; it is a pure number, or %",
                              strain_unit);
    const std::string_view unit = csv_unit(table.columns[*stress]);
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

#include "simulation/calibrate/elongation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/core/csv.hpp"
#include "robot/description/law.hpp"
#include "simulation/calibrate/named_column.hpp"
#include "simulation/calibrate/ratio.hpp"

namespace pliant::calibrate {
namespace {

double nominal_shape(double stretch) {
    return stretch - 1 / (stretch * stretch);
}

/// The columns of a test, and their factors to m.
struct ElongationColumns {
    static constexpr std::array<std::string_view, 4> names = {"length", "interface", "elongation", "joint"};
    std::array<std::size_t, 4> at{};
    std::array<double, 4> factor{};
};

Result<ElongationColumns> read_elongation_header(const CsvTable& table) {
    ElongationColumns columns;
    for (std::size_t i = 0; i < ElongationColumns::names.size(); ++i) {
        const std::string_view name = ElongationColumns::names[i];
        const auto found = named_column(table, name, [&](std::string_view column) { return column.starts_with(name); });
        if (!found) return tl::unexpected(found.error());
        if (!*found)
            return input_error_at(table.file, table.header_line, "no column is named \"{}\", as in \"{} (mm)\"", name,
                                  name);
        const std::string_view unit = csv_unit(table.columns[**found]);
        if (unit.empty())
            return input_error_at(table.file, table.header_line, "{} has no unit; write \"{} (mm)\"", name, name);
        const Result<double> factor = unit_factor(unit, Dimension::length);
        if (!factor) return input_error_at(table.file, table.header_line, "{}: {}", name, factor.error().message);
        columns.at[i] = **found;
        columns.factor[i] = *factor;
    }
    return columns;
}

Result<ElongationRow> read_elongation_row(const CsvTable& table, const CsvRow& row, const ElongationColumns& columns) {
    std::array<double, 4> m{};
    for (std::size_t i = 0; i < m.size(); ++i) {
        const Result<double> value = table.number(row, columns.at[i], ElongationColumns::names[i]);
        if (!value) return tl::unexpected(value.error());
        m[i] = *value * columns.factor[i];
    }
    Result<ElongationRow> result = evaluate({m[0], m[1], m[2], m[3]});
    if (!result) return input_error_at(table.file, row.line, "{}", result.error().message);
    return result;
}

}  // namespace

Result<ElongationRow> evaluate(const ElongationTest& t) {
    if (!(t.length_m > 0 && t.length_m < 1e3))
        return input_error("length: {:g} mm is not possible; a bar is longer than 0", t.length_m * 1e3);
    if (!(t.interface_m > 0 && t.interface_m < t.length_m))
        return input_error("interface: {:g} mm is not within the bar; it lies between 0 and its length, {:g} mm",
                           t.interface_m * 1e3, t.length_m * 1e3);
    if (!(t.elongation_m > 0 && t.elongation_m <= 10 * t.length_m))
        return input_error("elongation: {:g} mm is not between 0 and ten times the length", t.elongation_m * 1e3);
    if (!(t.joint_m > 0 && t.joint_m < t.elongation_m))
        return input_error("joint: {:g} mm is not possible; the joint moves by less than the end, {:g} mm",
                           t.joint_m * 1e3, t.elongation_m * 1e3);
    const double strain_A = t.joint_m / t.interface_m;
    const double strain_B = (t.elongation_m - t.joint_m) / (t.length_m - t.interface_m);
    return ElongationRow{t, strain_B / strain_A, nominal_shape(1 + strain_B) / nominal_shape(1 + strain_A), {}};
}

Result<double> match_shape_parameter(const ElongationTest& test, Progress& progress, std::array<int, 3> cells) {
    const Result<ElongationRow> row = evaluate(test);
    if (!row) return tl::unexpected(row.error());
    // In the bar of ratio.hpp the stiff part is held; if the softer one is, look at the test from its other end.
    const bool held_is_soft = row->neo_hookean < 1;
    RatioOptions options;
    options.cells = cells;
    options.strain = row->strain();
    options.interface = test.interface_m / test.length_m;
    double joint = test.joint_m / test.length_m;
    if (held_is_soft) {
        options.interface = 1 - options.interface;
        joint = options.strain - joint;
    }
    if (Status status = check_bar(options); !status) return tl::unexpected(status.error());
    constexpr double bar_mm = 100;
    const double guess = material::shape_parameter_small_strain(std::max(row->neo_hookean, 1 / row->neo_hookean));
    return match_shape_parameter(options, joint * bar_mm, guess, progress);
}

Result<std::vector<ElongationRow>> parse_elongation_csv(std::string_view text, const std::string& file) {
    const auto table = parse_csv(text, file, "length (mm),interface (mm),elongation (mm),joint (mm)");
    if (!table) return tl::unexpected(table.error());
    const auto columns = read_elongation_header(*table);
    if (!columns) return tl::unexpected(columns.error());
    std::vector<ElongationRow> rows;
    for (const CsvRow& row : table->rows) {
        auto result = read_elongation_row(*table, row, *columns);
        if (!result) return tl::unexpected(result.error());
        rows.push_back(*result);
    }
    return rows;
}

}  // namespace pliant::calibrate

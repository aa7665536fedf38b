#include "simulation/calibrate/named_column.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "base/core/letters.hpp"
#include "base/core/text.hpp"

namespace pliant::calibrate {
namespace {

/// In lower case and without its unit.
std::string plain_name(const std::string& column) {
    return lower_case(without_csv_unit(column));
}

}  // namespace

Result<std::optional<std::size_t>> named_column(const CsvTable& table, std::string_view name,
                                                const std::function<bool(std::string_view)>& may_be) {
    std::vector<std::size_t> exact, possible;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (plain_name(table.columns[i]) == name) exact.push_back(i);
        if (may_be(lower_case(table.columns[i]))) possible.push_back(i);
    }
    const std::vector<std::size_t>& found = exact.empty() ? possible : exact;
    if (found.empty()) return std::nullopt;
    if (found.size() == 1) return found.front();
    std::vector<std::string> names;
    for (const std::size_t i : found) names.push_back(fmt::format("\"{}\"", table.columns[i]));
    return input_error_at(table.file, table.header_line, "{} could each be the {}; name one of them \"{}\"{}",
                          join_names(names), name, name, exact.empty() ? ", with its unit" : ", and the others not");
}

}  // namespace pliant::calibrate

#include "printing/prepare/paint_file.hpp"

#include <algorithm>
#include <array>

#include "base/core/csv.hpp"

namespace pliant::prepare {
namespace {

constexpr std::size_t most_touches = 100000;
constexpr std::array<const char*, 8> column_names = {"wish", "x (mm)", "y (mm)", "z (mm)",
                                                     "nx",   "ny",     "nz",     "radius (mm)"};
using Columns = std::array<std::size_t, column_names.size()>;

Result<Columns> columns_of(const CsvTable& table) {
    Columns columns{};
    for (std::size_t i = 0; i < column_names.size(); ++i) {
        const auto found = std::find(table.columns.begin(), table.columns.end(), column_names[i]);
        if (found == table.columns.end())
            return input_error_at(table.file, table.header_line, "there is no column \"{}\"", column_names[i]);
        columns[i] = static_cast<std::size_t>(found - table.columns.begin());
    }
    return columns;
}

Result<slice::SupportWish> wish_of(const CsvTable& table, const CsvRow& row, std::string_view word) {
    if (word == "enforce") return slice::SupportWish::enforce;
    if (word == "block") return slice::SupportWish::block;
    if (word == "usual") return slice::SupportWish::usual;
    return input_error_at(table.file, row.line, "\"{}\" must be enforce, block or usual", word);
}

Result<slice::SupportTouch> touch_of(const CsvTable& table, const CsvRow& row, const Columns& columns) {
    const auto word = table.cell(row, columns[0]);
    if (!word) return tl::unexpected(word.error());
    const auto wish = wish_of(table, row, *word);
    if (!wish) return tl::unexpected(wish.error());
    std::array<double, 7> n{};
    for (std::size_t i = 0; i < n.size(); ++i) {
        const Result<double> read = table.number(row, columns[i + 1], column_names[i + 1]);
        if (!read) return tl::unexpected(read.error());
        n[i] = *read;
    }
    constexpr double um = 1000;
    const slice::SupportTouch touch{*wish, {um * n[0], um * n[1], um * n[2]}, {n[3], n[4], n[5]}, um * n[6]};
    if (Status status = slice::check(touch); !status)
        return input_error_at(table.file, row.line, "{}", status.error().message);
    return touch;
}

}  // namespace

Result<std::vector<slice::SupportTouch>> read_paint(std::string_view text, const std::string& file) {
    const auto table =
        parse_csv(text, file, "wish,x (mm),y (mm),z (mm),nx,ny,nz,radius (mm)\nenforce,10,5,0,0,0,-1,2\n");
    if (!table) return tl::unexpected(table.error());
    const auto columns = columns_of(*table);
    if (!columns) return tl::unexpected(columns.error());
    if (table->rows.size() > most_touches)
        return input_error("{}: more than {} touches of the brush", file, most_touches);
    std::vector<slice::SupportTouch> touches;
    for (const CsvRow& row : table->rows) {
        auto touch = touch_of(*table, row, *columns);
        if (!touch) return tl::unexpected(touch.error());
        touches.push_back(*touch);
    }
    return touches;
}

}  // namespace pliant::prepare

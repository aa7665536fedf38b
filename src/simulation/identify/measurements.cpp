#include "simulation/identify/measurements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/core/csv.hpp"
#include "base/core/text.hpp"

namespace pliant::sim::identify {
namespace {

constexpr std::string_view scatter_ending = "_scatter";
/// Columns of steps.csv and markers.csv about the run, not about the robot.
constexpr std::array<std::string_view, 9> passed_over = {
    "index", "converged", "iterations", "substeps", "residual", "wall_ms", "min_J", "solver", "smallest_distance_mm"};

/// Columns of a channel.
struct Columns {
    std::size_t value = 0;
    std::optional<std::size_t> scatter;
};

struct Header {
    std::optional<std::size_t> time, step, use;
    std::vector<Channel> channels;
    std::vector<Columns> columns;  ///< (channels)
    std::vector<std::string> not_compared;
};

tl::unexpected<Error> no_such_column(const CsvTable& table, const sim::Description& robot, const std::string& column) {
    std::vector<std::string> names = {"time", "step", "use"};
    for (const Channel& channel : plain_channels(robot)) names.push_back(channel.column);
    const std::string nearest = nearest_name(column, names);
    if (!nearest.empty())
        return input_error_at(table.file, table.header_line,
                              "the robot has nothing that column \"{}\" could be; did you mean \"{}\"?", column,
                              nearest);
    return input_error_at(table.file, table.header_line, "the robot has nothing that column \"{}\" could be; it has {}",
                          column, join_names(names));
}

Status read_scatters(const CsvTable& table, Header& header) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        std::string_view name = table.columns[c];
        if (!name.ends_with(scatter_ending)) continue;
        name.remove_suffix(scatter_ending.size());
        auto of = std::ranges::find(header.channels, name, &Channel::column);
        if (of == header.channels.end()) of = std::ranges::find(header.channels, csv_name(name), &Channel::column);
        if (std::ranges::count(header.not_compared, csv_name(name)) > 0) continue;
        if (of == header.channels.end())
            return input_error_at(table.file, table.header_line,
                                  "column \"{}\" is the scatter of \"{}\", which is not a column of the table",
                                  table.columns[c], name);
        header.columns[static_cast<std::size_t>(of - header.channels.begin())].scatter = c;
    }
    return {};
}

Status read_column(const CsvTable& table, std::size_t c, const sim::Description& robot, Header& header) {
    const std::string& name = table.columns[c];
    if (std::ranges::count(table.columns, name) > 1)
        return input_error_at(table.file, table.header_line, "there are two columns \"{}\"", name);
    if (name == "time") return header.time = c, Status{};
    if (name == "step") return header.step = c, Status{};
    if (name == "use") return header.use = c, Status{};
    std::optional<Channel> channel = find_channel(robot, name);
    if (!channel) channel = find_channel(robot, csv_name(name));
    if (channel) {
        if (std::ranges::count(header.channels, channel->column, &Channel::column) > 0)
            return input_error_at(table.file, table.header_line, "there are two columns \"{}\"", channel->column);
        header.channels.push_back(std::move(*channel));
        header.columns.push_back({c, {}});
        return {};
    }
    const std::vector<std::string> others = other_columns(robot);
    if (std::ranges::count(others, name) + std::ranges::count(others, csv_name(name)) > 0) {
        header.not_compared.emplace_back(csv_name(name));
        return {};
    }
    const bool known = name.ends_with(scatter_ending) || std::ranges::count(passed_over, name) > 0;
    if (!known) return no_such_column(table, robot, name);
    return {};
}

Result<Header> read_header(const CsvTable& table, const sim::Description& robot) {
    Header header;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        if (Status status = read_column(table, c, robot, header); !status) return tl::unexpected(status.error());
    }
    if (!header.step) {
        const auto index = std::ranges::find(table.columns, "index");
        if (index != table.columns.end()) header.step = static_cast<std::size_t>(index - table.columns.begin());
    }
    if (!header.time && !header.step)
        return input_error_at(table.file, table.header_line,
                              "no column \"time\" or \"step\" says when each row was measured");
    if (header.channels.empty()) {
        std::vector<std::string> names;
        for (const Channel& channel : plain_channels(robot)) names.push_back(channel.column);
        return input_error_at(table.file, table.header_line, "no column holds a measured value; possible are {}",
                              join_names(names));
    }
    if (Status status = read_scatters(table, header); !status) return tl::unexpected(status.error());
    return header;
}

Result<double> read_time(const CsvTable& table, const CsvRow& row, const Header& header,
                         const robot::Program& program) {
    const std::optional<std::size_t> columns[] = {header.time, header.step};
    std::optional<std::size_t> filled;
    for (const auto& column : columns) {
        if (!column || filled) continue;
        const auto cell = table.cell(row, *column);
        if (!cell) return tl::unexpected(cell.error());
        if (!cell->empty()) filled = column;
    }
    if (!filled && header.time && header.step)
        return input_error_at(table.file, row.line, "{} and {} are empty; every row needs one of them",
                              table.columns[*header.time], table.columns[*header.step]);
    if (!filled)
        return input_error_at(table.file, row.line, "{} is empty; every row needs one",
                              table.columns[header.time ? *header.time : *header.step]);
    const std::size_t column = *filled;
    const bool in_time = header.time && column == *header.time;
    const std::string& name = table.columns[column];
    const auto number = table.number(row, column, name);
    if (!number) return number;
    const double end = in_time ? program.duration : program.steps;
    const double rounding = 1e-9 * end;
    if (!(*number >= 0 && *number <= end + rounding))
        return input_error_at(table.file, row.line, "{} {:g} is outside the program, which goes from 0 to {:g}", name,
                              *number, end);
    return std::min(in_time ? *number : *number * program.duration / program.steps, program.duration);
}

Result<bool> read_use(const CsvTable& table, const CsvRow& row, std::size_t column) {
    const auto cell = table.cell(row, column);
    if (!cell) return tl::unexpected(cell.error());
    if (*cell == "fit" || *cell == "judge") return *cell == "judge";
    return input_error_at(table.file, row.line, "use \"{}\" is neither fit nor judge", cell->substr(0, 40));
}

/// Empty if the cell is empty.
Result<std::optional<MeasuredValue>> read_value(const CsvTable& table, const CsvRow& row, const Header& header,
                                                std::size_t channel) {
    const Columns& at = header.columns[channel];
    const auto cell = table.cell(row, at.value);
    if (!cell) return tl::unexpected(cell.error());
    if (cell->empty()) return std::nullopt;
    const auto value = table.number(row, at.value, header.channels[channel].column);
    if (!value) return tl::unexpected(value.error());
    MeasuredValue measured{row.line, 0, channel, *value};
    if (!at.scatter) return measured;
    const std::string& name = table.columns[*at.scatter];
    const auto given = table.cell(row, *at.scatter);
    if (!given) return tl::unexpected(given.error());
    if (given->empty())
        return input_error_at(table.file, row.line, "{} is empty, but {} has a value; give both or none", name,
                              header.channels[channel].column);
    const auto scatter = table.number(row, *at.scatter, name);
    if (!scatter) return tl::unexpected(scatter.error());
    if (!(*scatter > 0))
        return input_error_at(table.file, row.line, "{} {:g} is not possible; a scatter is above zero", name, *scatter);
    measured.scatter = *scatter;
    return measured;
}

bool is_judged(JudgeOn judge, std::size_t row, std::size_t rows) {
    if (judge == JudgeOn::every_second) return row % 2 == 1;
    return judge == JudgeOn::second_half && row >= (rows + 1) / 2;
}

Status read_row(const CsvTable& table, std::size_t r, const Header& header, const robot::Program& program,
                JudgeOn judge, std::vector<MeasuredValue>& values) {
    const CsvRow& row = table.rows[r];
    const auto time = read_time(table, row, header, program);
    if (!time) return tl::unexpected(time.error());
    bool judged = is_judged(judge, r, table.rows.size());
    if (header.use && judge == JudgeOn::nothing) {
        const auto use = read_use(table, row, *header.use);
        if (!use) return tl::unexpected(use.error());
        judged = *use;
    }
    for (std::size_t c = 0; c < header.channels.size(); ++c) {
        auto value = read_value(table, row, header, c);
        if (!value) return tl::unexpected(value.error());
        if (!*value) continue;
        (*value)->time = *time;
        (*value)->judged = judged;
        values.push_back(**value);
    }
    return {};
}

}  // namespace

Result<Measurements> parse_measurements(std::string_view text, const std::string& file, const sim::Description& robot,
                                        const robot::Program& program, JudgeOn judge) {
    const auto table = parse_csv(text, file, "time,tip_x_mm,tip_y_mm,tip_z_mm");
    if (!table) return tl::unexpected(table.error());
    const auto header = read_header(*table, robot);
    if (!header) return tl::unexpected(header.error());
    Measurements result{file, header->channels, {}, header->not_compared};
    for (std::size_t r = 0; r < table->rows.size(); ++r) {
        if (Status status = read_row(*table, r, *header, program, judge, result.values); !status)
            return tl::unexpected(status.error());
    }
    if (std::ranges::all_of(result.values, &MeasuredValue::judged))
        return input_error("{}: {}", file,
                           result.values.empty() ? "no row has a value" : "all rows are held out, none is left to fit");
    return result;
}

}  // namespace pliant::sim::identify

#include "loop/study/outcome.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "base/core/json.hpp"
#include "base/zip/zip_file.hpp"
#include "loop/study/npy.hpp"
#include "loop/study/values.hpp"

namespace pliant::study {
namespace {

namespace fs = std::filesystem;

/// A cell in the format of RFC 4180.
std::string cell(const std::string& text) {
    if (text.find_first_of(",\"\r\n;\t#") == std::string::npos && !text.empty()) return text;
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c == '\n' || c == '\r' ? ' ' : c;
    }
    return quoted + "\"";
}

std::string number_cell(double number) {
    return std::isfinite(number) ? number_text(number) : "";
}

/// A result of every row; NaN if missing.
std::vector<double> result_of(const Plan& plan, const Collected& rows, std::size_t result) {
    std::vector<double> values(plan.rows.size(), std::nan(""));
    for (std::size_t row = 0; row < values.size(); ++row) {
        if (rows.rows[row] && rows.rows[row]->done) values[row] = rows.rows[row]->values[result];
    }
    return values;
}

std::string_view status_of(const std::optional<RowRecord>& row) {
    if (!row) return "missing";
    return row->done ? "done" : "failed";
}

ResultFigures figures(const std::string& name, const std::vector<double>& values) {
    ResultFigures found;
    found.name = name;
    double sum = 0;
    for (const double value : values) {
        if (!std::isfinite(value)) continue;
        found.least = found.count == 0 ? value : std::min(found.least, value);
        found.most = found.count == 0 ? value : std::max(found.most, value);
        sum += value;
        ++found.count;
    }
    if (found.count == 0) return found;
    found.mean = sum / static_cast<double>(found.count);
    double squares = 0;
    for (const double value : values) squares += std::isfinite(value) ? (value - found.mean) * (value - found.mean) : 0;
    found.deviation = found.count > 1 ? std::sqrt(squares / static_cast<double>(found.count - 1)) : 0;
    return found;
}

nlohmann::json json_of(const Index& index) {
    return {{"value", index.value}, {"low", index.low}, {"high", index.high}};
}

nlohmann::json json_of(const Plan& plan, const ResultFigures& result) {
    nlohmann::json json = {{"rows", result.count}};
    if (result.count > 0) {
        json["least"] = result.least;
        json["most"] = result.most;
        json["mean"] = result.mean;
        json["standard_deviation"] = result.deviation;
    }
    if (plan.design != Design::sensitivity) return json;
    nlohmann::json indices = nlohmann::json::object();
    for (std::size_t k = 0; k < result.sensitivity.keys.size(); ++k)
        indices[plan.keys[k].name] = {{"first", json_of(result.sensitivity.keys[k].first)},
                                      {"total", json_of(result.sensitivity.keys[k].total)}};
    json["sensitivity"] = {
        {"samples", result.sensitivity.samples}, {"variance", result.sensitivity.variance}, {"keys", indices}};
    return json;
}

nlohmann::json account_json(const Collected& rows, const RunAccount* account) {
    double wall_s = 0, cpu_s = 0;
    for (const auto& row : rows.rows) {
        wall_s += row ? row->wall_s : 0;
        cpu_s += row ? row->cpu_s : 0;
    }
    nlohmann::json json = {{"rows_wall_s", wall_s}, {"rows_cpu_s", cpu_s}, {"chunks", rows.tasks.size()}};
    nlohmann::json places = nlohmann::json::object();
    for (const TaskRecord& task : rows.tasks) {
        nlohmann::json& place = places[task.place];
        if (place.is_null()) place = {{"wall_s", 0.0}, {"cpu_s", 0.0}};
        place["wall_s"] = place["wall_s"].get<double>() + task.wall_s;
        place["cpu_s"] = place["cpu_s"].get<double>() + task.cpu_s;
    }
    json["places"] = places;
    if (account != nullptr)
        json["this_run"] = {{"rows", account->rows},
                            {"wall_s", account->wall_s},
                            {"rows_cpu_s", account->rows_cpu_s},
                            {"processes_cpu_s", account->workers_cpu_s}};
    return json;
}

/// The values of a key: as numbers if all are numbers, else as texts.
std::string key_array(const Plan& plan, std::size_t k) {
    if (plan.keys[k].numeric) {
        std::vector<double> numbers;
        for (const auto& row : plan.rows) {
            const auto measure = read_measure(row[k]);
            numbers.push_back(measure ? measure->number : std::nan(""));
        }
        return npy_numbers(numbers);
    }
    std::vector<std::string> texts;
    for (const auto& row : plan.rows) texts.push_back(row[k]);
    return npy_texts(texts);
}

Status write_npz(const Plan& plan, const fs::path& path, const Collected& rows) {
    auto zip = ZipWriter::create(path);
    if (!zip) return tl::unexpected(zip.error());
    Status status;
    const auto add = [&](const std::string& name, const std::string& bytes) {
        if (status) status = zip->add(name + ".npy", bytes, ZipWriter::Method::store);
    };
    for (std::size_t k = 0; k < plan.keys.size(); ++k) add("key." + plan.keys[k].name, key_array(plan, k));
    for (std::size_t k = 0; k < plan.results.size(); ++k)
        add("result." + plan.results[k].name, npy_numbers(result_of(plan, rows, k)));
    std::vector<bool> done;
    std::vector<std::string> reasons, warnings;
    for (const auto& row : rows.rows) {
        done.push_back(row && row->done);
        reasons.push_back(row ? row->reason : "");
        warnings.push_back(row ? row->warning : "");
    }
    add("done", npy_truths(done));
    constexpr std::size_t most_letters = 200;  // the whole texts are in results.csv
    add("reason", npy_texts(reasons, most_letters));
    add("warning", npy_texts(warnings, most_letters));
    return status ? zip->close() : status;
}

}  // namespace

std::string column_of(const Key& key) {
    return key.unit.empty() ? key.name : fmt::format("{} ({})", key.name, key.unit);
}

std::vector<ResultFigures> figures_of(const Plan& plan, const Collected& rows) {
    std::vector<ResultFigures> all;
    for (std::size_t k = 0; k < plan.results.size(); ++k) {
        const std::vector<double> values = result_of(plan, rows, k);
        all.push_back(figures(plan.results[k].name, values));
        if (plan.design == Design::sensitivity) all.back().sensitivity = sobol_indices(values, plan.keys.size());
    }
    return all;
}

std::string results_csv(const Plan& plan, const Collected& rows) {
    std::string text = "row";
    for (const Key& key : plan.keys) text += "," + cell(column_of(key));
    for (const Wanted& wanted : plan.results) text += "," + cell(wanted.name);
    text += ",status,reason,warning\n";
    const auto words = [](const std::string& some) { return some.empty() ? "" : cell(some); };
    for (std::size_t row = 0; row < plan.rows.size(); ++row) {
        const auto& record = rows.rows[row];
        text += fmt::format("{}", row);
        for (const std::string& value : plan.rows[row]) text += "," + cell(value);
        for (std::size_t k = 0; k < plan.results.size(); ++k)
            text += "," + (record && record->done ? number_cell(record->values[k]) : "");
        text += fmt::format(",{},{},{}\n", status_of(record), record ? words(record->reason) : "",
                            record ? words(record->warning) : "");
    }
    return text;
}

std::string times_csv(const Collected& rows) {
    std::string text = "row,wall_s,cpu_s\n";
    for (std::size_t row = 0; row < rows.rows.size(); ++row) {
        const auto& record = rows.rows[row];
        if (record) text += fmt::format("{},{:.6f},{:.6f}\n", row, record->wall_s, record->cpu_s);
    }
    return text;
}

std::string sensitivity_csv(const Plan& plan, const std::vector<ResultFigures>& figures) {
    if (plan.design != Design::sensitivity) return "";
    std::string text = "result,key,first,first_low,first_high,total,total_low,total_high\n";
    for (const ResultFigures& result : figures) {
        for (std::size_t k = 0; k < result.sensitivity.keys.size(); ++k) {
            const auto& [first, total] = result.sensitivity.keys[k];
            text += fmt::format("{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", cell(result.name),
                                cell(plan.keys[k].name), first.value, first.low, first.high, total.value, total.low,
                                total.high);
        }
    }
    return text;
}

std::string summary_json(const Plan& plan, const Collected& rows, const std::vector<ResultFigures>& figures,
                         const RunAccount* account) {
    nlohmann::json keys = nlohmann::json::array(), results = nlohmann::json::object(),
                   failures = nlohmann::json::array(), warnings = nlohmann::json::array();
    for (const Key& key : plan.keys) keys.push_back({{"name", key.name}, {"unit", key.unit}});
    for (const ResultFigures& result : figures) results[result.name] = json_of(plan, result);
    constexpr std::size_t most_told = 100;
    for (const auto& row : rows.rows) {
        if (row && !row->done && failures.size() < most_told)
            failures.push_back({{"row", row->row}, {"reason", row->reason}});
        if (row && row->done && !row->warning.empty() && warnings.size() < most_told)
            warnings.push_back({{"row", row->row}, {"warning", row->warning}});
    }
    const nlohmann::json json = {{"pliant", plan.version},
                                 {"study", plan.study},
                                 {"command", plan.command},
                                 {"plan", name(plan.design)},
                                 {"rows", plan.rows.size()},
                                 {"done", rows.done},
                                 {"failed", rows.failed},
                                 {"warned", rows.warned},
                                 {"missing", plan.rows.size() - rows.recorded()},
                                 {"damaged_records", rows.damaged},
                                 {"doubled_records", rows.doubled},
                                 {"keys", keys},
                                 {"results", results},
                                 {"failures", failures},
                                 {"warnings", warnings},
                                 {"accounts", account_json(rows, account)}};
    return json_text(json, 2) + "\n";
}

Status write_outcome(const Plan& plan, const fs::path& folder, const Collected& rows,
                     const std::vector<ResultFigures>& figures, const std::string& summary) {
    Status status = write_file(folder / "results.csv", results_csv(plan, rows));
    if (status) status = write_file(folder / "times.csv", times_csv(rows));
    if (status && plan.design == Design::sensitivity)
        status = write_file(folder / "sensitivity.csv", sensitivity_csv(plan, figures));
    if (status) status = write_file(folder / "summary.json", summary);
    if (status) status = write_npz(plan, folder / "results.npz", rows);  // last: by far the largest
    return status;
}

}  // namespace pliant::study

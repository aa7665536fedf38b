// Output of an identification: text, JSON and CSV.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/csv.hpp"
#include "base/core/json.hpp"
#include "simulation/identify/identify.hpp"

namespace pliant::sim::identify {
namespace {

std::string unit_or_ratio(const std::string& unit) {
    return unit.empty() ? "1" : unit;
}

std::string interval(const Found& found) {
    if (!found.matters) return "(does not matter)";
    if (found.at_bound && found.low)
        return fmt::format("95 %: {} to {} (at its bound)", found.unknown.shown(*found.low),
                           found.unknown.shown(*found.high));
    if (found.at_bound) return "(at its bound)";
    if (!found.low) return "(no interval)";
    return fmt::format("95 %: {} to {}", found.unknown.shown(*found.low), found.unknown.shown(*found.high));
}

std::string error_line(const char* of, const Errors& e) {
    return fmt::format("{:<7} {:>5} values  rms error {:.4g} -> {:.4g}{}\n", of, e.values, e.before, e.after,
                       e.unit.empty() ? "" : " " + e.unit);
}

nlohmann::ordered_json number_or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

nlohmann::ordered_json errors_json(const std::vector<Errors>& all) {
    auto list = nlohmann::ordered_json::array();
    for (const Errors& e : all)
        list.push_back(
            {{"unit", unit_or_ratio(e.unit)}, {"values", e.values}, {"rms_before", e.before}, {"rms_after", e.after}});
    return list;
}

nlohmann::ordered_json unknowns_json(const Identification& result) {
    auto list = nlohmann::ordered_json::array();
    for (const Found& found : result.found) {
        nlohmann::ordered_json one = {{"key", found.unknown.key},
                                      {"unit", unit_or_ratio(found.unknown.unit)},
                                      {"start", found.unknown.value},
                                      {"value", found.value}};
        one["confidence_95"] = nullptr;
        if (found.low) one["confidence_95"] = {*found.low, *found.high};
        one["at_bound"] = found.at_bound;
        one["matters"] = found.matters;
        list.push_back(std::move(one));
    }
    return list;
}

}  // namespace

std::string identification_text(const Identification& result) {
    std::size_t widest = 0;
    for (const Found& found : result.found) widest = std::max(widest, found.unknown.key.size());
    std::string text;
    for (const Found& found : result.found)
        text +=
            fmt::format("{:<{}}  {} -> {}  {}\n", found.unknown.key, widest, found.unknown.shown(found.unknown.value),
                        found.unknown.shown(found.value), interval(found));
    for (const Errors& e : result.fitted) text += error_line("fitted", e);
    for (const Errors& e : result.judged) text += error_line("judged", e);
    return text;
}

std::string identification_json(const Identification& result) {
    nlohmann::ordered_json json;
    json["unknowns"] = unknowns_json(result);
    json["correlation"] = nlohmann::ordered_json::array();
    for (Eigen::Index j = 0; j < result.correlation.rows(); ++j) {
        auto row = nlohmann::ordered_json::array();
        for (Eigen::Index k = 0; k < result.correlation.cols(); ++k)
            row.push_back(number_or_null(result.correlation(j, k)));
        json["correlation"].push_back(std::move(row));
    }
    json["fitted"] = errors_json(result.fitted);
    json["judged"] = errors_json(result.judged);
    json["trials"] = result.trials;
    json["converged"] = result.converged;
    json["assignments"] = assignments(result);
    json["warnings"] = result.warnings;
    return json_text(json, 2);
}

std::string comparison_csv(const Identification& result) {
    std::string text = "line,time,quantity,unit,use,measured,scatter,before,after\n";
    for (const Compared& value : result.values) {
        const MeasuredValue& m = value.measured;
        const Channel& channel = result.channels[m.channel];
        const std::string scatter = m.scatter > 0 ? fmt::format("{:.9g}", m.scatter) : "";
        text += fmt::format("{},{:.9g},{},{},{},{:.9g},{},{:.9g},{:.9g}\n", m.line, m.time, csv_field(channel.column),
                            unit_or_ratio(channel.unit), m.judged ? "judge" : "fit", m.value, scatter, value.before,
                            value.after);
    }
    return text;
}

}  // namespace pliant::sim::identify

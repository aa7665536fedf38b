#include "loop/study/failure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace pliant::study {
namespace {

/// The last non-empty line: errors come last.
std::string last_line(std::string_view text) {
    const std::size_t end = text.find_last_not_of(" \r\n");
    if (end == std::string_view::npos) return "";
    text = text.substr(0, end + 1);
    const std::size_t before = text.find_last_of("\r\n");
    return std::string(text.substr(before == std::string_view::npos ? 0 : before + 1));
}

std::string text_in(const nlohmann::json& json, const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

bool is_missed(const nlohmann::json& waypoint) {
    return waypoint.is_object() && waypoint.contains("reached") && waypoint["reached"] == false;
}

/// "waypoint 2 of 5 is not reached: flexor is at the upper end of its range"; empty: no waypoint was missed.
std::string missed_waypoint(const nlohmann::json& json) {
    if (!json.is_object() || !json.contains("waypoints") || !json["waypoints"].is_array()) return "";
    const nlohmann::json& waypoints = json["waypoints"];
    std::size_t k = 0;
    while (k < waypoints.size() && !is_missed(waypoints[k])) ++k;
    if (k == waypoints.size()) return "";
    std::vector<std::string> reasons;
    if (waypoints[k].contains("reasons") && waypoints[k]["reasons"].is_array()) {
        for (const auto& reason : waypoints[k]["reasons"]) {
            if (reason.is_string()) reasons.push_back(reason.get<std::string>());
        }
    }
    return fmt::format("waypoint {} of {} is not reached{}{}", k + 1, waypoints.size(), reasons.empty() ? "" : ": ",
                       fmt::join(reasons, "; "));
}

}  // namespace

std::string reason_of_failure(const nlohmann::json& output, const std::string& errors, int exit_status) {
    if (std::string error = last_line(text_in(output, "error")); !error.empty()) return error;
    if (text_in(output, "message").empty()) {  // a message, which is on standard error too, says more
        if (std::string missed = missed_waypoint(output); !missed.empty()) return missed;
    }
    std::string line = last_line(errors);
    return line.empty() ? fmt::format("exit status {}", exit_status) : line;
}

}  // namespace pliant::study

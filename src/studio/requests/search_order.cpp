#include "studio/requests/search_order.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/letters.hpp"
#include "studio/base/http.hpp"
#include "studio/requests/json_keys.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

std::vector<InputRange> read_inputs(const char* what, Keys& keys) {
    std::vector<InputRange> inputs;
    for (const Json& entry : keys.list("inputs")) {
        if (!entry.is_object()) return keys.wrong("inputs", "a list of objects"), inputs;
        Keys inner(what, entry);
        inputs.push_back({inner.text("name"), inner.number("low"), inner.number("high")});
        if (!inner.error().empty()) return keys.wrong("inputs", "name, low and high of each", true), inputs;
    }
    if (inputs.empty()) keys.wrong("inputs", "an actuator that may be moved");
    return inputs;
}

int whole(Keys& keys, const char* key, int fallback, int least, int most, const char* wanted) {
    const double value = keys.number(key, fallback);
    if (!(value >= least && value <= most) || value != std::floor(value)) return keys.wrong(key, wanted), fallback;
    return static_cast<int>(value);
}

/// Letters and unit operators, as in "kg/m^3": nothing that could become a path or another value.
bool is_unit(std::string_view text) {
    const auto plain = [](char c) { return is_letter(c) || is_digit(c) || c == '^' || c == '/' || c == '-'; };
    return text.size() <= 16 && std::ranges::all_of(text, plain);
}

SweepAxis read_axis(const Json& entry, Keys& keys) {
    if (!entry.is_object()) return keys.wrong("axes", "a list of objects"), SweepAxis{};
    Keys inner("sweep", entry);
    SweepAxis axis{inner.text("key"), "", {}};
    if (entry.contains("unit") && entry["unit"] != "") axis.unit = inner.text("unit");
    if (!is_unit(axis.unit)) inner.wrong("unit", "a unit, as in \"MPa\"");
    if (axis.key.find('=') != std::string::npos) inner.wrong("key", "a key without its value");
    for (const Json& value : inner.list("values")) {
        if (!value.is_number() || !(std::fabs(value.get<double>()) <= 1e12)) inner.wrong("values", "a list of numbers");
        axis.values.push_back(value.is_number() ? value.get<double>() : 0);
    }
    if (axis.values.empty()) inner.wrong("values", "at least one number");
    if (!inner.error().empty()) keys.wrong("axes", "key, unit and values of each", true);
    return axis;
}

}  // namespace

Result<GoalOrder> parse_goal_order(std::string_view text) {
    const Result<Json> json = parse_object("goal", text, largest_body);
    if (!json) return tl::unexpected(json.error());
    Keys keys("goal", *json);
    GoalOrder order;
    order.marker = keys.text("marker");
    for (const Json& point : keys.list("path")) order.path_mm.push_back(keys.point("path", point));
    if (order.path_mm.empty()) keys.wrong("path", "a point");
    order.tolerance_mm = keys.number("tolerance");
    if (!(order.tolerance_mm > 0)) keys.wrong("tolerance", "a length above 0 mm");
    order.inputs = read_inputs("goal", keys);
    if (!keys.error().empty()) return input_error("{}", keys.error());
    return order;
}

Result<IdentifyOrder> parse_identify_order(std::string_view text) {
    const Result<Json> json = parse_object("identify", text, largest_body);
    if (!json) return tl::unexpected(json.error());
    Keys keys("identify", *json);
    IdentifyOrder order;
    order.unknowns = keys.texts("unknowns");
    if (order.unknowns.empty()) keys.wrong("unknowns", "a number to find");
    const auto csv = json->find("csv");
    if (csv == json->end() || !csv->is_string() || csv->get_ref<const std::string&>().empty())
        keys.wrong("csv", "a table of measurements");
    else
        order.csv = csv->get<std::string>();
    order.file = keys.text("file");
    if (json->contains("judge") && (*json)["judge"] != "") order.judge = keys.text("judge");
    if (!order.judge.empty() && order.judge != "every-second" && order.judge != "second-half")
        keys.wrong("judge", "\"every-second\" or \"second-half\"");
    if (!keys.error().empty()) return input_error("{}", keys.error());
    return order;
}

Result<WorkspaceOrder> parse_workspace_order(std::string_view text) {
    const Result<Json> json = parse_object("workspace", text, largest_body);
    if (!json) return tl::unexpected(json.error());
    Keys keys("workspace", *json);
    WorkspaceOrder order;
    order.inputs = read_inputs("workspace", keys);
    order.side = whole(keys, "side", order.side, 2, 60, "a whole number from 2 to 60");
    order.between = whole(keys, "between", order.between, 0, 2000, "a whole number from 0 to 2000");
    if (!keys.error().empty()) return input_error("{}", keys.error());
    return order;
}

Result<SweepOrder> parse_sweep_order(std::string_view text) {
    const Result<Json> json = parse_object("sweep", text, largest_body);
    if (!json) return tl::unexpected(json.error());
    Keys keys("sweep", *json);
    SweepOrder order;
    for (const Json& entry : keys.list("axes")) order.axes.push_back(read_axis(entry, keys));
    if (order.axes.empty() || order.axes.size() > 2) keys.wrong("axes", "one number or two");
    if (!keys.error().empty()) return input_error("{}", keys.error());
    std::size_t runs = 1;
    for (const SweepAxis& axis : order.axes) runs *= axis.values.size();
    if (runs > most_sweep_runs)
        return input_error("sweep: {} runs are more than {}; take fewer values", runs, most_sweep_runs);
    if (order.axes.size() == 2 && order.axes[0].key == order.axes[1].key)
        return input_error("sweep: {}: is named twice", order.axes[0].key);
    return order;
}

}  // namespace pliant::studio

#include "presentation/studio/search_order.hpp"

#include <nlohmann/json.hpp>

#include "presentation/studio/http.hpp"
#include "presentation/studio/json_keys.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

std::vector<InputRange> read_inputs(Keys& keys) {
    std::vector<InputRange> inputs;
    for (const Json& entry : keys.list("inputs")) {
        if (!entry.is_object()) return keys.wrong("inputs", "a list of objects"), inputs;
        Keys inner("goal", entry);
        inputs.push_back({inner.text("name"), inner.number("low"), inner.number("high")});
        if (!inner.error().empty()) return keys.wrong("inputs", "name, low and high of each"), inputs;
    }
    if (inputs.empty()) keys.wrong("inputs", "an actuator that may be moved");
    return inputs;
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
    order.inputs = read_inputs(keys);
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

}  // namespace pliant::studio

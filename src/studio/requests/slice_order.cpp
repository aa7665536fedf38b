#include "studio/requests/slice_order.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;
using prepare::Order;

struct TextKey {
    const char* key;
    std::string Order::*value;
};
constexpr std::array<TextKey, 12> text_keys = {{{"layer", &Order::layer},
                                                {"least-layer", &Order::least_layer},
                                                {"spacing", &Order::spacing},
                                                {"least-feature", &Order::least_feature},
                                                {"support", &Order::support},
                                                {"support-angle", &Order::support_angle},
                                                {"support-spacing", &Order::support_spacing},
                                                {"support-tip", &Order::support_tip},
                                                {"support-pillar", &Order::support_pillar},
                                                {"lift", &Order::lift},
                                                {"raft", &Order::raft},
                                                {"hollow", &Order::hollow}}};

struct ListKey {
    const char* key;
    std::vector<std::string> Order::*value;
};
constexpr std::array<ListKey, 4> list_keys = {{{"resin", &Order::resins},
                                               {"exposure", &Order::exposures},
                                               {"interlock", &Order::interlocks},
                                               {"overlap", &Order::overlaps}}};

constexpr std::size_t longest_text = 400, longest_list = 200;

Status take_text(const std::string& key, const Json& value, std::string& text) {
    if (!value.is_string() || value.get_ref<const std::string&>().size() > longest_text)
        return input_error("--{}: a short text is needed, as in \"2 mm\"", key);
    text = value.get<std::string>();
    return {};
}

Status take_list(const std::string& key, const Json& value, std::vector<std::string>& list) {
    if (!value.is_array() || value.size() > longest_list) return input_error("--{}: a list of texts is needed", key);
    for (const Json& entry : value) {
        if (Status status = take_text(key, entry, list.emplace_back()); !status) return status;
    }
    return {};
}

Status take_turn(const Json& value, Order& order) {
    const auto number = [](const Json& v) { return v.is_number(); };
    if (!value.is_array() || value.size() != 3 || !std::all_of(value.begin(), value.end(), number))
        return input_error("--turn: three angles in degrees are needed");
    order.turn = value.get<std::vector<double>>();
    return {};
}

Status take_at(const Json& value, Order& order) {
    if (!value.is_array() || value.size() != 2 || !value[0].is_number() || !value[1].is_number())
        return input_error("--at: two numbers in mm are needed");
    order.at = value.get<std::vector<double>>();
    return {};
}

/// The table of `pliant slice --support-paint`.
Status take_paint(const Json& value, Order& order) {
    constexpr std::size_t longest_table = 3 << 20;
    if (!value.is_string() || value.get_ref<const std::string&>().size() > longest_table)
        return input_error("--support-paint: a table as text is needed, of at most 3 MB");
    order.support_paint = value.get<std::string>();
    return {};
}

/// Keys whose values are not strings.
Status take_other(const std::string& key, const Json& value, Order& order) {
    if (key == "printer" || key == "robot") return {};
    if (key == "layer_um") {
        constexpr int most_um = 1000;
        if (!value.is_number_integer() || value < 0 || value > most_um)
            return input_error("--layer: a whole number of micrometres from 1 to {} is needed", most_um);
        if (value > 0) order.layer = std::to_string(value.get<int>()) + " um";
        return {};
    }
    if (key == "drain") return take_text(key, value, order.drain);
    if (key == "turn") return take_turn(value, order);
    if (key == "at") return take_at(value, order);
    if (key == "support-paint") return take_paint(value, order);
    if (key == "scale") {
        if (!value.is_number()) return input_error("--scale: a number from 0.001 to 1000 is needed");
        order.scale = value.get<double>();
        return {};
    }
    if (key == "copies") {
        constexpr int most = 1000;
        if (!value.is_number_integer() || value < 1 || value > most)
            return input_error("--copies: a whole number from 1 to {} is needed", most);
        order.copies = value.get<int>();
        return {};
    }
    if (key == "threshold") {
        if (!value.is_number() || !(value > 0) || value > 1)
            return input_error("--threshold: a number above 0 and at most 1 is needed");
        order.threshold = value.get<double>();
        return {};
    }
    for (const auto& [name, flag] : {std::pair{"no-anti-alias", &order.no_anti_alias}, {"any-vat", &order.any_vat}}) {
        if (key != name) continue;
        if (!value.is_boolean()) return input_error("--{}: true or false is needed", key);
        *flag = value.get<bool>();
        return {};
    }
    return input_error("--{}: there is no such option", key.substr(0, longest_text));
}

Status take(const std::string& key, const Json& value, Order& order) {
    for (const TextKey& known : text_keys) {
        if (key == known.key) return take_text(key, value, order.*known.value);
    }
    for (const ListKey& known : list_keys) {
        if (key == known.key) return take_list(key, value, order.*known.value);
    }
    return take_other(key, value, order);
}

}  // namespace

Result<Order> read_slice_order(std::string_view text) {
    const Json json = parse_json(text);
    if (!json.is_object()) return input_error("a JSON object is needed");
    Order order;
    for (const auto& [key, value] : json.items()) {
        if (Status status = take(key, value, order); !status) return tl::unexpected(status.error());
    }
    return order;
}

Result<std::optional<std::string>> robot_text_of(std::string_view text) {
    const Json json = parse_json(text);
    if (!json.is_object() || !json.contains("robot")) return std::nullopt;
    if (!json["robot"].is_string()) return input_error("robot: the text of a robot file is needed");
    return json["robot"].get<std::string>();
}

Result<std::string> printer_name_of(std::string_view text) {
    const Json json = parse_json(text);
    if (!json.is_object()) return input_error("a JSON object is needed");
    if (!json.contains("printer")) return std::string("tower");
    if (!json["printer"].is_string()) return input_error("--printer: the name of a printer is needed");
    return json["printer"].get<std::string>();
}

}  // namespace pliant::studio

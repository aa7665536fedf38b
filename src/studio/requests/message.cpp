#include "studio/requests/message.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "base/core/letters.hpp"
#include "studio/requests/json_keys.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

Message read_hello(Keys& keys) {
    Hello hello{keys.text("page")};
    const auto plain = [](char c) { return is_letter(c) || is_digit(c) || c == '-' || c == '_'; };
    if (hello.page.size() < 8 || hello.page.size() > 64 || !std::all_of(hello.page.begin(), hello.page.end(), plain))
        keys.wrong("page", "8 to 64 letters and digits", true);
    return hello;
}

/// Empty if there is none.
std::optional<double> read_time(Keys& keys) {
    const double time = keys.number("time", std::numeric_limits<double>::quiet_NaN());
    if (std::isnan(time)) return std::nullopt;
    if (time < 0) keys.wrong("time", "a number of at least 0");
    return time;
}

Message read_follow(Keys& keys) {
    const double tag = keys.number("tag", 0), time = keys.number("time");
    if (time < 0) keys.wrong("time", "a number of at least 0");
    return Follow{tag, time};
}

Message read_drive(Keys& keys) {
    DriveMessage drive{keys.number("tag", 0), read_time(keys), {}};
    for (const Json& entry : keys.list("actuators")) {
        if (!entry.is_object()) {
            keys.wrong("actuators", "a list of objects");
            break;
        }
        Keys inner("message", entry);
        drive.actuators.push_back({inner.text("name"), inner.text("kind"), inner.number("value")});
        if (!inner.error().empty()) {
            keys.wrong("actuators", "name, kind and value of each", true);
            break;
        }
    }
    return drive;
}

Message read_pull(Keys& keys) {
    PullMessage pull;
    pull.tag = keys.number("tag", 0);
    const double vertex = keys.number("vertex");
    if (vertex < 0 || vertex != std::floor(vertex)) keys.wrong("vertex", "a whole number");
    pull.vertex = vertex >= 0 ? static_cast<int>(vertex) : 0;
    pull.to_mm = keys.point("to");
    return pull;
}

Message read_lead(Keys& keys) {
    LeadMessage lead;
    lead.tag = keys.number("tag", 0);
    lead.marker = keys.text("marker");
    lead.to_mm = keys.point("to");
    return lead;
}

Message read_fields(Keys& keys) {
    return FieldsMessage{keys.texts("names")};
}

Message read_steer(Keys& keys) {
    const std::string action = keys.text("action");
    if (action == "ask") return Steer{Steer::Action::ask};
    if (action == "give") return Steer{Steer::Action::give};
    if (action != "leave") keys.wrong("action", "\"ask\", \"give\" or \"leave\"");
    return Steer{Steer::Action::leave};
}

Message read(const std::string& type, Keys& keys) {
    if (type == "hello") return read_hello(keys);
    if (type == "drive") return read_drive(keys);
    if (type == "follow") return read_follow(keys);
    if (type == "play") return Play{keys.boolean("on")};
    if (type == "rest") return Rest{};
    if (type == "pull") return read_pull(keys);
    if (type == "lead") return read_lead(keys);
    if (type == "release") return Release{};
    if (type == "fields") return read_fields(keys);
    if (type == "steer") return read_steer(keys);
    if (type != "ping")
        keys.wrong("type", "hello, drive, follow, play, rest, pull, lead, release, fields, steer or ping");
    return Ping{};
}

}  // namespace

Result<Message> parse_message(std::string_view text) {
    const Result<Json> json = parse_object("message", text, longest_message);
    if (!json) return tl::unexpected(json.error());
    Keys keys("message", *json);
    const std::string type = keys.text("type");
    Message message = read(type, keys);
    if (!keys.error().empty()) return input_error("{}", keys.error());
    return message;
}

}  // namespace pliant::studio

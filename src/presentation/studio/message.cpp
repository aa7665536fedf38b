#include "presentation/studio/message.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "base/core/letters.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t longest_list = 256, longest_name = 200;
constexpr double largest_number = 1e9;

/// Reads keys of one object and keeps the first thing that is wrong.
class Keys {
public:
    explicit Keys(const Json& object) : object_(object) {}

    double number(const char* key, double fallback) { return object_.contains(key) ? number(key) : fallback; }
    double number(const char* key) {
        const auto found = object_.find(key);
        if (found == object_.end() || !found->is_number()) return wrong(key, "a number"), 0;
        const double value = found->get<double>();
        if (!(std::fabs(value) <= largest_number)) return wrong(key, "a number within +-1e9"), 0;
        return value;
    }
    std::string text(const char* key) {
        const auto found = object_.find(key);
        if (found == object_.end() || !found->is_string()) return wrong(key, "a text"), "";
        const auto& value = found->get_ref<const std::string&>();
        if (value.empty() || value.size() > longest_name) return wrong(key, "a text of 1 to 200 bytes"), "";
        return value;
    }
    bool boolean(const char* key) {
        const auto found = object_.find(key);
        if (found == object_.end() || !found->is_boolean()) return wrong(key, "true or false"), false;
        return found->get<bool>();
    }
    const Json& list(const char* key) {
        static const Json empty = Json::array();
        const auto found = object_.find(key);
        if (found == object_.end() || !found->is_array() || found->size() > longest_list)
            return wrong(key, "a list of at most 256"), empty;
        return *found;
    }
    void wrong(const char* key, const char* wanted) {
        if (error_.empty()) error_ = fmt::format("message: {}: {} is needed", key, wanted);
    }
    [[nodiscard]] const std::string& error() const { return error_; }

private:
    const Json& object_;
    std::string error_;
};

Message read_hello(Keys& keys) {
    Hello hello{keys.text("page")};
    const auto plain = [](char c) { return is_letter(c) || is_digit(c) || c == '-' || c == '_'; };
    if (hello.page.size() < 8 || hello.page.size() > 64 || !std::all_of(hello.page.begin(), hello.page.end(), plain))
        keys.wrong("page", "8 to 64 letters and digits");
    return hello;
}

Message read_drive(Keys& keys) {
    DriveMessage drive{keys.number("tag", 0), keys.number("time", -1), {}};
    for (const Json& entry : keys.list("actuators")) {
        if (!entry.is_object()) {
            keys.wrong("actuators", "a list of objects");
            break;
        }
        Keys inner(entry);
        drive.actuators.push_back({inner.text("name"), inner.text("kind"), inner.number("value")});
        if (!inner.error().empty()) {
            keys.wrong("actuators", "name, kind and value of each");
            break;
        }
    }
    return drive;
}

std::array<double, 3> read_point(Keys& keys) {
    std::array<double, 3> point{};
    const Json& to = keys.list("to");
    for (std::size_t k = 0; k < 3; ++k) {
        if (to.size() != 3 || !to[k].is_number() || !(std::fabs(to[k].get<double>()) <= largest_number)) {
            keys.wrong("to", "three numbers");
            break;
        }
        point[k] = to[k].get<double>();
    }
    return point;
}

Message read_pull(Keys& keys) {
    PullMessage pull;
    pull.tag = keys.number("tag", 0);
    const double vertex = keys.number("vertex");
    if (vertex < 0 || vertex != std::floor(vertex)) keys.wrong("vertex", "a whole number");
    pull.vertex = vertex >= 0 ? static_cast<int>(vertex) : 0;
    pull.to_mm = read_point(keys);
    return pull;
}

Message read_lead(Keys& keys) {
    LeadMessage lead;
    lead.tag = keys.number("tag", 0);
    lead.marker = keys.text("marker");
    lead.to_mm = read_point(keys);
    return lead;
}

Message read_fields(Keys& keys) {
    FieldsMessage fields;
    for (const Json& name : keys.list("names")) {
        if (!name.is_string() || name.get_ref<const std::string&>().size() > longest_name) {
            keys.wrong("names", "a list of texts");
            break;
        }
        fields.names.push_back(name.get<std::string>());
    }
    return fields;
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
    if (type == "follow") return Follow{keys.number("tag", 0), keys.number("time")};
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

/// The parser recurses: nesting is bounded before it begins.
bool nested_too_deep(std::string_view text) {
    constexpr int deepest = 8;
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '\\') {
            ++i;
        } else if (c == '"') {
            quoted = !quoted;
        } else if (!quoted && (c == '[' || c == '{')) {
            if (++depth > deepest) return true;
        } else if (!quoted && (c == ']' || c == '}')) {
            --depth;
        }
    }
    return false;
}

}  // namespace

Result<Message> parse_message(std::string_view text) {
    if (text.size() > longest_message) return input_error("message: over {} bytes", longest_message);
    if (nested_too_deep(text)) return input_error("message: nested too deep");
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) return input_error("message: a JSON object is needed");
    Keys keys(json);
    const std::string type = keys.text("type");
    Message message = read(type, keys);
    if (!keys.error().empty()) return input_error("{}", keys.error());
    return message;
}

}  // namespace pliant::studio

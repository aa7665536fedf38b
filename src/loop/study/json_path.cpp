#include "loop/study/json_path.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/core/text.hpp"

namespace pliant::study {
namespace {

bool is_word_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           (static_cast<unsigned char>(c) & 0x80U) != 0;
}

/// The keys of an object, or the length of an array: the valid continuations, for messages.
std::string contents(const nlohmann::json& json) {
    constexpr std::size_t most_shown = 12;
    if (json.is_array())
        return fmt::format("a list of {}, [0] to [{}]", json.size(), json.empty() ? 0 : json.size() - 1);
    if (!json.is_object()) return fmt::format("a {}", json.is_string() ? "text" : "single value");
    std::vector<std::string> names;
    for (const auto& [key, value] : json.items()) {
        if (names.size() < most_shown) names.push_back(key);
    }
    if (names.empty()) return "nothing";
    if (json.size() > names.size()) names.push_back(fmt::format("{} more", json.size() - names.size()));
    return join_names(names);
}

std::string nearest_key(const nlohmann::json& json, const std::string& key) {
    std::vector<std::string> names;
    for (const auto& [name, value] : json.items()) names.push_back(name);
    const std::string nearest = nearest_name(key, names);
    return nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest);
}

std::string at_path(const std::string& way) {
    return way.empty() ? "the result" : way;
}

const nlohmann::json* child(const nlohmann::json& json, const std::string& key) {
    const auto found = json.is_object() ? json.find(key) : json.end();
    return found == json.end() ? nullptr : &*found;
}

const nlohmann::json* child(const nlohmann::json& json, long place) {
    if (!json.is_array()) return nullptr;
    const auto size = static_cast<long>(json.size());
    const long index = place < 0 ? size + place : place;
    return index < 0 || index >= size ? nullptr : &json[static_cast<std::size_t>(index)];
}

/// Parses the rest of a text into the parts of a path.
struct Scanner {
    std::string_view whole, rest;

    [[nodiscard]] tl::unexpected<Error> wrong(std::string_view what) const {
        return input_error("\"{}\": {} at letter {}; write keys and places as in steps[-1].cables.flexor.tension_N",
                           whole, what, whole.size() - rest.size() + 1);
    }
    Result<std::string> word() {
        const auto end = std::find_if_not(rest.begin(), rest.end(), is_word_letter);
        std::string found(rest.begin(), end);
        if (found.empty()) return wrong(rest.empty() ? "a key is missing" : "a key is expected");
        rest.remove_prefix(found.size());
        return found;
    }
    /// Parses what follows an opening bracket.
    Result<std::variant<std::string, long>> bracket() {
        if (rest.starts_with('"')) {
            const std::size_t end = rest.find("\"]", 1);
            if (end == std::string_view::npos) return wrong("\"] is missing");
            std::string key(rest.substr(1, end - 1));
            rest.remove_prefix(end + 2);
            return key;
        }
        long place = 0;
        const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), place);
        if (error != std::errc{} || end == rest.data() + rest.size() || *end != ']')
            return wrong("a whole number and ] are expected");
        rest.remove_prefix(static_cast<std::size_t>(end - rest.data()) + 1);
        return place;
    }
};

}  // namespace

Result<JsonPath> JsonPath::parse(std::string_view text) {
    constexpr std::size_t longest = 1000;
    if (text.size() > longest)
        return input_error("a path of {} letters; at most {} are possible", text.size(), longest);
    JsonPath path;
    Scanner scanner{text, text};
    bool key_follows = true;
    while (!scanner.rest.empty() || key_follows) {
        if (scanner.rest.starts_with('[')) {
            scanner.rest.remove_prefix(1);
            auto part = scanner.bracket();
            if (!part) return tl::unexpected(part.error());
            path.parts_.push_back(std::move(*part));
        } else {
            auto key = scanner.word();
            if (!key) return tl::unexpected(key.error());
            path.parts_.emplace_back(std::move(*key));
        }
        key_follows = scanner.rest.starts_with('.');
        if (key_follows) scanner.rest.remove_prefix(1);
        if (!key_follows && !scanner.rest.empty() && !scanner.rest.starts_with('['))
            return scanner.wrong("a dot or [ is expected");
    }
    return path;
}

Result<double> JsonPath::number_in(const nlohmann::json& json) const {
    const nlohmann::json* at = &json;
    std::string way;
    if (const auto* first = std::get_if<std::string>(&parts_.front());
        first != nullptr && child(json, *first) == nullptr) {
        const nlohmann::json* steps = child(json, std::string("steps"));
        const nlohmann::json* last = steps == nullptr ? nullptr : child(*steps, -1);
        if (last != nullptr && child(*last, *first) != nullptr) {
            at = last;
            way = "steps[-1]";
        }
    }
    for (const Part& part : parts_) {
        const nlohmann::json* below = std::visit([&](const auto& value) { return child(*at, value); }, part);
        const auto* key = std::get_if<std::string>(&part);
        if (below == nullptr && key != nullptr)
            return input_error("{} has no \"{}\"{}: there is {}", at_path(way), *key, nearest_key(*at, *key),
                               contents(*at));
        if (below == nullptr)
            return input_error("{} has no [{}]: it is {}", at_path(way), std::get<long>(part), contents(*at));
        if (key != nullptr)
            way += way.empty() ? *key : "." + *key;
        else
            way += fmt::format("[{}]", std::get<long>(part));
        at = below;
    }
    if (at->is_boolean()) return at->get<bool>() ? 1 : 0;
    if (at->is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (at->is_number()) return at->get<double>();
    return input_error("{} is not a number: it is {}", way, contents(*at));
}

}  // namespace pliant::study

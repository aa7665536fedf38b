#include "studio/server/based_text.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <variant>

#include "base/core/config.hpp"
#include "robot/file/robot_document.hpp"
#include "studio/server/json_toml.hpp"

namespace pliant::studio {
namespace {

/// The file that the text stands on; none: it is a robot of its own, or no TOML.
std::optional<std::string> base_of(const std::optional<config::Document>& document) {
    const config::Value* base = document ? robot::entry_of(document->root, "robot") : nullptr;
    const auto* name = base != nullptr ? std::get_if<std::string>(&base->data) : nullptr;
    return name != nullptr ? std::optional(*name) : std::nullopt;
}

std::optional<config::Document> parsed(std::string_view text) {
    Result<config::Document> document = config::parse(text, {});
    return document ? std::optional(*std::move(document)) : std::nullopt;
}

bool is_of_program(std::string_view key) {
    return key == "program" || key.starts_with("program.");
}

}  // namespace

Result<std::string> with_robot_value(std::string_view text, std::string_view key, std::string_view value) {
    const std::optional<config::Document> document = parsed(text);
    if (is_of_program(key) || !base_of(document)) return config::with_value(text, key, value);
    const std::string begin = std::string(key) + "=";
    nlohmann::json all = nlohmann::json::array();
    const config::Value* set = robot::entry_of(document->root, "set");
    const auto* list = set != nullptr ? std::get_if<config::Array>(&set->data) : nullptr;
    if (list != nullptr) {
        for (const config::Value& one : *list) {
            const auto* assignment = std::get_if<std::string>(&one.data);
            if (assignment != nullptr && !assignment->starts_with(begin)) all.push_back(*assignment);
        }
    }
    all.push_back(begin + std::string(value));
    return config::with_value(text, "set", toml_text(all));
}

Result<std::string> with_robot_entry(std::string_view text, std::string_view list, const config::EntryText& entry) {
    const std::optional<std::string> base = base_of(parsed(text));
    if (base && !is_of_program(list))
        return input_error("this file only changes {}: open that file to add a {}", *base, list);
    return config::with_entry(text, list, entry);
}

}  // namespace pliant::studio

#include "base/core/config_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/core/letters.hpp"

namespace pliant::config {
namespace {

/// With a point or an exponent, so that it is not read back as an integer.
std::string real_text(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    const std::string text = fmt::format("{}", value);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string inline_text(const Value& value);

template <class List, class Text>
std::string joined(const List& list, const Text& text_of) {
    std::string text;
    for (const auto& entry : list) text += (text.empty() ? "" : ", ") + text_of(entry);
    return text;
}

struct InlineText {
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
    std::string operator()(double value) const { return real_text(value); }
    std::string operator()(const std::string& value) const { return toml_string(value); }
    std::string operator()(const Array& list) const { return fmt::format("[{}]", joined(list, inline_text)); }
    std::string operator()(const Table& table) const {
        const auto entry = [](const Entry& e) { return key_text(e.first) + " = " + inline_text(e.second); };
        return table.empty() ? "{}" : fmt::format("{{ {} }}", joined(table, entry));
    }
};

std::string inline_text(const Value& value) {
    return std::visit(InlineText{}, value.data);
}

bool is_list_of_tables(const Value& value) {
    const auto* list = std::get_if<Array>(&value.data);
    return list != nullptr && !list->empty() &&
           std::ranges::all_of(*list, [](const Value& v) { return std::holds_alternative<Table>(v.data); });
}

/// Such as the materials of a robot: each gets its own header.
bool is_table_of_tables(const Table& table) {
    return !table.empty() &&
           std::ranges::all_of(table, [](const Entry& e) { return std::holds_alternative<Table>(e.second.data); });
}

std::string lines_of(const Table& table) {
    std::string text;
    for (const auto& [key, value] : table) text += fmt::format("{} = {}\n", key_text(key), inline_text(value));
    return text;
}

/// The text in the quotes that the path begins with, and where its part ends. Nothing unless they are closed where a
/// part may end.
std::optional<std::string> quoted_part(std::string_view path, std::size_t& end) {
    if (!path.starts_with('"') && !path.starts_with('\'')) return std::nullopt;
    const char quote = path.front();
    std::string text;
    for (std::size_t i = 1; i < path.size(); ++i) {
        if (path[i] == quote) {
            end = i + 1;
            return end == path.size() || path[end] == '.' ? std::optional(std::move(text)) : std::nullopt;
        }
        if (quote == '"' && path[i] == '\\' && i + 1 < path.size()) ++i;
        text += path[i];
    }
    return std::nullopt;
}

}  // namespace

std::string toml_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (is_control(c))
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            out += c;
    }
    return out + '"';
}

std::string key_text(std::string_view key) {
    const auto bare = [](char c) { return is_letter(c) || is_digit(c) || c == '-' || c == '_'; };
    return !key.empty() && std::ranges::all_of(key, bare) ? std::string(key) : toml_string(key);
}

std::vector<std::string> path_parts(std::string_view path) {
    std::vector<std::string> parts;
    while (true) {
        std::size_t end = 0;
        if (std::optional<std::string> quoted = quoted_part(path, end)) {
            parts.push_back(std::move(*quoted));
        } else {
            end = std::min(path.find('.'), path.size());
            parts.emplace_back(path.substr(0, end));
        }
        if (end == path.size()) return parts;
        path.remove_prefix(end + 1);
    }
}

std::string path_part(std::string_view name) {
    const bool plain = name.find('.') == std::string_view::npos && !name.starts_with('"') && !name.starts_with('\'');
    return plain ? std::string(name) : toml_string(name);
}

std::string toml_text(const Value& root) {
    std::string plain, tables;
    for (const auto& [key, value] : std::get<Table>(root.data)) {
        if (const auto* table = std::get_if<Table>(&value.data); table != nullptr && is_table_of_tables(*table)) {
            for (const auto& [name, entry] : *table)
                tables +=
                    fmt::format("\n[{}.{}]\n{}", key_text(key), key_text(name), lines_of(std::get<Table>(entry.data)));
        } else if (table != nullptr) {
            tables += fmt::format("\n[{}]\n{}", key_text(key), lines_of(*table));
        } else if (is_list_of_tables(value)) {
            for (const Value& entry : std::get<Array>(value.data))
                tables += fmt::format("\n[[{}]]\n{}", key_text(key), lines_of(std::get<Table>(entry.data)));
        } else {
            plain += fmt::format("{} = {}\n", key_text(key), inline_text(value));
        }
    }
    return plain + tables;
}

}  // namespace pliant::config

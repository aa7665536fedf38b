#include "base/core/toml_edit.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>

#include "base/core/config_text.hpp"
#include "base/core/letters.hpp"
#include "base/core/toml_nesting.hpp"

namespace pliant::config {
namespace {

Result<toml::table> parsed(std::string_view text) {
    if (nested_too_deep(text)) return input_error("keys or brackets are nested too deep");
    try {
        return toml::parse(text);
    } catch (const toml::parse_error& error) {
        return input_error_at("", static_cast<int>(error.source().begin.line), "not valid TOML: {}",
                              error.description());
    }
}

/// Start of a line, counted from 1; past the last line the end of the text.
std::size_t start_of_line(std::string_view text, std::size_t line) {
    std::size_t at = 0;
    for (; line > 1 && at < text.size(); --line) at = std::min(text.find('\n', at), text.size() - 1) + 1;
    return at;
}

/// The byte offset of a source position; columns count characters, which may have several bytes.
std::size_t offset_of(std::string_view text, const toml::source_position& place) {
    std::size_t at = start_of_line(text, place.line);
    const auto continues = [&](std::size_t i) { return (static_cast<unsigned char>(text[i]) & 0xC0U) == 0x80U; };
    for (std::size_t column = 1; column < place.column && at < text.size(); ++column) {
        ++at;
        while (at < text.size() && continues(at)) ++at;
    }
    return at;
}

/// The last line of a node, including its children.
std::size_t last_line(const toml::node& node) {
    std::size_t last = std::max(node.source().begin.line, node.source().end.line);
    if (const auto* table = node.as_table()) {
        for (const auto& [key, value] : *table) last = std::max(last, last_line(value));
    } else if (const auto* list = node.as_array()) {
        for (const toml::node& item : *list) last = std::max(last, last_line(item));
    }
    return last;
}

/// The last line of a table's own keys, without subtables under headers of their own.
std::size_t last_own_line(const toml::table& table) {
    std::size_t last = table.source().begin.line;
    for (const auto& [key, value] : table) {
        const bool headed = (value.is_table() && !value.as_table()->is_inline()) || value.is_array_of_tables();
        if (!headed) last = std::max(last, last_line(value));
    }
    return last;
}

/// Each of the given lines ends with a line break.
std::string insert_line(std::string_view text, std::size_t after, std::string_view line) {
    std::string out(text);
    if (!out.empty() && out.back() != '\n') out += '\n';
    out.insert(start_of_line(out, after + 1), std::string(line) + "\n");
    return out;
}

/// The end of the last value in a list or an inline table; nothing if it has none.
std::optional<toml::source_position> end_of_values(const toml::node& node) {
    std::optional<toml::source_position> end;
    const auto look = [&](const toml::node& value) {
        // A table that a dotted key has made has no end of its own.
        const bool dotted = value.is_table() && !value.as_table()->is_inline();
        const auto its = dotted ? end_of_values(value) : value.source().end;
        if (its && (!end || *its > *end)) end = its;
    };
    if (const auto* table = node.as_table())
        for (const auto& [key, value] : *table) look(value);
    else if (const auto* list = node.as_array())
        for (const toml::node& item : *list) look(item);
    return end;
}

/// Inserts after the last value of a list or an inline table, where neither a comment nor a trailing comma is in the
/// way.
std::string insert_at_end(std::string_view text, const toml::node& node, const std::string& more) {
    std::string out(text);
    if (const auto end = end_of_values(node))
        out.insert(offset_of(text, *end), ", " + more);
    else
        out.insert(offset_of(text, node.source().begin) + 1, " " + more);
    return out;
}

toml::node* entry_named(toml::array& list, std::string_view name) {
    for (toml::node& item : list) {
        toml::table* table = item.as_table();
        if (table != nullptr && (*table)["name"].value<std::string_view>() == name) return &item;
    }
    if (!name.empty() && std::all_of(name.begin(), name.end(), is_digit)) {
        const std::size_t index = std::stoul(std::string(name.substr(0, 9)));
        if (index < list.size()) return list.get(index);
    }
    return nullptr;
}

std::string header_of(std::span<const std::string> names) {
    std::string header;
    for (const std::string& name : names) header += (header.empty() ? "" : ".") + key_text(name);
    return "[" + header + "]";
}

std::size_t place_in(const toml::array& list, const toml::node& item) {
    std::size_t place = 0;
    while (list.get(place) != &item) ++place;
    return place;
}

/// Appends a header for a table that does not exist yet.
std::string with_new_table(std::string_view text, std::span<const std::string> parts, std::string_view value) {
    std::string out(text);
    if (!out.empty() && out.back() != '\n') out += '\n';
    return out +
           fmt::format("\n{}\n{} = {}\n", header_of(parts.first(parts.size() - 1)), key_text(parts.back()), value);
}

/// Whether the table exists only by the header of a table in it, as program does by [[program.key]]: it then begins
/// where that one does, and what follows belongs to that one.
bool has_no_header(const toml::table& table) {
    return std::any_of(table.begin(), table.end(), [&](const auto& entry) {
        const toml::node& value = entry.second;
        return (value.is_table() || value.is_array()) && value.source().begin == table.source().begin;
    });
}

Status is_value(std::string_view value) {
    const auto alone = parsed(fmt::format("v = {}\n", value));
    if (alone && alone->size() == 1 && value.find('\n') == std::string_view::npos) return {};
    return input_error("\"{}\" is not a TOML value", value);
}

/// The way to a value: keys of tables, and places in lists.
using Way = std::vector<std::variant<std::string, std::size_t>>;

const toml::node* node_at(const toml::node& root, const Way& way) {
    const toml::node* at = &root;
    for (const auto& step : way) {
        const auto* key = std::get_if<std::string>(&step);
        const toml::table* table = at->as_table();
        const toml::array* list = at->as_array();
        if (key != nullptr)
            at = table == nullptr ? nullptr : table->get(*key);
        else
            at = list == nullptr ? nullptr : list->get(std::get<std::size_t>(step));
        if (at == nullptr) return nullptr;
    }
    return at;
}

bool is_equal(const toml::node& one, const toml::node& other) {
    return one.visit([&](const auto& a) {
        const auto* b = other.as<std::remove_cvref_t<decltype(a)>>();
        return b != nullptr && a == *b;
    });
}

/// A value, and where an edit was to bring it.
struct Aim {
    Way way;
    std::string_view value;
};

/// An edit must leave valid TOML in which the values are where they were meant to be.
Result<std::string> checked(std::string text, std::span<const Aim> aims) {
    const auto again = parsed(text);
    if (!again) return tl::unexpected(again.error());
    for (const auto& [way, value] : aims) {
        const auto alone = parsed(fmt::format("v = {}\n", value));
        if (!alone) return tl::unexpected(alone.error());
        const toml::node* there = node_at(*again, way);
        if (there == nullptr || !is_equal(*there, *alone->get("v")))
            return input_error("the text cannot be edited here: the value would get to another place");
    }
    return text;
}

bool ends_in_place(const std::string& part) {
    return part.ends_with(']');
}

/// Divides NAME[K], as messages write entries of a list, into the parts NAME and K. False: it is not of that form.
bool divide(std::vector<std::string>& parts, std::size_t at) {
    const std::string part = parts[at];
    const std::size_t open = part.rfind('[');
    if (open == std::string::npos || open == 0 || !ends_in_place(part)) return false;
    parts[at] = part.substr(0, open);
    parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(at) + 1, part.substr(open + 1, part.size() - open - 2));
    return true;
}

Result<std::string> edited(std::string_view text, std::string_view path, std::string_view value) {
    if (Status status = is_value(value); !status) return tl::unexpected(status.error());
    Result<toml::table> root = parsed(text);
    if (!root) return tl::unexpected(root.error());
    std::vector<std::string> parts = path_parts(path);
    std::size_t divided = 0;  // the parts before it are of NAME[K], which names what is there and adds nothing
    toml::node* at = &*root;
    Way way;
    const auto finished = [&](std::string out) { return checked(std::move(out), std::array{Aim{way, value}}); };
    std::vector<std::string> names;  // of the tables and lists on the way, as headers have them
    std::string dotted;              // from the table's header to the table, as of target in `target.tension = "5 N"`
    for (std::size_t k = 0; k < parts.size(); ++k) {
        toml::array* list = at->as_array();
        toml::table* table = at->as_table();
        if (list == nullptr && table == nullptr) return input_error("{}: \"{}\" is not a table", path, parts[k - 1]);
        const auto child = [&] { return list != nullptr ? entry_named(*list, parts[k]) : table->get(parts[k]); };
        toml::node* next = child();
        while (next == nullptr && divide(parts, k)) {
            divided = std::max(divided + 1, k + 2);
            next = child();
        }
        if (next == nullptr && (list != nullptr || k < divided || ends_in_place(parts[k])))
            return input_error("{}: there is no \"{}\"", path, parts[k]);
        if (list != nullptr) {
            at = next;
            way.emplace_back(place_in(*list, *at));
            continue;
        }
        way.emplace_back(parts[k]);
        if (next != nullptr) {
            at = next;
            names.push_back(parts[k]);
            const bool table_of_keys = at->is_table() && !at->as_table()->is_inline() &&
                                       !text.substr(offset_of(text, at->source().begin)).starts_with('[');
            dotted = table_of_keys ? dotted + key_text(parts[k]) + "." : "";
            continue;
        }
        if (k + 1 < parts.size()) {
            if (at != &*root || std::any_of(parts.begin(), parts.end(), ends_in_place))
                return input_error("{}: there is no \"{}\"", path, parts[k]);
            way.insert(way.end(), parts.begin() + 1, parts.end());
            return finished(with_new_table(text, parts, value));
        }
        const std::string line = fmt::format("{} = {}", key_text(parts[k]), value);
        if (table->is_inline()) return finished(insert_at_end(text, *table, line));
        if (at == &*root) {  // the top level has no header that tells where it begins
            const std::size_t begin = table->source().begin.line;
            return finished(insert_line(text, begin <= 1 ? 0 : begin, line));
        }
        if (dotted.empty() && has_no_header(*table))
            return finished(insert_line(text, table->source().begin.line - 1, header_of(names) + "\n" + line + "\n"));
        const std::size_t after = std::max<std::size_t>(table->source().begin.line, last_own_line(*table));
        return finished(insert_line(text, after, dotted + line));
    }
    if (at->is_table() && !at->as_table()->is_inline()) return input_error("{} is a table", path);
    const toml::array* list = at->as_array();
    if (list != nullptr && at->is_array_of_tables() && !list->get(0)->as_table()->is_inline())
        return input_error("{} is a list of tables", path);
    const std::size_t begin = offset_of(text, at->source().begin), end = offset_of(text, at->source().end);
    return finished(std::string(text.substr(0, begin)) + std::string(value) + std::string(text.substr(end)));
}

Result<std::string> extended(std::string_view text, std::string_view list, const EntryText& entry) {
    Result<toml::table> root = parsed(text);
    if (!root) return tl::unexpected(root.error());
    std::string lines = fmt::format("\n[[{}]]", key_text(list)), inlined;
    for (const auto& [key, value] : entry) {
        if (Status status = is_value(value); !status) return tl::unexpected(status.error());
        lines += fmt::format("\n{} = {}", key_text(key), value);
        inlined += fmt::format("{}{} = {}", inlined.empty() ? "" : ", ", key_text(key), value);
    }
    const toml::node* there = root->get(list);
    const toml::array* all = there == nullptr ? nullptr : there->as_array();
    std::vector<Aim> aims;
    for (const auto& [key, value] : entry)
        aims.push_back({{std::string(list), all == nullptr ? std::size_t{0} : all->size(), key}, value});
    if (there == nullptr) {
        std::string out(text);
        if (!out.empty() && out.back() != '\n') out += '\n';
        return checked(out + lines + "\n", aims);
    }
    if (all == nullptr) return input_error("{} is not a list", list);
    const toml::table* first = all->empty() ? nullptr : all->get(0)->as_table();
    const bool headed = first != nullptr && !first->is_inline();
    if (headed) return checked(insert_line(text, last_line(*all), lines), aims);
    return checked(insert_at_end(text, *all, "{ " + inlined + " }"), aims);
}

/// Edits the text behind a byte order mark, which is no column of the first line.
template <class Edit>
Result<std::string> behind_mark(std::string_view text, const Edit& edit) {
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    if (!text.starts_with(mark)) return edit(text);
    text.remove_prefix(mark.size());
    return edit(text).map([&](const std::string& out) { return std::string(mark) + out; });
}

}  // namespace

Result<std::string> with_value(std::string_view text, std::string_view path, std::string_view value) {
    return behind_mark(text, [&](std::string_view rest) { return edited(rest, path, value); });
}

Result<std::string> with_entry(std::string_view text, std::string_view list, const EntryText& entry) {
    return behind_mark(text, [&](std::string_view rest) { return extended(rest, list, entry); });
}

}  // namespace pliant::config

// The only file that includes muParser, and, with toml_edit.cpp, one of two that include toml++.
#include <muParser.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/core/config.hpp"
#include "base/core/config_text.hpp"
#include "base/core/files.hpp"
#include "base/core/letters.hpp"
#include "base/core/parse_all.hpp"
#include "base/core/text.hpp"
#include "base/core/toml_nesting.hpp"

namespace pliant::config {
namespace {

constexpr std::size_t max_text_bytes = 16u << 20;
constexpr int max_depth = 32;

int line_of(const toml::node& node) {
    return static_cast<int>(node.source().begin.line);
}

Result<Value> convert(const toml::node& node, int depth) {
    if (depth > max_depth) return input_error_at("", line_of(node), "nested deeper than {} levels", max_depth);
    Value value;
    value.line = line_of(node);
    if (const auto* flag = node.as_boolean())
        value.data = flag->get();
    else if (const auto* whole = node.as_integer())
        value.data = whole->get();
    else if (const auto* real = node.as_floating_point())
        value.data = real->get();
    else if (const auto* string = node.as_string())
        value.data = std::string(string->get());
    else if (const auto* list = node.as_array()) {
        Array items;
        for (const toml::node& item : *list) {
            Result<Value> converted = convert(item, depth + 1);
            if (!converted) return converted;
            items.push_back(std::move(*converted));
        }
        value.data = std::move(items);
    } else if (const auto* table = node.as_table()) {
        std::vector<std::pair<toml::source_position, Entry>> entries;
        for (const auto& [key, item] : *table) {
            Result<Value> converted = convert(item, depth + 1);
            if (!converted) return converted;
            const bool is_group = item.is_table() || item.is_array();
            // A scalar gets the line of its key, where a person would look.
            if (!is_group) converted->line = static_cast<int>(key.source().begin.line);
            entries.emplace_back(key.source().begin, Entry(std::string(key.str()), std::move(*converted)));
        }
        // toml++ sorts by name; messages and `[parameters]` need the order of the file.
        std::ranges::stable_sort(entries, {}, [](const auto& e) { return std::pair(e.first.line, e.first.column); });
        Table ordered;
        for (auto& [place, entry] : entries) ordered.push_back(std::move(entry));
        value.data = std::move(ordered);
    } else {
        return input_error_at("", line_of(node), "dates and times have no meaning here");
    }
    return value;
}

template <class Node>  // Value or const Value
Node* find_child(Node& parent, std::string_view part) {
    if (auto* table = std::get_if<Table>(&parent.data)) {
        for (auto& [name, value] : *table) {
            if (name == part) return &value;
        }
        return nullptr;
    }
    auto* list = std::get_if<Array>(&parent.data);
    if (list == nullptr) return nullptr;
    for (auto& item : *list) {
        const auto* entry = std::get_if<Table>(&item.data);
        if (entry == nullptr) continue;
        for (const auto& [name, value] : *entry) {
            const auto* text = std::get_if<std::string>(&value.data);
            if (name == "name" && text != nullptr && *text == part) return &item;
        }
    }
    std::size_t index = 0;
    return parse_all(part, index) && index < list->size() ? &(*list)[index] : nullptr;
}

std::vector<std::string> child_names(const Value& parent) {
    std::vector<std::string> names;
    if (const auto* table = std::get_if<Table>(&parent.data)) {
        for (const auto& [name, value] : *table) names.push_back(name);
    } else if (const auto* list = std::get_if<Array>(&parent.data)) {
        for (const Value& item : *list) {
            const auto* entry = std::get_if<Table>(&item.data);
            if (entry == nullptr) continue;
            for (const auto& [name, value] : *entry) {
                const auto* text = std::get_if<std::string>(&value.data);
                if (name == "name" && text != nullptr) names.push_back(*text);
            }
        }
    }
    return names;
}

/// As in 100,5: a comma between two digits.
bool has_decimal_comma(std::string_view text) {
    for (std::size_t i = 1; i + 1 < text.size(); ++i) {
        if (text[i] == ',' && is_digit(text[i - 1]) && is_digit(text[i + 1])) return true;
    }
    return false;
}

bool is_formula(const Value& value) {
    const auto* text = std::get_if<std::string>(&value.data);
    return text != nullptr && !text->empty() && text->front() == '=';
}

class Evaluator {
public:
    explicit Evaluator(std::string file) : file_(std::move(file)) {}

    /// The names of [parameters], of which a formula may use those that are defined.
    void announce(std::string name) { announced_.push_back(std::move(name)); }

    Result<double> evaluate(const Value& value, const std::string& key) {
        const std::string formula = std::get<std::string>(value.data).substr(1);
        try {
            parser_.SetExpr(formula);
            // Between commas outside of a function muParser sees several formulas; Eval() would give the last one.
            int count = 0;
            const double result = *parser_.Eval(count);
            if (count != 1)
                return input_error_at(file_, value.line, "{}: \"={}\" {}", key, formula,
                                      has_decimal_comma(formula) ? "has a decimal comma; write a point"
                                                                 : "has several values; one is needed");
            if (std::isfinite(result)) return result;
            return input_error_at(file_, value.line, "{}: \"={}\" is not a finite number", key, formula);
        } catch (const mu::ParserError& error) {
            const bool unknown = error.GetCode() == mu::ecUNASSIGNABLE_TOKEN;
            return input_error_at(file_, value.line, "{}: \"={}\": {}", key, formula,
                                  unknown ? no_parameter(error.GetToken(), key) : error.GetMsg());
        }
    }

    Status define(const std::string& name, double value, int line) {
        try {
            parser_.DefineConst(name, value);
            defined_.push_back(name);
            return {};
        } catch (const mu::ParserError& error) {
            return input_error_at(file_, line, "parameters.{}: not a name for a parameter; use letters, digits and _",
                                  name);
        }
    }

    Status replace_formulas(Value& value, const std::string& key) {
        if (is_formula(value)) {
            const Result<double> number = evaluate(value, key);
            if (!number) return tl::unexpected(number.error());
            value.data = *number;
        } else if (auto* list = std::get_if<Array>(&value.data)) {
            for (std::size_t i = 0; i < list->size(); ++i) {
                if (Status status = replace_formulas((*list)[i], fmt::format("{}[{}]", key, i)); !status) return status;
            }
        } else if (auto* table = std::get_if<Table>(&value.data)) {
            for (auto& [name, item] : *table) {
                if (Status status = replace_formulas(item, key.empty() ? name : key + "." + name); !status)
                    return status;
            }
        }
        return {};
    }

private:
    [[nodiscard]] std::string no_parameter(const std::string& token, const std::string& key) const {
        if (key == "parameters." + token) return fmt::format("\"{}\" is what is defined here", token);
        if (std::ranges::find(announced_, token) != announced_.end())
            return fmt::format("\"{}\" is defined below; a formula may use the parameters above it", token);
        const std::string near = nearest_name(token, defined_);
        return fmt::format("there is no parameter \"{}\"{}", token,
                           near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near));
    }

    std::string file_;
    mu::Parser parser_;
    std::vector<std::string> announced_;
    std::vector<std::string> defined_;
};

/// UTF-16 and UTF-32, as some editors save them: by their mark, or by the zeros of plain letters.
bool is_wide_text(std::string_view text) {
    return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
           text.substr(0, 4).find('\0') != std::string_view::npos;
}

/// Of a value and of all within it.
void set_lines(Value& value, int line) {
    value.line = line;
    if (auto* array = std::get_if<Array>(&value.data)) {
        for (Value& one : *array) set_lines(one, line);
    } else if (auto* table = std::get_if<Table>(&value.data)) {
        for (auto& [name, one] : *table) set_lines(one, line);
    }
}

/// Also as messages write entries of a list: "object[0]".
template <class Node>
Node* find_part(Node& node, std::string_view part) {
    if (Node* child = find_child(node, part)) return child;
    const std::size_t open = part.rfind('[');
    if (open == std::string_view::npos || !part.ends_with(']')) return nullptr;
    Node* list = find_part(node, part.substr(0, open));
    return list == nullptr ? nullptr : find_child(*list, part.substr(open + 1, part.size() - open - 2));
}

}  // namespace

Result<Document> parse(std::string_view text, const std::filesystem::path& file) {
    if (text.size() > max_text_bytes)
        return input_error("{}: larger than 16 MB, which is not a robot or printer file", file.string());
    if (is_wide_text(text))
        return input_error("{}: is not UTF-8 text but looks like UTF-16 or UTF-32; save it as UTF-8", file.string());
    if (nested_too_deep(text)) return input_error("{}: keys or brackets are nested too deep", file.string());
    try {
        const toml::table table = toml::parse(text, file.string());
        Result<Value> root = convert(table, 0);
        if (!root) {
            Diagnostic problem = root.error().problems.front();
            problem.file = file.string();
            return tl::unexpected(error_of(Cause::input, {std::move(problem)}));
        }
        return Document{file, std::move(*root)};
    } catch (const toml::parse_error& error) {
        if (error.description().find("invalid utf-8") != std::string_view::npos)
            return input_error_at(file.string(), error.source().begin.line,
                                  "is not UTF-8 text: it has bytes of another encoding; save it as UTF-8");
        return input_error_at(file.string(), error.source().begin.line, "not valid TOML: {}", error.description());
    }
}

Result<Document> load(const std::filesystem::path& file) {
    const Result<std::string> text = read_file(file, max_text_bytes);
    if (!text) return tl::unexpected(text.error());
    return parse(*text, file);
}

Value assigned_value(std::string_view assignment) {
    const std::size_t equals = assignment.find('=');
    const std::string text(trimmed(equals == std::string_view::npos ? assignment : assignment.substr(equals + 1)));
    Value value;
    value.data = text;
    Result<Document> parsed = parse("value = " + text, "--set");
    if (parsed && std::get<Table>(parsed->root.data).size() == 1) {
        value.data = std::move(std::get<Table>(parsed->root.data).front().second.data);
    }
    return value;
}

Status set(Document& document, std::string_view assignment) {
    const std::size_t equals = assignment.find('=');
    const std::string_view key = trimmed(assignment.substr(0, equals));
    if (equals == std::string_view::npos || key.empty())
        return input_error("--set {}: write KEY=VALUE, as in program.steps=10", assignment);
    const std::vector<std::string> parts = path_parts(key);
    if (parts.size() > max_depth + 1) return input_error("--set {}...: the key has too many parts", key.substr(0, 40));
    Value value = assigned_value(assignment);
    Value* node = &document.root;
    for (const std::string& part : parts) {
        Value* child = find_part(*node, part);
        if (child == nullptr) {
            // A table missing from the file may still be valid, as in program.steps; if not, it is reported as an
            // unknown key.
            auto* table = std::get_if<Table>(&node->data);
            if (table == nullptr || part.empty() || part.ends_with(']')) {
                const auto names = child_names(*node);
                const std::string near = nearest_name(part, names);
                return input_error("--set {}: there is no \"{}\" in {}{}", key, part, document.file.string(),
                                   near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near));
            }
            table->emplace_back(part, Value{});
            child = &table->back().second;
        }
        node = child;
    }
    set_lines(value, node->line);
    *node = std::move(value);
    return {};
}

Place place_of(const Document& document, std::string_view path) {
    Place place{&document.root, {}};
    for (std::string& part : path_parts(path)) {
        const Value* child = place.rest.empty() ? find_part(*place.value, part) : nullptr;
        if (child == nullptr)
            place.rest.push_back(std::move(part));
        else
            place.value = child;
    }
    return place;
}

Status resolve_parameters(Document& document) {
    Evaluator evaluator(document.file.string());
    auto& root = std::get<Table>(document.root.data);
    const auto found = std::find_if(root.begin(), root.end(), [](const Entry& e) { return e.first == "parameters"; });
    if (found != root.end()) {
        auto* table = std::get_if<Table>(&found->second.data);
        if (table == nullptr)
            return input_error_at(document.file.string(), found->second.line, "parameters: must be a table of numbers");
        for (const auto& [name, value] : *table) evaluator.announce(name);
        for (auto& [name, value] : *table) {
            if (Status status = evaluator.replace_formulas(value, "parameters." + name); !status) return status;
            double number = 0;
            if (const auto* whole = std::get_if<std::int64_t>(&value.data))
                number = static_cast<double>(*whole);
            else if (const auto* real = std::get_if<double>(&value.data))
                number = *real;
            else
                return input_error_at(document.file.string(), value.line,
                                      "parameters.{}: must be a number or \"= formula\"", name);
            if (Status status = evaluator.define(name, number, value.line); !status) return status;
        }
        root.erase(found);
    }
    return evaluator.replace_formulas(document.root, "");
}

}  // namespace pliant::config

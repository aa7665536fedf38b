#include "base/core/config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/core/letters.hpp"
#include "base/core/text.hpp"

namespace pliant::config {
namespace {

std::string in_quotes(std::string_view text) {
    constexpr std::size_t most = 40;
    const std::string line = one_line(text);
    return line.size() <= most ? fmt::format("\"{}\"", line) : fmt::format("\"{}...\"", line.substr(0, most));
}

/// What a file says where something else is needed: a value as it is written, of lists and tables their kind.
std::string shown(const Value& value) {
    struct Show {
        std::string operator()(bool flag) const { return flag ? "true" : "false"; }
        std::string operator()(std::int64_t whole) const { return std::to_string(whole); }
        std::string operator()(double real) const { return fmt::format("{}", real); }
        std::string operator()(const std::string& text) const { return in_quotes(text); }
        std::string operator()(const Array& list) const { return list.empty() ? "an empty list" : "a list"; }
        std::string operator()(const Table&) const { return "a table"; }
    };
    return std::visit(Show{}, value.data);
}

const Value* find_entry(const Value& table, std::string_view key) {
    for (const auto& [name, value] : std::get<Table>(table.data)) {
        if (name == key) return &value;
    }
    return nullptr;
}

/// A text as "2 mm".
bool has_unit(const Value& value) {
    const auto* text = std::get_if<std::string>(&value.data);
    if (text == nullptr) return false;
    const std::string_view number = trimmed(*text);
    const std::size_t digit = number.find_first_not_of("+-.");
    return digit < number.size() && is_digit(number[digit]) &&
           std::ranges::any_of(number, [](char c) { return is_letter(c); });
}

bool any_has_unit(const Value& list) {
    const auto* entries = std::get_if<Array>(&list.data);
    return entries != nullptr && std::ranges::any_of(*entries, has_unit);
}

std::optional<double> as_number(const Value& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return static_cast<double>(*whole);
    if (const auto* real = std::get_if<double>(&value.data); real != nullptr && std::isfinite(*real)) return *real;
    return std::nullopt;
}

std::optional<std::vector<double>> as_numbers(const Value& value) {
    const auto* list = std::get_if<Array>(&value.data);
    if (list == nullptr) return std::nullopt;
    std::vector<double> numbers;
    for (const Value& item : *list) {
        const auto number = as_number(item);
        if (!number) return std::nullopt;
        numbers.push_back(*number);
    }
    return numbers;
}

std::optional<Vec3> as_vector(const Value& value) {
    const auto numbers = as_numbers(value);
    if (!numbers || numbers->size() != 3) return std::nullopt;
    return Vec3{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

}  // namespace

void Problems::add(int line, std::string_view key, std::string_view text) {
    found_.push_back({file_, line, std::string(key), std::string(text)});
}

Status Problems::status() const {
    if (found_.empty()) return {};
    std::vector<Diagnostic> sorted = found_;
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.line < b.line; });
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    // More than a screenful is no help: with so many problems it is the wrong file, or one error near the top.
    constexpr std::size_t most = 12;
    if (sorted.size() > most) {
        const std::size_t more = sorted.size() - most;
        sorted.resize(most);
        sorted.push_back({file_, 0, "", fmt::format("and {} problems more", more)});
    }
    return tl::unexpected(error_of(Cause::input, std::move(sorted)));
}

Reader::Reader(const Value& table, Problems& problems, std::string path)
    : table_(&table), problems_(&problems), path_(std::move(path)), marks_(std::make_shared<Marks>()) {
    static const Value empty{};
    if (!std::holds_alternative<Table>(table.data)) {
        problems.add(table.line, path_, fmt::format("is {}, a table is needed", shown(table)));
        table_ = &empty;
        missing_ = true;
    }
}

std::string Reader::key_path(std::string_view key) const {
    if (key.empty()) return path_;
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

bool Reader::has(std::string_view key) const {
    return find_entry(*table_, key) != nullptr;
}

int Reader::line_of(std::string_view key) const {
    const Value* value = find_entry(*table_, key);
    return value != nullptr ? value->line : table_->line;
}

std::vector<std::string> Reader::keys() const {
    std::vector<std::string> names;
    for (const auto& [name, value] : std::get<Table>(table_->data)) names.push_back(name);
    return names;
}

void Reader::add(std::string_view key, std::string_view text) {
    if (!missing_) problems_->add(line_of(key), key_path(key), text);
}

void Reader::problem(std::string_view key, std::string_view text) {
    if (has(key)) (void)find(key);
    if (!unreadable(key)) add(key, text);
}

bool Reader::unreadable(std::string_view key) const {
    return std::find(marks_->unreadable.begin(), marks_->unreadable.end(), key) != marks_->unreadable.end();
}

void Reader::mark_unreadable(std::string_view key) {
    marks_->unreadable.emplace_back(key);
    for (const Marks* marks = marks_.get(); marks->above != nullptr; marks = marks->above.get())
        marks->above->unreadable.push_back(marks->key);
}

/// The first thing that is wrong with an unreadable value is enough.
void Reader::refuse(std::string_view key, std::string_view text) {
    problem(key, text);
    mark_unreadable(key);
}

const Value* Reader::find(std::string_view key) {
    if (std::find(marks_->asked.begin(), marks_->asked.end(), key) == marks_->asked.end()) {
        marks_->asked.emplace_back(key);
    }
    return find_entry(*table_, key);
}

const Value* Reader::find_required(std::string_view key, std::string_view what) {
    const Value* value = find(key);
    if (value == nullptr) {
        problem("", fmt::format("\"{}\" is missing; it is {}", key, what));
        mark_unreadable(key);
    }
    return value;
}

const Value* Reader::raw(std::string_view key) {
    return find(key);
}

std::string Reader::text(std::string_view key) {
    return find_required(key, "a text") != nullptr ? text(key, "") : std::string();
}

std::string Reader::text(std::string_view key, std::string_view fallback) {
    const Value* value = find(key);
    if (value == nullptr) return std::string(fallback);
    if (const auto* string = std::get_if<std::string>(&value->data)) return *string;
    refuse(key, fmt::format("is {}, a text in quotes is needed", shown(*value)));
    return std::string(fallback);
}

double Reader::number(std::string_view key) {
    return find_required(key, "a number") != nullptr ? number(key, 0.0) : 0.0;
}

double Reader::number(std::string_view key, double fallback) {
    const Value* value = find(key);
    if (value == nullptr) return fallback;
    if (const auto found = as_number(*value)) return *found;
    refuse(key, fmt::format("is {}, a finite number is needed{}", shown(*value),
                            has_unit(*value) ? ", without a unit" : ""));
    return fallback;
}

std::int64_t Reader::integer(std::string_view key) {
    return find_required(key, "a whole number") != nullptr ? integer(key, 0) : 0;
}

std::int64_t Reader::integer(std::string_view key, std::int64_t fallback) {
    const Value* value = find(key);
    if (value == nullptr) return fallback;
    if (const auto* whole = std::get_if<std::int64_t>(&value->data)) return *whole;
    // A formula gives a real number even if it is an integer.
    if (const auto real = as_number(*value); real && *real == std::floor(*real) && std::fabs(*real) < 1e15) {
        return static_cast<std::int64_t>(*real);
    }
    refuse(key, fmt::format("is {}, a whole number is needed", shown(*value)));
    return fallback;
}

int Reader::whole(std::string_view key, int low, int high) {
    return find_required(key, "a whole number") != nullptr ? whole(key, low, high, low) : low;
}

int Reader::whole(std::string_view key, int low, int high, int fallback) {
    const std::int64_t value = integer(key, fallback);
    if (has(key) && (value < low || value > high))
        problem(key, fmt::format("is {}, must be from {} to {}", value, low, high));
    return static_cast<int>(std::max<std::int64_t>(low, std::min<std::int64_t>(value, high)));
}

bool Reader::boolean(std::string_view key, bool fallback) {
    const Value* value = find(key);
    if (value == nullptr) return fallback;
    if (const auto* flag = std::get_if<bool>(&value->data)) return *flag;
    refuse(key, fmt::format("is {}, true or false is needed", shown(*value)));
    return fallback;
}

double Reader::quantity(std::string_view key, Dimension dimension) {
    return find_required(key, describe(dimension)) != nullptr ? quantity(key, dimension, 0.0) : 0.0;
}

double Reader::quantity(std::string_view key, Dimension dimension, double fallback) {
    const Value* value = find(key);
    if (value == nullptr) return fallback;
    if (const auto* string = std::get_if<std::string>(&value->data)) {
        const Result<double> parsed = parse_quantity(*string, dimension);
        if (parsed) return *parsed;
        refuse(key, parsed.error().message);
        return fallback;
    }
    if (const auto bare = as_number(*value)) {
        refuse(key, fmt::format("{} has no unit; write {}", *bare, describe(dimension)));
    } else {
        refuse(key, fmt::format("is {}; write {}", shown(*value), describe(dimension)));
    }
    return fallback;
}

std::vector<double> Reader::quantities(std::string_view key, Dimension dimension, std::size_t count) {
    const Value* value = find(key);
    std::vector<double> values(count, 0.0);
    if (value == nullptr) return values;
    const auto* list = std::get_if<Array>(&value->data);
    if (list == nullptr || list->size() != count) {
        refuse(key, fmt::format("needs a list of {} values, each {}", count, describe(dimension)));
        return values;
    }
    for (std::size_t i = 0; i < count; ++i) {
        const auto* string = std::get_if<std::string>(&(*list)[i].data);
        const Result<double> parsed =
            string != nullptr
                ? parse_quantity(*string, dimension)
                : Result<double>(input_error("entry {} has no unit; write {}", i + 1, describe(dimension)));
        if (parsed)
            values[i] = *parsed;
        else
            refuse(key, parsed.error().message);
    }
    return values;
}

std::vector<double> Reader::numbers(std::string_view key, std::size_t count) {
    const Value* value = find_required(key, "a list of numbers");
    if (value == nullptr) return std::vector<double>(count, 0.0);
    auto list = as_numbers(*value);
    if (list && (count == 0 || list->size() == count)) return *list;
    refuse(key, count == 0 ? std::string("needs a list of finite numbers")
                           : fmt::format("needs a list of {} finite numbers", count));
    return std::vector<double>(count, 0.0);
}

std::vector<std::string> Reader::texts(std::string_view key) {
    std::vector<std::string> list;
    const Value* value = find(key);
    if (value == nullptr) return list;
    const auto* items = std::get_if<Array>(&value->data);
    if (items == nullptr) {
        refuse(key, "needs a list of texts");
        return list;
    }
    for (const Value& item : *items) {
        if (const auto* string = std::get_if<std::string>(&item.data))
            list.push_back(*string);
        else
            refuse(key, fmt::format("holds {}, only texts are allowed", shown(item)));
    }
    return list;
}

Vec3 Reader::vector(std::string_view key) {
    return find_required(key, "a point [x, y, z]") != nullptr ? vector(key, Vec3{}) : Vec3{};
}

Vec3 Reader::vector(std::string_view key, const Vec3& fallback) {
    const Value* value = find(key);
    if (value == nullptr) return fallback;
    if (const auto vector = as_vector(*value)) return *vector;
    refuse(key, "needs three finite numbers [x, y, z]");
    return fallback;
}

std::vector<Vec3> Reader::vectors(std::string_view key) {
    std::vector<Vec3> points;
    const Value* value = find_required(key, "a list of points [[x, y, z], ...]");
    if (value == nullptr) return points;
    const auto* list = std::get_if<Array>(&value->data);
    if (list == nullptr) {
        refuse(key, "needs a list of points [[x, y, z], ...]");
        return points;
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        if (const auto point = as_vector((*list)[i]))
            points.push_back(*point);
        else
            refuse(key, fmt::format("entry {} is not a point [x, y, z] of finite numbers{}", i + 1,
                                    any_has_unit((*list)[i]) ? ", without units" : ""));
    }
    return points;
}

std::string Reader::choice(std::string_view key, const std::vector<std::string>& choices, std::string_view fallback) {
    const std::string found = fallback.empty() ? text(key) : text(key, fallback);
    if (std::find(choices.begin(), choices.end(), found) != choices.end()) return found;
    const Value* value = find_entry(*table_, key);
    if (value != nullptr && std::holds_alternative<std::string>(value->data)) {
        const std::string near = nearest_name(found, choices);
        refuse(key, fmt::format("\"{}\" is not known{}; choose from {}", found,
                                near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near), join_names(choices)));
    }
    return fallback.empty() ? choices.front() : std::string(fallback);
}

Reader Reader::table(std::string_view key, bool required) {
    static const Value empty{};
    const Value* value = required ? find_required(key, "a table") : find(key);
    Reader reader(value != nullptr ? *value : empty, *problems_, key_path(key));
    reader.missing_ = reader.missing_ || missing_ || (value == nullptr && required);
    reader.marks_->above = marks_;
    reader.marks_->key = key;
    if (value != nullptr && !std::holds_alternative<Table>(value->data)) mark_unreadable(key);
    return reader;
}

std::vector<Reader> Reader::tables(std::string_view key) {
    std::vector<Reader> readers;
    const Value* value = find(key);
    if (value == nullptr) return readers;
    const auto* list = std::get_if<Array>(&value->data);
    if (list == nullptr) {
        refuse(key, fmt::format("is {}; write [[{}]] for each", shown(*value), key_path(key)));
        return readers;
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        readers.emplace_back((*list)[i], *problems_, fmt::format("{}[{}]", key_path(key), i));
        readers.back().marks_->above = marks_;
        readers.back().marks_->key = key;
    }
    return readers;
}

std::vector<std::pair<std::string, Reader>> Reader::named_tables(std::string_view key) {
    std::vector<std::pair<std::string, Reader>> readers;
    const Value* value = find(key);
    if (value == nullptr) return readers;
    const auto* table = std::get_if<Table>(&value->data);
    if (table == nullptr) {
        refuse(key, fmt::format("is {}; write [{}.NAME] for each", shown(*value), key_path(key)));
        return readers;
    }
    for (const auto& [name, entry] : *table) {
        readers.emplace_back(name, Reader(entry, *problems_, fmt::format("{}.{}", key_path(key), name)));
    }
    return readers;
}

namespace {

/// The only one of these names that begins with what was written, as "fixed" does with "fix"; "" if there is none.
std::string completed_name(std::string_view written, const std::vector<std::string>& names) {
    constexpr std::size_t least = 3;
    std::string found;
    for (const std::string& name : names) {
        if (written.size() < least || !name.starts_with(written)) continue;
        if (!found.empty() && found != name) return "";
        found = name;
    }
    return found;
}

}  // namespace

void Reader::finish() {
    for (const auto& [name, value] : std::get<Table>(table_->data)) {
        if (std::find(marks_->asked.begin(), marks_->asked.end(), name) != marks_->asked.end()) continue;
        std::string near = nearest_name(name, marks_->asked);
        if (near.empty()) near = completed_name(name, marks_->asked);
        add(name, near.empty() ? "unknown key; known here: " + join_names(marks_->asked)
                               : fmt::format("unknown key; did you mean \"{}\"?", near));
    }
}

}  // namespace pliant::config

#include "loop/study/values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/core/letters.hpp"
#include "base/core/units.hpp"

namespace pliant::study {
namespace {

using config::Value;

/// A TOML number, boolean or string in the form that `--set` takes.
std::optional<std::string> scalar_text(const Value& value) {
    if (const auto* text = std::get_if<std::string>(&value.data)) return *text;
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return fmt::format("{}", *whole);
    if (const auto* real = std::get_if<double>(&value.data)) return number_text(*real);
    if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "true" : "false";
    return std::nullopt;
}

/// The texts of a list; a problem if it is not a list, is empty or contains lists.
std::vector<std::string> texts_of(config::Reader& table, std::string_view key) {
    std::vector<std::string> texts;
    const Value* value = table.raw(key);
    const auto* list = value == nullptr ? nullptr : std::get_if<config::Array>(&value->data);
    if (list == nullptr || list->empty()) {
        table.problem(key, "must be a list of values, as in [1, 2, 4] or [\"5 MPa\", \"20 MPa\"]");
        return texts;
    }
    for (const Value& item : *list) {
        const auto text = scalar_text(item);
        if (!text || text->empty()) {
            table.problem(key, "each value must be a number or a text");
            return {};
        }
        texts.push_back(*text);
    }
    return texts;
}

/// Splits off the unit if all values are numbers with the same unit. What is left is as written: a value may be part of
/// a file's name.
void find_common_unit(Choice& choice) {
    std::vector<Measure> measures;
    for (const std::string& value : choice.values) {
        const auto measure = read_measure(value);
        choice.numeric = measure && (measures.empty() || measures.front().unit == measure->unit);
        if (!choice.numeric) return;
        measures.push_back(*measure);
    }
    choice.unit = measures.front().unit;
    const std::string& gap = measures.front().gap;
    if (std::ranges::all_of(measures, [&](const Measure& m) { return m.gap == gap; })) choice.gap = gap;
    for (std::size_t k = 0; k < measures.size(); ++k) choice.values[k] = measures[k].written;
}

void read_range(config::Reader& table, Choice& choice) {
    const std::vector<std::string> ends = texts_of(table, "range");
    choice.log = table.choice("scale", {"linear", "log"}, "linear") == "log";
    choice.whole = table.boolean("whole", false);
    if (ends.empty()) return;
    const auto low = read_measure(ends[0]), high = read_measure(ends.back());
    if (ends.size() != 2 || !low || !high)
        return table.problem("range",
                             "must be two numbers, each with its unit if there is one, as in [\"5 MPa\", \"20 MPa\"]");
    if (low->unit != high->unit)
        return table.problem("range", fmt::format("its ends have the units \"{}\" and \"{}\"; write both in one unit",
                                                  low->unit, high->unit));
    if (!(low->number < high->number))
        return table.problem("range", fmt::format("is empty: {} is not below {}", ends[0], ends[1]));
    choice.low = low->number;
    choice.high = high->number;
    choice.unit = low->unit;
    if (choice.log && !(choice.low > 0)) table.problem("scale", "\"log\" needs a range above zero");
    if (choice.log && choice.whole)
        table.problem("scale", "\"log\" and whole numbers do not go together; list the values");
    const bool ends_whole = std::floor(choice.low) == choice.low && std::floor(choice.high) == choice.high;
    if (choice.whole && !(ends_whole && std::abs(choice.low) < 1e9 && std::abs(choice.high) < 1e9))
        table.problem("range", "of whole numbers must begin and end with one");
}

double number_at(const Choice& choice, double share) {
    if (share == 0) return choice.low;
    if (share == 1) return choice.high;
    if (choice.log) return choice.low * std::pow(choice.high / choice.low, share);
    return choice.low + (choice.high - choice.low) * share;
}

}  // namespace

std::optional<Measure> read_measure(std::string_view text) {
    text = trimmed(text);
    const std::size_t sign = text.starts_with('+') ? 1 : 0;
    double number = 0;
    const auto [end, error] = std::from_chars(text.data() + sign, text.data() + text.size(), number);
    if (error != std::errc{} || !std::isfinite(number)) return std::nullopt;
    const auto digits = static_cast<std::size_t>(end - text.data());
    const std::string_view rest = text.substr(digits), unit = trimmed(rest);
    // Anything else behind a number makes it a word: a version, a date, a shore hardness, the name of a file.
    if (!unit.empty() && !is_unit(unit)) return std::nullopt;
    return Measure{number, std::string(unit), std::string(text.substr(0, digits)),
                   std::string(rest.substr(0, rest.size() - unit.size()))};
}

std::string number_text(double number) {
    return fmt::format("{}", number);
}

Choice read_choice(config::Reader& table) {
    Choice choice;
    if (table.has("range") == table.has("values")) {
        (void)table.raw("range");
        (void)table.raw("values");
        table.problem("", table.has("range") ? "has both range and values; keep one of them"
                                             : "needs a range, as in range = [0.7, 0.95], or a list of values");
        return choice;
    }
    if (table.has("range")) {
        read_range(table, choice);
        constexpr int most_levels = 1'000'000;
        const auto levels = table.integer("levels", 0);
        if (table.has("levels") && (levels < 2 || levels > most_levels))
            table.problem("levels", fmt::format("must be from 2 to {}", most_levels));
        else
            choice.levels = static_cast<int>(levels);
        return choice;
    }
    choice.values = texts_of(table, "values");
    if (!choice.values.empty()) find_common_unit(choice);
    return choice;
}

std::string value_at(const Choice& choice, double u) {
    if (!choice.values.empty()) {
        const auto count = static_cast<double>(choice.values.size());
        return choice.values[std::min(choice.values.size() - 1, static_cast<std::size_t>(u * count))];
    }
    if (choice.whole)
        return number_text(std::min(choice.high, choice.low + std::floor(u * (choice.high - choice.low + 1))));
    return number_text(number_at(choice, u));
}

std::vector<std::string> levels_of(const Choice& choice) {
    if (!choice.values.empty()) return choice.values;
    std::vector<std::string> levels;
    if (choice.whole && choice.levels == 0) {
        for (double number = choice.low; number <= choice.high && levels.size() <= 1'000'000; ++number)
            levels.push_back(number_text(number));
        return levels;
    }
    for (int k = 0; k < choice.levels; ++k) {
        const double number = number_at(choice, static_cast<double>(k) / (choice.levels - 1));
        const std::string text = number_text(choice.whole ? std::round(number) : number);
        if (levels.empty() || levels.back() != text) levels.push_back(text);
    }
    return levels;
}

}  // namespace pliant::study

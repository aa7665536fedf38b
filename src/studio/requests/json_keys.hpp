// Reads the keys of a JSON object sent by a page: limited in size and depth, with errors that name the key.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::studio {

/// Reads keys of one object and keeps the first error.
class Keys {
public:
    /// `what` is for messages. Both must outlive it.
    Keys(const char* what, const nlohmann::json& object) : what_(what), object_(object) {}

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
    const nlohmann::json& list(const char* key) {
        static const nlohmann::json empty = nlohmann::json::array();
        const auto found = object_.find(key);
        if (found == object_.end() || !found->is_array() || found->size() > longest_list)
            return wrong(key, "a list of at most 256"), empty;
        return *found;
    }
    void wrong(const char* key, const char* wanted, bool many = false) {
        if (error_.empty()) error_ = fmt::format("{}: {}: {} {} needed", what_, key, wanted, many ? "are" : "is");
    }
    [[nodiscard]] const std::string& error() const { return error_; }

    std::vector<std::string> texts(const char* key) {
        std::vector<std::string> all;
        for (const nlohmann::json& one : list(key)) {
            if (!one.is_string() || one.get_ref<const std::string&>().size() > longest_name)
                return wrong(key, "a list of texts"), all;
            all.push_back(one.get<std::string>());
        }
        return all;
    }
    std::array<double, 3> point(const char* key) { return point(key, list(key)); }
    /// `value`: the value under the key, or an element of a list there.
    std::array<double, 3> point(const char* key, const nlohmann::json& value) {
        std::array<double, 3> point{};
        for (std::size_t k = 0; k < 3; ++k) {
            const bool good = value.is_array() && value.size() == 3 && value[k].is_number() &&
                              std::fabs(value[k].get<double>()) <= largest_number;
            if (!good) return wrong(key, "three numbers", true), std::array<double, 3>{};
            point[k] = value[k].get<double>();
        }
        return point;
    }

private:
    static constexpr std::size_t longest_list = 256, longest_name = 200;
    static constexpr double largest_number = 1e9;
    const char* what_;
    const nlohmann::json& object_;
    std::string error_;
};

/// True if a text is one JSON object.
[[nodiscard]] bool is_object(std::string_view text);

/// Errors: longer than `longest` bytes, nested too deeply, not an object.
[[nodiscard]] Result<nlohmann::json> parse_object(const char* what, std::string_view text, std::size_t longest);

}  // namespace pliant::studio

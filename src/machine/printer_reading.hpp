// Reading keys of a printer file: quantities in its units, with the ranges that hold for any of them; and the tables
// that stand in a file of their own.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "core/config.hpp"
#include "machine/printer.hpp"

namespace pliant::machine::reading {

using config::Reader;

inline constexpr double longest_um = 1e8;  // 100 m: far beyond any machine, and safe to add up in an int

inline int checked_um(Reader& r, std::string_view key, double metres) {
    const double um = metres * 1e6;
    if (std::abs(um) <= longest_um) return static_cast<int>(std::lround(um));
    r.problem(key, "is over 100 m");
    return 0;
}

inline int length_um(Reader& r, std::string_view key, int low_um = 0) {
    const int um = checked_um(r, key, r.quantity(key, Dimension::length));
    if (r.has(key) && um < low_um) r.problem(key, fmt::format("must be at least {} um", low_um));
    return um;
}

inline double positive(Reader& r, std::string_view key, Dimension dimension, double factor) {
    const double value = r.quantity(key, dimension) * factor;
    if (r.has(key) && !(value > 0)) r.problem(key, "must be above 0");
    return value;
}

inline double not_negative(Reader& r, std::string_view key, Dimension dimension, double factor = 1) {
    const double value = r.quantity(key, dimension, 0) * factor;
    if (value < 0) r.problem(key, "must not be negative");
    return value;
}

inline int whole(Reader& r, std::string_view key, int low, int high) {
    const auto value = r.integer(key);
    if (r.has(key) && (value < low || value > high)) {
        r.problem(key, fmt::format("is {}, must be from {} to {}", value, low, high));
    }
    return static_cast<int>(std::clamp<std::int64_t>(value, low, high));
}

inline double speed(Reader& r, std::string_view key) {
    return positive(r, key, Dimension::speed, 1e3);
}

inline constexpr double degrees = 180 / std::numbers::pi;

inline double share(Reader& r, std::string_view key, double fallback) {
    const double value = r.number(key, fallback);
    if (!(value >= 0 && value <= 1)) r.problem(key, "must be a share from 0 to 1");
    return value;
}

/// [cleaning]; `clearance_um` is the platform's.
[[nodiscard]] Cleaning read_cleaning(Reader r, Store store, int clearance_um);
/// [solution]
[[nodiscard]] Solution read_solution(Reader r);
/// [[sprinkler]]; needs what read_cleaning() gives.
void read_sprinklers(Reader& root, Printer& p);

}  // namespace pliant::machine::reading

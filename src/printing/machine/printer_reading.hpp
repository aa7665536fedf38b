// Parsing of printer files: quantities in the file's units, with range checks, and the tables that have a source file
// of their own.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "base/core/config.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine::reading {

using config::Reader;

inline constexpr double longest_um = 1e8;  // 100 m: far beyond any machine, and small enough to add in an int

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

/// A wait between commands. Longer ones are slips of the unit, and their numbers too large for G-code.
inline double wait_s(Reader& r, std::string_view key) {
    constexpr double most_s = 3600;
    const double value = not_negative(r, key, Dimension::time);
    if (value > most_s) r.problem(key, fmt::format("is {:g} s, must be at most {:g} s", value, most_s));
    return value;
}

inline double speed(Reader& r, std::string_view key) {
    return positive(r, key, Dimension::speed, 1e3);
}

inline constexpr double degrees = 180 / std::numbers::pi;

inline double not_negative_number(Reader& r, std::string_view key, double fallback) {
    const double value = r.number(key, fallback);
    if (!(value >= 0 && value <= 1e6)) r.problem(key, "must not be negative");
    return value;
}

inline double share(Reader& r, std::string_view key, double fallback) {
    const double value = r.number(key, fallback);
    if (!(value >= 0 && value <= 1)) r.problem(key, "must be a share from 0 to 1");
    return value;
}

/// A position of the table: a length, or an angle in thousandths of a degree.
inline int place_um(Reader& r, std::string_view key, double value, bool rotary) {
    return checked_um(r, key, rotary ? value * degrees * 1e-3 : value);
}

inline Dimension place_dimension(bool rotary) {
    return rotary ? Dimension::angle : Dimension::length;
}

/// Which tables of a store the file has.
struct StoreTables {
    bool tower = false, wall = false, table = false;

    [[nodiscard]] bool carriage() const { return tower || wall; }
    [[nodiscard]] Store names() const { return wall ? Store::wall : Store::tower; }  ///< for axis_name()
};
[[nodiscard]] StoreTables store_tables(Reader& root);
/// [carriage], [tower], [wall], [hooks], [table]; needs the axes.
void read_store(Reader& root, Printer& p, const StoreTables& tables);
/// Checks the force of the magnet; needs the vats.
void check_magnet(Reader& root, const Printer& p);
/// Checks that every station is within the travel of its axis, and that no two are at the same place.
void check_store(Reader& root, const Printer& p);

/// A switch may only switch: motion commands hidden in the printer file would bypass every interlock of the planner.
[[nodiscard]] Switch read_switch(Reader r);
/// The same for commands that are keys among others.
void check_switch_commands(Reader& r, const Switch& s);
/// [pump], [[fan]], [[limit_switch]], [door], [emergency_line].
void read_switches(Reader& root, Printer& p);
/// Checks that no output is used by two devices, and that either all limit switches are listed or none.
void check_switches(Reader& root, const Printer& p);

/// [cleaning]; `clearance_um` is the platform's.
[[nodiscard]] Cleaning read_cleaning(Reader r, Store store, int clearance_um);
/// [solution]
[[nodiscard]] Solution read_solution(Reader r);
/// [[sprinkler]]; needs the result of read_cleaning().
void read_sprinklers(Reader& root, Printer& p);

}  // namespace pliant::machine::reading

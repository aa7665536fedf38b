#include "presentation/report/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pliant::report {
namespace {

/// A value that is rounded to 0 has no sign.
std::string fixed(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    if (text.find_first_not_of("-0.") == std::string::npos && text.front() == '-') text.erase(0, 1);
    return text;
}

}  // namespace

std::string readable(double value, int decimals, double rounding) {
    return readable({&value, 1}, decimals, rounding);
}

std::string readable(std::span<const double> values, int decimals, double rounding) {
    constexpr double most = 1e7, least_share = 1e-6;
    double largest = 0;
    for (const double value : values) largest = std::max(largest, std::fabs(value));
    const bool fits = largest <= rounding || (largest >= 0.5 * std::pow(10, -decimals) && largest < most);
    std::string text;
    for (const double value : values) {
        if (!text.empty()) text += ", ";
        if (fits)
            text += fixed(value, decimals);
        else
            text += fmt::format("{:.5g}", std::fabs(value) < least_share * largest ? 0.0 : value);
    }
    return text;
}

}  // namespace pliant::report

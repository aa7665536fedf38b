#include "geometry/mesh/printed_digits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/core/letters.hpp"

namespace pliant::mesh {

void PrintedDigits::see(std::string_view number) {
    if (number.empty()) return;
    int digits = 0;
    int decimals = 0;
    bool behind_point = false;
    for (const char c : number) {
        if (c == 'e' || c == 'E') {
            exponents_ = true;
            break;
        }
        if (c == '.') behind_point = true;
        if (!is_digit(c)) continue;
        decimals += behind_point ? 1 : 0;
        digits += c != '0' || digits > 0 ? 1 : 0;
    }
    most_digits_ = std::max(most_digits_, digits);
    least_decimals_ = least_decimals_ < 0 ? decimals : std::min(least_decimals_, decimals);
    most_decimals_ = std::max(most_decimals_, decimals);
}

double PrintedDigits::step(double size) const {
    if (most_digits_ == 0) return 0;
    if (!exponents_ && least_decimals_ == most_decimals_) return std::pow(10.0, -most_decimals_);
    return std::pow(10.0, std::floor(std::log10(size)) + 1 - most_digits_);
}

double float_step(double size) {
    const auto at = static_cast<float>(std::min(size, 1e38));
    return static_cast<double>(std::nextafter(at, std::numeric_limits<float>::max())) - static_cast<double>(at);
}

}  // namespace pliant::mesh

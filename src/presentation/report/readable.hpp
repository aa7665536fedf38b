// Numbers as people read them, whatever their size.
#pragma once

#include <span>
#include <string>

namespace pliant::report {

/// With this number of decimals; with five significant digits where those would show nothing but zeros, or more than
/// seven digits before the point. Values up to `rounding` count as zero.
[[nodiscard]] std::string readable(double value, int decimals, double rounding = 1e-12);
/// "1.0, 2.0, 3.0": all alike, by the largest of them; what is less than a millionth of it is 0.
[[nodiscard]] std::string readable(std::span<const double> values, int decimals, double rounding = 1e-12);

}  // namespace pliant::report

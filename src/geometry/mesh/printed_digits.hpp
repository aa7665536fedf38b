// The precision of the coordinates in a file.
#pragma once

#include <string_view>

namespace pliant::mesh {

/// Infers from the numbers of a text to how many digits they were printed: a fixed number of decimals, or of
/// significant digits.
class PrintedDigits {
public:
    /// A number as written in the text; "" is ignored.
    void see(std::string_view number);
    /// Spacing of printed numbers near `size` (above 0); 0 if no number was seen.
    [[nodiscard]] double step(double size) const;

private:
    int most_digits_ = 0;  ///< significant ones, without leading zeros
    int least_decimals_ = -1, most_decimals_ = -1;
    bool exponents_ = false;
};

/// Spacing of 32-bit floats near `size`, which is not negative.
[[nodiscard]] double float_step(double size);

}  // namespace pliant::mesh

// How finely the coordinates of a file are known.
#pragma once

#include <string_view>

namespace pliant::mesh {

/// Looks at the numbers of a text to see to how many digits they were printed: either all to so many decimals, or all
/// to so many digits that count.
class PrintedDigits {
public:
    /// A number as it stands in the text; "" is passed over.
    void see(std::string_view number);
    /// Between neighbouring numbers about as large as `size` (above 0), as printed; 0 if none was seen.
    [[nodiscard]] double step(double size) const;

private:
    int most_digits_ = 0;  ///< that count: without zeros in front
    int least_decimals_ = -1, most_decimals_ = -1;
    bool exponents_ = false;
};

/// Between neighbouring 32-bit numbers about as large as `size`, which is not negative.
[[nodiscard]] double float_step(double size);

}  // namespace pliant::mesh

// A picture of what the spray leaves on a part.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/wash/spray.hpp"

namespace pliant::report {

/// A PNG file of 1600 x 800 pixels: the part seen from the jets and from the platform, coloured by the share of the
/// film that remains. `cleanness` belongs to `faces`. Errors: a part without a face.
[[nodiscard]] Result<std::string> wash_picture(std::string_view title, const wash::PartCells& part,
                                               const std::vector<wash::Face>& faces, const wash::Cleanness& cleanness);

}  // namespace pliant::report

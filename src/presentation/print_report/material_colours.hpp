// The colours in which pictures and reports of a print show the materials of its job.
#pragma once

#include <vector>

#include "presentation/draw/colour.hpp"
#include "printing/job/job.hpp"

namespace pliant::report {

/// (materials) sRGB: the colour that was chosen for a material, else that of the palette.
[[nodiscard]] std::vector<Colour> material_colours(const job::Manifest& job);

}  // namespace pliant::report

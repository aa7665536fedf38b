// Shape quality of the tets of a mesh: two histograms in one picture.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "geometry/mesh/mesh_report.hpp"

namespace pliant::report {

/// Shape quality and dihedral angles, with worst, median and count per region; 8-bit RGB, 1600 x 900 pixels.
[[nodiscard]] Result<std::string> mesh_picture_png(std::string_view title, const mesh::MeshReport& report);

}  // namespace pliant::report

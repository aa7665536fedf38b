// Hand-painted supports, as a table that a job keeps and `pliant slice --support-paint` reads.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/slice/support_paint.hpp"

namespace pliant::prepare {

/// Name of the table in a job.
inline constexpr const char* paint_entry = "supports.csv";

/// One brush stroke per line, in order: `wish` (enforce, block or usual), `x (mm)`, `y (mm)`, `z (mm)` on the surface
/// of the part as drawn, the outward normal `nx`, `ny`, `nz` there, and `radius (mm)`. Further columns are ignored.
/// Errors name file and line: a missing column, another wish, what slice::check() rejects, more than 100000 strokes.
[[nodiscard]] Result<std::vector<slice::SupportTouch>> read_paint(std::string_view text, const std::string& file);

}  // namespace pliant::prepare

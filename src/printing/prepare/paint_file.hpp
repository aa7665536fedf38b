// Supports painted by hand, as a table that a job keeps and `pliant slice --support-paint` reads again.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/slice/support_paint.hpp"

namespace pliant::prepare {

/// What a job calls the table.
inline constexpr const char* paint_entry = "supports.csv";

/// A touch of the brush in a line, in their order: `wish` (enforce, block or usual), `x (mm)`, `y (mm)`, `z (mm)` on
/// the surface of the part as it was drawn, the outward normal `nx`, `ny`, `nz` there, and `radius (mm)`. Further
/// columns are passed over. Errors name file and line: a missing column, another wish, what slice::check() refuses,
/// more than 100000 touches.
[[nodiscard]] Result<std::vector<slice::SupportTouch>> read_paint(std::string_view text, const std::string& file);

}  // namespace pliant::prepare

// Scaling and turning a part, and laying out copies of it.
#pragma once

#include <string>
#include <vector>

#include "printing/slice/body.hpp"

namespace pliant::slice {

/// Makes all bodies `factor` times as large, seen from the origin. Errors: a factor that is not 0.01 to 100.
[[nodiscard]] Status scale(std::vector<Body>& bodies, double factor);

/// Turns all bodies about x, then y, then z, by degrees, counter-clockwise seen from the axis' end. Quarter turns are
/// exact. Errors: a body of slices is turned about another axis than z.
[[nodiscard]] Status turn(std::vector<Body>& bodies, const Vec3& degrees);

/// Repeats the part `count` times in a grid of as few rows as the image's width allows, `spacing_um` apart; place the
/// result with place_on_platform(). Names of copies end in " #2", " #3" and so on. Errors, with numbers: fewer than 1
/// or more than 10000 copies, a spacing below 0, or how many copies the image has room for.
[[nodiscard]] Status repeat(std::vector<Body>& bodies, int count, double spacing_um, const Raster& raster);

}  // namespace pliant::slice

// An object's mesh as bodies of one material each.
#pragma once

#include <string>
#include <vector>

#include "geometry/threemf/model_part.hpp"

namespace pliant::threemf {

/// The object's mesh, or the shells of it that one material bounds, in the part's unit. A shell of several materials
/// stays one body, of the object's material or else the one of most triangles, and `warnings` says so.
[[nodiscard]] std::vector<Body> split_by_material(const Object& object, std::vector<std::string>& warnings);

}  // namespace pliant::threemf

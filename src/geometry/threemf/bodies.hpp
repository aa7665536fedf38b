// Splits an object's mesh into bodies of one material each.
#pragma once

#include <string>
#include <vector>

#include "geometry/threemf/model_part.hpp"

namespace pliant::threemf {

/// The object's mesh, or its shells if each has one material, in the part's unit. A shell of several materials stays
/// one body, of the object's material or else that of most triangles, and `warnings` says so.
[[nodiscard]] std::vector<Body> split_by_material(const Object& object, std::vector<std::string>& warnings);

}  // namespace pliant::threemf

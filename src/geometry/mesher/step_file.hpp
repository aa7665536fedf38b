// Solids from STEP files (ISO 10303-21), with their exact curved faces.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// True if the bytes begin like a STEP file.
[[nodiscard]] bool looks_like_step(std::string_view bytes);

/// The solids of a file whose CAD name is `part`; all of them if it is empty. `scale`: the caller's length units per
/// millimetre (the file states its own unit). Errors name the file and, for a missing part, the parts available.
[[nodiscard]] Result<Solid> read_step(const std::filesystem::path& path, const std::string& part, double scale);

}  // namespace pliant::mesh

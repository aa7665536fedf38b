// The shapes of drawings, as messages about them call them.
#pragma once

#include <span>
#include <string>

#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// The shapes that solids consist of, the first few of them, with their places as they are drawn.
[[nodiscard]] std::string shapes_of(std::span<const Solid> solids);

/// True if a sphere or a cylinder is among them.
[[nodiscard]] bool has_round_shapes(const Solid& solid);

/// What to do where shapes cannot be combined.
inline constexpr const char* advice_on_contact =
    "this happens where round faces touch or nearly do: move or turn one of these shapes by a little, a thousandth of "
    "its size";

}  // namespace pliant::mesh

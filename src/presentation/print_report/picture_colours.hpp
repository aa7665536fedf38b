// Colours that all pictures of a print have in common.
#pragma once

#include "presentation/draw/colour.hpp"

namespace pliant::report {

inline constexpr Colour paper{1, 1, 1};
inline constexpr Colour ink{0.16, 0.18, 0.22};  ///< of text

}  // namespace pliant::report

// Two materials finely mixed, as one.
#pragma once

#include "robot/description/law.hpp"

namespace pliant::material {

/// The law of a mixture with so much of the second, 0 to 1, where both are deformed alike: its energy is the mean of
/// theirs by their shares (Voigt 1889), which no mixture exceeds. Exact where both are of one kind whose energy is
/// linear in its constants, and at 0 and 1; otherwise neo-Hookean with the mean moduli of small strains.
[[nodiscard]] Law mixed(const Law& first, const Law& second, double share_of_second);

}  // namespace pliant::material

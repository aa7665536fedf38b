// A fine mixture of two materials as one material.
#pragma once

#include "robot/description/law.hpp"

namespace pliant::material {

/// The law of a mixture with the given share of the second, 0 to 1, assuming equal deformation of both: its energy is
/// the mean of theirs weighted by the shares (Voigt 1889), an upper bound. Exact if both laws are of the same kind with
/// an energy linear in the constants, and at 0 and 1; otherwise neo-Hookean with the mean small-strain moduli.
[[nodiscard]] Law mixed(const Law& first, const Law& second, double share_of_second);

}  // namespace pliant::material

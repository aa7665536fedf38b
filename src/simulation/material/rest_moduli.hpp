// Small-strain moduli of a law.
#pragma once

#include "robot/description/law.hpp"

namespace pliant::material {

/// Hooke's law at rest: stress = lame tr(e) I + 2 shear e, with the small strain e.
struct RestModuli {
    double lame_Pa, shear_Pa;
};

/// Of the law's tangent at F = I; such that the quadratic form is positive semi-definite.
[[nodiscard]] RestModuli rest_moduli(const Law& law);

}  // namespace pliant::material

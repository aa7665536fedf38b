#include "simulation/material/rest_moduli.hpp"

#include <algorithm>

#include "simulation/material/response.hpp"

namespace pliant::material {

RestModuli rest_moduli(const Law& law) {
    const Matrix9 H = tangent(law, Matrix3::Identity());
    const double shear_Pa = std::max(0.0, 0.5 * (H(0, 0) - H(0, 4)));
    return {std::max(H(0, 4), -2.0 / 3 * shear_Pa), shear_Pa};
}

}  // namespace pliant::material

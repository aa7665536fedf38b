// The corotated law: Hooke's law in the frame that rotates with the material.
#include "simulation/material/point.hpp"

namespace pliant::material {

std::optional<double> psi(const Corotated& law, const Matrix3& F) {
    const double change = F.determinant() - 1;
    return law.shear_Pa * (F - linalg::nearest_rotation(F)).squaredNorm() + 0.5 * law.lame_Pa * change * change;
}

Matrix3 first_piola(const Corotated& law, const Matrix3& F) {
    return 2 * law.shear_Pa * (F - linalg::nearest_rotation(F)) + law.lame_Pa * (F.determinant() - 1) * cofactor(F);
}

Matrix9 first_piola_gradient(const Corotated& law, const Matrix3& F) {
    const Vector9 c = vec(cofactor(F));
    Matrix9 H = -2 * law.shear_Pa * linalg::nearest_rotation_gradient(linalg::signed_svd(F));
    H.diagonal().array() += 2 * law.shear_Pa;
    H += law.lame_Pa * (c * c.transpose());
    add_cofactor_gradient(H, F, law.lame_Pa * (F.determinant() - 1));
    return H;
}

Slopes stress_slopes(const Corotated& /*law*/, const Matrix3& F) {
    return {2 * (F - linalg::nearest_rotation(F)), (F.determinant() - 1) * cofactor(F)};
}

}  // namespace pliant::material

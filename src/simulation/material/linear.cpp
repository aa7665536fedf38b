// Hooke's law of small displacements: the strain is linear in F, and sees a rotation as a strain.
#include "simulation/material/point.hpp"

namespace pliant::material {
namespace {

Matrix3 small_strain(const Matrix3& F) {
    return 0.5 * (F + F.transpose()) - Matrix3::Identity();
}

}  // namespace

std::optional<double> psi(const Linear& law, const Matrix3& F) {
    const Matrix3 strain = small_strain(F);
    return law.shear_Pa * strain.squaredNorm() + 0.5 * law.lame_Pa * strain.trace() * strain.trace();
}

Matrix3 first_piola(const Linear& law, const Matrix3& F) {
    const Matrix3 strain = small_strain(F);
    return 2 * law.shear_Pa * strain + law.lame_Pa * strain.trace() * Matrix3::Identity();
}

Matrix9 first_piola_gradient(const Linear& law, const Matrix3& /*F*/) {
    Matrix9 H = Matrix9::Zero();
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {  // dP_ij = mu (dF_ij + dF_ji) + lambda delta_ij tr dF; entry ij is row i + 3 j
            H(i + 3 * j, i + 3 * j) += law.shear_Pa;
            H(i + 3 * j, j + 3 * i) += law.shear_Pa;
            H(4 * i, 4 * j) += law.lame_Pa;
        }
    }
    return H;
}

Slopes stress_slopes(const Linear& /*law*/, const Matrix3& F) {
    const Matrix3 strain = small_strain(F);
    return {2 * strain, strain.trace() * Matrix3::Identity()};
}

}  // namespace pliant::material

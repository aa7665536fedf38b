// The target shapes of the thesis' actuators.
#include "material/point.hpp"

namespace pliant::material {

std::optional<double> psi(const ScaledTarget& law, const Matrix3& F) {
    const Matrix3 R = linalg::nearest_rotation(F * law.target.transpose());
    return 0.5 * law.weight_Pa * (F - R * law.target).squaredNorm();
}

Matrix3 first_piola(const ScaledTarget& law, const Matrix3& F) {
    const Matrix3 R = linalg::nearest_rotation(F * law.target.transpose());
    return law.weight_Pa * (F - R * law.target);
}

Matrix9 first_piola_gradient(const ScaledTarget& law, const Matrix3& F) {
    const Matrix9 dR = linalg::nearest_rotation_gradient(linalg::signed_svd(F * law.target.transpose()));
    Matrix9 H;
    for (int k = 0; k < 9; ++k) {
        Matrix3 dF = Matrix3::Zero();
        dF(k % 3, k / 3) = 1;
        const Vector9 turned = dR * vec(dF * law.target.transpose());
        H.col(k) = law.weight_Pa * vec(dF - Eigen::Map<const Matrix3>(turned.data()) * law.target);
    }
    return H;
}

}  // namespace pliant::material

// Small fixed-size matrices.
#pragma once

#include <Eigen/Core>

namespace pliant::linalg {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Matrix9 = Eigen::Matrix<double, 9, 9>;  ///< maps vec(dF) to vec(dP), both stacked column by column

/// F = U diag(sigma) V^T with rotations U and V (determinant +1): where det F < 0 the smallest singular value is
/// negative, so that U V^T is never a reflection (thesis, appendix A.3).
struct Svd3 {
    Matrix3 U;
    Vector3 sigma;  ///< descending, the last one signed
    Matrix3 V;
};
[[nodiscard]] Svd3 signed_svd(const Matrix3& F);

/// The rotation nearest to F in the Frobenius norm, U V^T of signed_svd.
[[nodiscard]] Matrix3 nearest_rotation(const Matrix3& F);

/// Derivative of the nearest rotation with respect to F. Unbounded where two signed singular values sum to zero; the
/// sum is kept away from zero, so the result stays finite.
[[nodiscard]] Matrix9 nearest_rotation_gradient(const Svd3& svd);

inline constexpr double weak_share = 1e-3;  ///< of a negative eigenvalue's size, which a positive one replaces
/// The symmetric part of H, in which each negative eigenvalue l is replaced by -weak_share l.
[[nodiscard]] Matrix9 with_positive_eigenvalues(const Matrix9& H);

}  // namespace pliant::linalg

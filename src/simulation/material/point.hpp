// Shared by the laws: derivatives of J, and the functions of each law, one overload per law. Internal to this module;
// everyone else includes response.hpp. Notation as in law.hpp.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "simulation/material/response.hpp"

namespace pliant::material {

using Vector9 = Eigen::Matrix<double, 9, 1>;

inline Vector9 vec(const Matrix3& A) {
    return Eigen::Map<const Vector9>(A.data());
}

/// d J / d F. Deliberately not inline: inlining makes the neo-Hookean tangent 8 % slower.
[[nodiscard]] Matrix3 cofactor(const Matrix3& F);

/// Adds s * d^2 J / dF^2: the derivative of column j of the cofactor is a cross product with the columns of dF.
inline void add_cofactor_gradient(Matrix9& H, const Matrix3& F, double s) {
    const auto add_skew = [&](int row_block, int column_block, const linalg::Vector3& v, double sign) {
        // Block (row, column) of d(cofactor) += sign * [v]x.
        const double f = s * sign;
        const int r = 3 * row_block;
        const int c = 3 * column_block;
        H(r + 0, c + 1) -= f * v[2];
        H(r + 0, c + 2) += f * v[1];
        H(r + 1, c + 0) += f * v[2];
        H(r + 1, c + 2) -= f * v[0];
        H(r + 2, c + 0) -= f * v[1];
        H(r + 2, c + 1) += f * v[0];
    };
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        add_skew(i, k, F.col(j), 1);  // C_i = F_j x F_k
        add_skew(i, j, F.col(k), -1);
    }
}

std::optional<double> psi(const MooneyRivlin& law, const Matrix3& F);
Matrix3 first_piola(const MooneyRivlin& law, const Matrix3& F);
Matrix9 first_piola_gradient(const MooneyRivlin& law, const Matrix3& F);

std::optional<double> psi(const Yeoh& law, const Matrix3& F);
Matrix3 first_piola(const Yeoh& law, const Matrix3& F);
Matrix9 first_piola_gradient(const Yeoh& law, const Matrix3& F);

std::optional<double> psi(const Ogden& law, const Matrix3& F);
Matrix3 first_piola(const Ogden& law, const Matrix3& F);
Matrix9 first_piola_gradient(const Ogden& law, const Matrix3& F);

std::optional<double> psi(const Corotated& law, const Matrix3& F);
Matrix3 first_piola(const Corotated& law, const Matrix3& F);
Matrix9 first_piola_gradient(const Corotated& law, const Matrix3& F);

std::optional<double> psi(const Linear& law, const Matrix3& F);
Matrix3 first_piola(const Linear& law, const Matrix3& F);
Matrix9 first_piola_gradient(const Linear& law, const Matrix3& F);

/// dP/dc for each constant of a law, in the order of parameters() (law_parameters.hpp).
using Slopes = std::vector<Matrix3>;
[[nodiscard]] Slopes stress_slopes(const NeoHookean& law, const Matrix3& F);
[[nodiscard]] Slopes stress_slopes(const ShapeBlend& law, const Matrix3& F);
[[nodiscard]] Slopes stress_slopes(const StVenantKirchhoff& law, const Matrix3& F);
[[nodiscard]] Slopes stress_slopes(const MooneyRivlin& law, const Matrix3& F);
[[nodiscard]] Slopes stress_slopes(const Yeoh& law, const Matrix3& F);
[[nodiscard]] Slopes stress_slopes(const Ogden& law, const Matrix3& F);
[[nodiscard]] Slopes stress_slopes(const Corotated& law, const Matrix3& F);
[[nodiscard]] Slopes stress_slopes(const Linear& law, const Matrix3& F);

}  // namespace pliant::material

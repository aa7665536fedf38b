#include "simulation/material/response.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "simulation/material/point.hpp"

namespace pliant::material {
namespace {

std::optional<double> psi(const NeoHookean& law, const Matrix3& F) {
    const double J = F.determinant();
    return 0.5 * law.shear_Pa * (std::pow(J, -2.0 / 3) * F.squaredNorm() - 3) + 0.5 * law.bulk_Pa * (J - 1) * (J - 1);
}

Matrix3 first_piola(const NeoHookean& law, const Matrix3& F) {
    const double J = F.determinant();
    const double s = law.shear_Pa * std::pow(J, -2.0 / 3);
    return s * F + (law.bulk_Pa * (J - 1) - s * F.squaredNorm() / (3 * J)) * cofactor(F);
}

Matrix9 first_piola_gradient(const NeoHookean& law, const Matrix3& F) {
    const double J = F.determinant();
    const double I1 = F.squaredNorm();
    const double s = law.shear_Pa * std::pow(J, -2.0 / 3);
    const Vector9 f = vec(F);
    const Vector9 c = vec(cofactor(F));
    const double cross_term = -2 * s / (3 * J);
    Matrix9 H = (law.bulk_Pa + 5 * s * I1 / (9 * J * J)) * (c * c.transpose());
    H += cross_term * (f * c.transpose() + c * f.transpose());
    H.diagonal().array() += s;
    add_cofactor_gradient(H, F, law.bulk_Pa * (J - 1) - s * I1 / (3 * J));
    return H;
}

std::optional<double> psi(const ShapeBlend& law, const Matrix3& F) {
    if (law.a != 1) return std::nullopt;
    return 0.5 * law.weight_Pa * (F - linalg::nearest_rotation(F)).squaredNorm();
}

Matrix3 first_piola(const ShapeBlend& law, const Matrix3& F) {
    const Matrix3 target = law.a * linalg::nearest_rotation(F) + (1 - law.a) * std::cbrt(1 / F.determinant()) * F;
    return law.weight_Pa * (F - target);
}

Matrix9 first_piola_gradient(const ShapeBlend& law, const Matrix3& F) {
    const double J = F.determinant();
    const double soft = (1 - law.a) * std::cbrt(1 / J);
    Matrix9 H = -law.a * linalg::nearest_rotation_gradient(linalg::signed_svd(F));
    H += soft / (3 * J) * (vec(F) * vec(cofactor(F)).transpose());
    H.diagonal().array() += 1 - soft;
    return law.weight_Pa * H;
}

Matrix3 green_strain(const Matrix3& F) {
    return 0.5 * (F.transpose() * F - Matrix3::Identity());
}

/// Second Piola-Kirchhoff stress for a (rate of) Green strain: linear in it.
Matrix3 second_piola(const StVenantKirchhoff& law, const Matrix3& E) {
    return 2 * law.shear_Pa * E + law.lame_Pa * E.trace() * Matrix3::Identity();
}

std::optional<double> psi(const StVenantKirchhoff& law, const Matrix3& F) {
    const Matrix3 E = green_strain(F);
    return law.shear_Pa * E.squaredNorm() + 0.5 * law.lame_Pa * E.trace() * E.trace();
}

Matrix3 first_piola(const StVenantKirchhoff& law, const Matrix3& F) {
    return F * second_piola(law, green_strain(F));
}

Matrix9 first_piola_gradient(const StVenantKirchhoff& law, const Matrix3& F) {
    const Matrix3 S = second_piola(law, green_strain(F));
    Matrix9 H;
    for (int k = 0; k < 9; ++k) {
        Matrix3 dF = Matrix3::Zero();
        dF(k % 3, k / 3) = 1;
        const Matrix3 dE = 0.5 * (F.transpose() * dF + dF.transpose() * F);
        H.col(k) = vec(dF * S + F * second_piola(law, dE));
    }
    return H;
}

}  // namespace

// The most common law is checked first: a visit over all laws at every point costs 10 % more.
std::optional<double> energy(const Law& law, const Matrix3& F) {
    if (const auto* common = std::get_if<NeoHookean>(&law)) return psi(*common, F);
    return std::visit([&](const auto& l) { return psi(l, F); }, law);
}

Matrix3 stress(const Law& law, const Matrix3& F) {
    if (const auto* common = std::get_if<NeoHookean>(&law)) return first_piola(*common, F);
    return std::visit([&](const auto& l) { return first_piola(l, F); }, law);
}

Matrix9 tangent(const Law& law, const Matrix3& F) {
    if (const auto* common = std::get_if<NeoHookean>(&law)) return first_piola_gradient(*common, F);
    return std::visit([&](const auto& l) { return first_piola_gradient(l, F); }, law);
}

Slopes stress_slopes(const NeoHookean& /*law*/, const Matrix3& F) {
    const double J = F.determinant();
    const Matrix3 C = cofactor(F);
    return {std::pow(J, -2.0 / 3) * (F - F.squaredNorm() / (3 * J) * C), (J - 1) * C};
}

Slopes stress_slopes(const ShapeBlend& law, const Matrix3& F) {
    const Matrix3 rigid = linalg::nearest_rotation(F);
    const Matrix3 soft = std::cbrt(1 / F.determinant()) * F;
    return {F - law.a * rigid - (1 - law.a) * soft, law.weight_Pa * (soft - rigid)};
}

Slopes stress_slopes(const StVenantKirchhoff& /*law*/, const Matrix3& F) {
    const Matrix3 E = green_strain(F);
    return {2 * F * E, E.trace() * F};
}

}  // namespace pliant::material

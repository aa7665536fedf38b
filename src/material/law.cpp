#include "material/law.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "material/point.hpp"

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

Moduli moduli(double youngs_modulus_Pa, double poisson_ratio) {
    return {youngs_modulus_Pa / (2 * (1 + poisson_ratio)), youngs_modulus_Pa / (3 * (1 - 2 * poisson_ratio))};
}

double bulk_modulus(double shear_Pa, double poisson_ratio) {
    return 2 * shear_Pa * (1 + poisson_ratio) / (3 * (1 - 2 * poisson_ratio));
}

double youngs_modulus(const Moduli& moduli) {
    return 9 * moduli.bulk_Pa * moduli.shear_Pa / (3 * moduli.bulk_Pa + moduli.shear_Pa);
}

double poisson_ratio(const Moduli& moduli) {
    return (3 * moduli.bulk_Pa - 2 * moduli.shear_Pa) / (6 * moduli.bulk_Pa + 2 * moduli.shear_Pa);
}

NeoHookean neo_hookean(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {m.shear_Pa, m.bulk_Pa};
}

StVenantKirchhoff st_venant_kirchhoff(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {m.shear_Pa, m.bulk_Pa - 2 * m.shear_Pa / 3};
}

Corotated corotated(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {m.shear_Pa, m.bulk_Pa - 2 * m.shear_Pa / 3};
}

Linear linear(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {m.shear_Pa, m.bulk_Pa - 2 * m.shear_Pa / 3};
}

ShapeBlend shape_blend(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {3 * m.bulk_Pa, (1 - 2 * poisson_ratio) / (1 + poisson_ratio)};
}

double shape_parameter_of_thesis(double material_ratio) {
    return (0.114 * material_ratio + 1.665) * material_ratio - 0.766;
}

double shape_parameter_small_strain(double material_ratio) {
    return (3 * material_ratio - 1) / 2;
}

// The law of nearly every robot, asked at every point, is looked for first: a visit over all laws costs 10 % more
// there.
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

std::optional<InvariantForm> invariant_form(const Law& law) {
    if (const auto* l = std::get_if<NeoHookean>(&law)) return InvariantForm{0.5 * l->shear_Pa, 0, 0, 0, l->bulk_Pa};
    if (const auto* l = std::get_if<MooneyRivlin>(&law)) return InvariantForm{l->c10_Pa, 0, 0, l->c01_Pa, l->bulk_Pa};
    if (const auto* l = std::get_if<Yeoh>(&law)) return InvariantForm{l->c10_Pa, l->c20_Pa, l->c30_Pa, 0, l->bulk_Pa};
    return std::nullopt;
}

bool has_energy(const Law& law) {
    const auto* blend = std::get_if<ShapeBlend>(&law);
    return blend == nullptr || blend->a == 1;
}

bool is_objective(const Law& law) {
    return !std::holds_alternative<Linear>(law);
}

Moduli moduli(const Law& law) {
    struct Of {
        Moduli operator()(const NeoHookean& l) const { return {l.shear_Pa, l.bulk_Pa}; }
        Moduli operator()(const ShapeBlend& l) const { return {l.weight_Pa * l.a / 2, l.weight_Pa / 3}; }
        Moduli operator()(const StVenantKirchhoff& l) const { return {l.shear_Pa, l.lame_Pa + 2 * l.shear_Pa / 3}; }
        Moduli operator()(const MooneyRivlin& l) const { return {2 * (l.c10_Pa + l.c01_Pa), l.bulk_Pa}; }
        Moduli operator()(const Yeoh& l) const { return {2 * l.c10_Pa, l.bulk_Pa}; }
        Moduli operator()(const Ogden& l) const {
            double shear = 0;
            for (int k = 0; k < l.terms; ++k) shear += l.mu_Pa[k];
            return {shear, l.bulk_Pa};
        }
        Moduli operator()(const Corotated& l) const { return {l.shear_Pa, l.lame_Pa + 2 * l.shear_Pa / 3}; }
        Moduli operator()(const Linear& l) const { return {l.shear_Pa, l.lame_Pa + 2 * l.shear_Pa / 3}; }
    };
    return std::visit(Of{}, law);
}

double stiffness_bound(const Law& law) {
    const Moduli m = moduli(law);
    return std::max(3 * m.bulk_Pa, 2 * m.shear_Pa);
}

std::string_view name(const Law& law) {
    struct Name {
        std::string_view operator()(const NeoHookean&) const { return "neo-hookean"; }
        std::string_view operator()(const ShapeBlend&) const { return "shape-blend"; }
        std::string_view operator()(const StVenantKirchhoff&) const { return "st-venant-kirchhoff"; }
        std::string_view operator()(const MooneyRivlin&) const { return "mooney-rivlin"; }
        std::string_view operator()(const Yeoh&) const { return "yeoh"; }
        std::string_view operator()(const Ogden&) const { return "ogden"; }
        std::string_view operator()(const Corotated&) const { return "corotated"; }
        std::string_view operator()(const Linear&) const { return "linear"; }
    };
    return std::visit(Name{}, law);
}

}  // namespace pliant::material

// Elastic laws: energy, stress and tangent of one material point.
//
// Notation: F deformation gradient, J = det F, psi energy per rest volume (J/m^3), P = d psi / dF first
// Piola-Kirchhoff stress (Pa), K bulk modulus, mu shear modulus (Pa). vec() stacks columns.
//
// To add a law: a struct of its constants, its three functions, a line in Law, and a line in law_test.cpp.
#pragma once

#include <optional>
#include <string_view>
#include <variant>

#include "linalg/small.hpp"

namespace pliant::material {

using linalg::Matrix3;
using linalg::Matrix9;

/// Shear and bulk modulus of an isotropic solid. Preconditions: E > 0, -1 < nu < 0.5.
struct Moduli {
    double shear_Pa;  ///< mu = E / (2 (1 + nu))
    double bulk_Pa;   ///< K = E / (3 (1 - 2 nu))
};
[[nodiscard]] Moduli moduli(double youngs_modulus_Pa, double poisson_ratio);

/// psi = mu/2 (J^(-2/3) tr F^T F - 3) + K/2 (J - 1)^2: what Abaqus and CalculiX call NEO HOOKE (mu = 2 C10, K = 2/D1).
struct NeoHookean {
    double shear_Pa;
    double bulk_Pa;
};

/// The thesis' target shape (T3.4): P = w (F - T(F)), T = a R + (1 - a) J^(-1/3) F with the rotation R nearest to F.
/// a = 1 / R_omega; a = 1 is a rigid target. Not the gradient of an energy unless a = 1.
/// Small strains: mu = w a / 2, lambda = w (1 - a) / 3.
struct ShapeBlend {
    double weight_Pa;
    double a;
};

/// psi = mu E:E + lambda/2 (tr E)^2 with the Green strain E = (F^T F - I) / 2: Hooke's law for large rotations and
/// small strains; it has no resistance to being crushed. CalculiX' *ELASTIC with NLGEOM.
struct StVenantKirchhoff {
    double shear_Pa;
    double lame_Pa;  ///< lambda = K - 2 mu / 3
};

using Law = std::variant<NeoHookean, ShapeBlend, StVenantKirchhoff>;

[[nodiscard]] NeoHookean neo_hookean(double youngs_modulus_Pa, double poisson_ratio);
[[nodiscard]] StVenantKirchhoff st_venant_kirchhoff(double youngs_modulus_Pa, double poisson_ratio);
/// The blend with the same small-strain moduli: w = 3K, a = (1 - 2 nu) / (1 + nu).
[[nodiscard]] ShapeBlend shape_blend(double youngs_modulus_Pa, double poisson_ratio);

/// The thesis' fit for 30 % strain of one specimen (T3.8), of the material ratio R_m = E_A / E_B.
[[nodiscard]] double shape_parameter_of_thesis(double material_ratio);
/// The same for small strains of any specimen: R_omega = (3 R_m - 1) / 2.
[[nodiscard]] double shape_parameter_small_strain(double material_ratio);

/// psi, or nothing where the law has no energy. Precondition: det F > 0.
[[nodiscard]] std::optional<double> energy(const Law& law, const Matrix3& F);
/// P. Precondition: det F > 0.
[[nodiscard]] Matrix3 stress(const Law& law, const Matrix3& F);
/// d vec(P) / d vec(F); symmetric where the law has an energy. Precondition: det F > 0.
[[nodiscard]] Matrix9 tangent(const Law& law, const Matrix3& F);

[[nodiscard]] bool has_energy(const Law& law);
/// Largest eigenvalue of the tangent at rest (3K for the isotropic laws): the weight of the local-global iteration.
[[nodiscard]] double stiffness_bound(const Law& law);
[[nodiscard]] std::string_view name(const Law& law);

}  // namespace pliant::material

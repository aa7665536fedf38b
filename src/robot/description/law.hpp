// Elastic laws as values: their constants, moduli and names. Their response at a point is in
// simulation/material/response.hpp.
//
// Notation: F deformation gradient, J = det F, psi energy per rest volume (J/m^3), P = d psi / dF first Piola-Kirchhoff
// stress (Pa), K bulk modulus, mu shear modulus (Pa).
//
// To add a law: a struct of its constants, its moduli and name in law.cpp, a line in Law, its four functions (declared
// in simulation/material/point.hpp), its constants in law_parameters.cpp there, and a line in law_test.cpp.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <variant>

namespace pliant::material {

/// Shear and bulk modulus of an isotropic solid. Preconditions: E > 0, -1 < nu < 0.5.
struct Moduli {
    double shear_Pa;  ///< mu = E / (2 (1 + nu))
    double bulk_Pa;   ///< K = E / (3 (1 - 2 nu))
};
[[nodiscard]] Moduli moduli(double youngs_modulus_Pa, double poisson_ratio);
/// K of a solid with the given shear modulus and Poisson ratio: 2 mu (1 + nu) / (3 (1 - 2 nu)).
[[nodiscard]] double bulk_modulus(double shear_Pa, double poisson_ratio);
[[nodiscard]] double youngs_modulus(const Moduli& moduli);  ///< 9 K mu / (3 K + mu)
[[nodiscard]] double poisson_ratio(const Moduli& moduli);   ///< (3 K - 2 mu) / (6 K + 2 mu)

/// psi = mu/2 (J^(-2/3) tr F^T F - 3) + K/2 (J - 1)^2: NEO HOOKE of Abaqus and CalculiX (mu = 2 C10, K = 2/D1).
struct NeoHookean {
    double shear_Pa;
    double bulk_Pa;
};

/// The thesis' target shape (F3.4): P = w (F - T(F)), T = a R + (1 - a) J^(-1/3) F with the rotation R nearest to F.
/// a = 1 / R_omega; a = 1 is a rigid target. Not the gradient of an energy unless a = 1.
/// Small strains: mu = w a / 2, lambda = w (1 - a) / 3.
struct ShapeBlend {
    double weight_Pa;
    double a;
};

/// psi = mu E:E + lambda/2 (tr E)^2 with the Green strain E = (F^T F - I) / 2: Hooke's law for large rotations and
/// small strains; its resistance vanishes under extreme compression. CalculiX' *ELASTIC with NLGEOM.
struct StVenantKirchhoff {
    double shear_Pa;
    double lame_Pa;  ///< lambda = K - 2 mu / 3
};

/// psi = C10 (I1_bar - 3) + C01 (I2_bar - 3) + K/2 (J - 1)^2 with I1_bar = J^(-2/3) tr C, I2_bar = J^(-4/3) (tr^2 C -
/// tr C^2) / 2, C = F^T F: MOONEY-RIVLIN of Abaqus and CalculiX, K = 2/D1. Small strains: mu = 2 (C10 + C01).
/// Mooney, J. Appl. Phys. 11 (1940) 582; Rivlin, Phil. Trans. R. Soc. A 241 (1948) 379.
struct MooneyRivlin {
    double c10_Pa;
    double c01_Pa;
    double bulk_Pa;
};

/// psi = sum_i Ci0 (I1_bar - 3)^i + K/2 (J - 1)^2, i = 1 .. 3: YEOH of Abaqus and CalculiX, K = 2/D1, no D2, D3.
/// Small strains: mu = 2 C10. Yeoh, Rubber Chem. Technol. 66 (1993) 754.
struct Yeoh {
    double c10_Pa;
    double c20_Pa;
    double c30_Pa;
    double bulk_Pa;
};

/// psi = sum_k 2 mu_k / alpha_k^2 (sum_i l_bar_i^alpha_k - 3) + K/2 (J - 1)^2 with the principal stretches l_i of F and
/// l_bar_i = J^(-1/3) l_i: OGDEN of Abaqus and CalculiX, K = 2/D1. Small strains: mu = sum of mu_k. In Ogden's own
/// paper (Proc. R. Soc. A 326 (1972) 565) mu_k / alpha_k stands before the bracket: his mu_k are ours times 2 /
/// alpha_k. Preconditions: 1 <= terms <= 6, alpha_k not zero.
struct Ogden {
    static constexpr int most_terms = 6;
    int terms;
    std::array<double, most_terms> mu_Pa;  ///< the first `terms` are used
    std::array<double, most_terms> alpha;
    double bulk_Pa;
};

/// psi = mu |F - R|^2 + lambda/2 (J - 1)^2 with the rotation R nearest to F: Hooke's law in the frame that rotates with
/// the material. The volume term uses J, not tr(R^T F - I): both are Hooke's law for small strains, but only J
/// preserves the true volume of a nearly incompressible body at large ones (Stomakhin et al., SCA 2012, "fixed
/// corotated").
struct Corotated {
    double shear_Pa;
    double lame_Pa;  ///< lambda = K - 2 mu / 3
};

/// psi = mu eps:eps + lambda/2 (tr eps)^2 with eps = (F + F^T) / 2 - I: Hooke's law of small displacements, the model
/// without rotation (Fig. 3.2 b). It mistakes a rotation for a strain: a body rotated by an angle t appears to grow by
/// 1 / cos t, so rotations of more than a few degrees are wrong. For demonstration, and for small displacements.
struct Linear {
    double shear_Pa;
    double lame_Pa;  ///< lambda = K - 2 mu / 3
};

using Law = std::variant<NeoHookean, ShapeBlend, StVenantKirchhoff, MooneyRivlin, Yeoh, Ogden, Corotated, Linear>;

[[nodiscard]] NeoHookean neo_hookean(double youngs_modulus_Pa, double poisson_ratio);
[[nodiscard]] StVenantKirchhoff st_venant_kirchhoff(double youngs_modulus_Pa, double poisson_ratio);
[[nodiscard]] Corotated corotated(double youngs_modulus_Pa, double poisson_ratio);
[[nodiscard]] Linear linear(double youngs_modulus_Pa, double poisson_ratio);
/// The shape-blend law with the same small-strain moduli: w = 3K, a = (1 - 2 nu) / (1 + nu).
[[nodiscard]] ShapeBlend shape_blend(double youngs_modulus_Pa, double poisson_ratio);

/// The thesis' fit for one specimen at 30 % strain (T3.8), as a function of the material ratio R_m = E_A / E_B.
[[nodiscard]] double shape_parameter_of_thesis(double material_ratio);
/// The same for small strains of any specimen: R_omega = (3 R_m - 1) / 2.
[[nodiscard]] double shape_parameter_small_strain(double material_ratio);

/// The common form of neo-Hookean, Mooney-Rivlin and Yeoh:
/// psi = sum_i ci0 (I1_bar - 3)^i + c01 (I2_bar - 3) + K/2 (J - 1)^2. Empty for other laws.
struct InvariantForm {
    double c10_Pa = 0, c20_Pa = 0, c30_Pa = 0;
    double c01_Pa = 0;
    double bulk_Pa = 0;
};
[[nodiscard]] std::optional<InvariantForm> invariant_form(const Law& law);

[[nodiscard]] bool has_energy(const Law& law);
/// True if the energy is invariant under rotations of the body: for all laws but Linear.
[[nodiscard]] bool is_objective(const Law& law);
/// For small strains from rest.
[[nodiscard]] Moduli moduli(const Law& law);
/// Largest eigenvalue of the tangent at rest (3K for the isotropic laws): the weight of the local-global iteration.
[[nodiscard]] double stiffness_bound(const Law& law);
[[nodiscard]] std::string_view name(const Law& law);

}  // namespace pliant::material

// Independent implementation of the elastic laws as formulas in the principal stretches, as a reference for tests of
// the solver. Uses neither material::stress nor material::energy.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "base/core/vec3.hpp"
#include "robot/description/law.hpp"

namespace pliant::sim::reference {

struct PrincipalForm {
    material::Law law;
    std::function<Vec3(Vec3)> stress;            ///< principal P (Pa) at principal stretches, P_i = d psi / d l_i
    std::function<double(double)> shear_stress;  ///< P12 (Pa) of F = I + g e1 e2^T, at g
};

/// For a law that has an energy; meaningless for others.
[[nodiscard]] PrincipalForm principal_form(const material::Law& law);

/// One of every law that bodies are made of, E about 1 MPa and nu 0.3 to 0.45.
[[nodiscard]] std::vector<PrincipalForm> principal_forms();

/// The stretch l of the free sides, for which the last principal stress vanishes at stretches_of(l).
[[nodiscard]] double free_stretch(const PrincipalForm& form,
                                  const std::function<std::array<double, 3>(double)>& stretches_of);

/// d/dl psi(l1(l), l2(l), l3(l)) by the chain rule with the principal stresses: the integrand of inflation formulas.
[[nodiscard]] double slope(const PrincipalForm& form, std::array<double, 3> stretches, std::array<double, 3> rates);

}  // namespace pliant::sim::reference

// Response of a law at one material point: energy, stress and tangent. vec() stacks columns; notation as in law.hpp.
#pragma once

#include <optional>

#include "base/linalg/small.hpp"
#include "robot/description/law.hpp"

namespace pliant::material {

using linalg::Matrix3;
using linalg::Matrix9;

/// psi, or empty if the law has no energy. Precondition: det F > 0.
[[nodiscard]] std::optional<double> energy(const Law& law, const Matrix3& F);
/// P. Precondition: det F > 0.
[[nodiscard]] Matrix3 stress(const Law& law, const Matrix3& F);
/// d vec(P) / d vec(F); symmetric where the law has an energy. Precondition: det F > 0.
[[nodiscard]] Matrix9 tangent(const Law& law, const Matrix3& F);

}  // namespace pliant::material

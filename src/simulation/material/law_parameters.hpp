// The parameters of a law: their names, and the derivatives of the stress.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "simulation/material/response.hpp"

namespace pliant::material {

/// One of the constants of a law or, for laws determined by two moduli, Young's modulus or Poisson's ratio, which
/// change both constants.
struct LawParameter {
    std::string name;  ///< as in robot files: "c10", "alpha_2", "youngs_modulus"
    std::string unit;  ///< "Pa", or "" if dimensionless
    double value = 0;
    std::vector<double> direction;  ///< (constants) derivative of each constant
};

/// All constants, in the order of stress_by_constants(); then Young's modulus and Poisson's ratio, if they determine
/// the law.
[[nodiscard]] std::vector<LawParameter> parameters(const Law& law);

/// The law with another value of parameter k.
[[nodiscard]] Law with_parameter(const Law& law, std::size_t k, double value);

/// (constants) dP/dc. Precondition: det F > 0.
[[nodiscard]] std::vector<Matrix3> stress_by_constants(const Law& law, const Matrix3& F);

/// Derivative of the moduli with the constants along `direction`.
[[nodiscard]] Moduli moduli_rate(const Law& law, const std::vector<double>& direction);

}  // namespace pliant::material

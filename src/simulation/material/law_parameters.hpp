// The numbers of a law: what they are called, and how the stress changes with them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "simulation/material/response.hpp"

namespace pliant::material {

/// One of the constants of a law or, of laws that two moduli determine, Young's modulus or Poisson's ratio: these move
/// both constants.
struct LawParameter {
    std::string name;  ///< as in robot files: "c10", "alpha_2", "youngs_modulus"
    std::string unit;  ///< "Pa", or "" of a plain number
    double value = 0;
    std::vector<double> direction;  ///< (constants) how each constant changes with it
};

/// All constants, in the order of stress_by_constants(); then Young's modulus and Poisson's ratio, where the law has no
/// other numbers.
[[nodiscard]] std::vector<LawParameter> parameters(const Law& law);

/// The law with another value of parameter k.
[[nodiscard]] Law with_parameter(const Law& law, std::size_t k, double value);

/// (constants) dP/dc. Precondition: det F > 0.
[[nodiscard]] std::vector<Matrix3> stress_by_constants(const Law& law, const Matrix3& F);

/// How the moduli change as the constants change along `direction`.
[[nodiscard]] Moduli moduli_rate(const Law& law, const std::vector<double>& direction);

}  // namespace pliant::material

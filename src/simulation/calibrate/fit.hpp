// Constants of an elastic law from a tensile test, by least squares on the nominal stress of an incompressible body.
//
// With stretches l, l^(-1/2), l^(-1/2) the nominal stress is P = (dW/dl1) - l^(-3/2) (dW/dl2). It is linear in the
// constants of neo-Hookean, Mooney-Rivlin and Yeoh (solved by QR) and in Ogden's mu but not in alpha
// (Levenberg-Marquardt). Intervals are those of the linear theory at the solution: value +- t s sqrt(C_ii), C = (J^T
// J)^-1, s^2 = sum of squares / (rows - constants), t Student's 97.5 % point (Seber and Wild, Nonlinear Regression,
// 1989, section 2.1.2). They reflect noise in the data only, not a law that does not fit.
#pragma once

#include <string>
#include <vector>

#include "robot/description/law.hpp"
#include "simulation/calibrate/tensile_csv.hpp"

namespace pliant::calibrate {

enum class FitLaw { neo_hookean, mooney_rivlin, yeoh, ogden };

struct FitOptions {
    FitLaw law = FitLaw::neo_hookean;
    int terms = 1;                ///< of Ogden's law, 1 to 3
    double poisson_ratio = 0.49;  ///< of the law that is returned; the fit itself is incompressible
};

struct Constant {
    std::string name;   ///< as in the robot file: "c10", "mu", "alpha"; of neo-hookean: "youngs_modulus"
    double value;       ///< Pa; alpha: 1
    double half_width;  ///< of the 95 % confidence interval; infinite if the data do not determine the constant
    bool is_pressure = true;
};

struct Fit {
    material::Law law;
    double poisson_ratio = 0;  ///< of the law as it was asked for: its moduli give it only up to rounding
    std::vector<Constant> constants;
    double rms_error_Pa = 0;
    double r_squared = 0;
    std::vector<double> stress_Pa;      ///< of the fit, for each row of the test
    std::vector<std::string> warnings;  ///< for people: where the law is unstable, which constants are meaningless
};

/// Errors: too few rows, or no stretch other than 1.
[[nodiscard]] Result<Fit> fit(const TensileTest& test, const FitOptions& options);

/// Nominal stress of an incompressible bar of the law, stretched by l > 0.
[[nodiscard]] double uniaxial_stress_Pa(const material::Law& law, double l);

/// Student's t: 95 % of its values lie within +- this. Precondition: freedom >= 1. To 0.2 %.
[[nodiscard]] double student_t_95(int freedom);

/// Checks Drucker's criterion for stretches in [low, high]: increments of true stress and logarithmic strain of an
/// incompressible body must have a positive product, in uniaxial tension and compression, equibiaxial tension and
/// planar shear. One line for each mode of loading that fails; empty if the law is stable.
[[nodiscard]] std::vector<std::string> unstable_ranges(const material::Law& law, double low, double high);

/// The [material.NAME] table of a robot file.
[[nodiscard]] std::string material_toml(const Fit& fit, const std::string& name);
[[nodiscard]] std::string fit_text(const Fit& fit);
[[nodiscard]] std::string fit_json(const Fit& fit, const TensileTest& test);

}  // namespace pliant::calibrate

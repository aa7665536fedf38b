// The ratio of two Young's moduli from an elongation test (T3.7): a bar of two materials in series is held at one end
// and pulled at the other, and the displacement of their joint is measured.
//
// T3.7 takes both parts for linear springs of equal cross-sections, so its error is of the order of the strain. For two
// incompressible neo-Hookean bars in series there is a closed form too: equal nominal stress, E_A g(l_A) = E_B g(l_B)
// with g(l) = l - 1 / l^2 and the stretches l_A = 1 + dL1 / L1, l_B = 1 + (dL - dL1) / (L - L1).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"

namespace pliant::calibrate {

/// One test. The held part is A, the pulled one B.
struct ElongationTest {
    double length_m = 0;      ///< L, of the bar at rest
    double interface_m = 0;   ///< L1, from the held end to the joint, at rest
    double elongation_m = 0;  ///< dL, of the bar; above zero
    double joint_m = 0;       ///< dL1, displacement of the joint
};

struct ElongationRow {
    ElongationTest test;
    double linear = 0;                      ///< R_m = E_A / E_B by T3.7
    double neo_hookean = 0;                 ///< R_m of the closed form above
    std::optional<double> shape_parameter;  ///< R_omega of the softer part, if it was searched for

    [[nodiscard]] double strain() const { return test.elongation_m / test.length_m; }
    /// Relative error of T3.7; positive: too large.
    [[nodiscard]] double error() const { return linear / neo_hookean - 1; }
};

/// Errors: lengths that no bar can have, a joint that moves backwards or farther than the end.
[[nodiscard]] Result<ElongationRow> evaluate(const ElongationTest& test);

/// R_omega with which the softer part of a bar of target shapes moves the joint as measured (section 3.4.2, with the
/// test in place of Abaqus). Uses the bar of ratio.hpp, clamped at its ends: 100 x 10 x 10 mm scaled to the test's
/// length.
[[nodiscard]] Result<double> match_shape_parameter(const ElongationTest& test, Progress& progress,
                                                   std::array<int, 3> cells = {48, 5, 5});

/// Columns "length", "interface", "elongation" and "joint", each with its unit of length: "length (mm)". Error: file,
/// line and what is wrong.
[[nodiscard]] Result<std::vector<ElongationRow>> parse_elongation_csv(std::string_view text, const std::string& file);

[[nodiscard]] std::string elongation_text(const std::vector<ElongationRow>& rows);
[[nodiscard]] std::string elongation_csv(const std::vector<ElongationRow>& rows);
[[nodiscard]] std::string elongation_json(const std::vector<ElongationRow>& rows);

}  // namespace pliant::calibrate

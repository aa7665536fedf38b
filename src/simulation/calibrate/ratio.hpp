// The thesis' calibration (section 3.4.2): the shape parameter R_omega with which a bar of two target-shape materials,
// stretched at its ends, moves its interface as far as a bar of two neo-Hookean materials.
//
// Bar of 100 x 10 x 10 mm, the left part stiff (a = 1), the right soft (a = 1 / R_omega), with the same weight in both,
// so that only R_omega distinguishes them. The left end is held, the right one moved by strain times the length, both
// clamped.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"

namespace pliant::calibrate {

struct RatioOptions {
    std::vector<double> ratios;  ///< R_m = E_stiff / E_soft, each 1 or more
    double strain = 0.3;
    double poisson_ratio = 0.45;  ///< of the reference
    double interface = 0.5;       ///< where the stiff part ends, as a share of the length: 0.02 to 0.98
    /// Of the bar, six linear tets each, at most a million tets; the reference has quadratic ones.
    std::array<int, 3> cells = {48, 5, 5};
};

struct RatioRow {
    double material_ratio;
    double interface_mm;     ///< displacement of the interface in the reference
    double shape_parameter;  ///< R_omega that gives the same
    double thesis;           ///< T3.8
    double small_strain;     ///< (3 R_m - 1) / 2
};

struct RatioResult {
    std::vector<RatioRow> rows;
    /// R_omega = c[0] R_m^2 + c[1] R_m + c[2], by least squares; where there are three ratios or more.
    std::optional<std::array<double, 3>> curve;
};

/// Checks strain, Poisson ratio, cells and interface, but not the ratios.
[[nodiscard]] Status check_bar(const RatioOptions& options);

[[nodiscard]] Result<RatioResult> calibrate_ratio(const RatioOptions& options, Progress& progress);

/// Mean displacement of the interface of the neo-Hookean bar on quadratic tets, mm.
[[nodiscard]] Result<double> reference_displacement_mm(const RatioOptions& options, double material_ratio,
                                                       Progress& progress);
/// The same for the target-shape bar on linear tets, mm.
[[nodiscard]] Result<double> blend_displacement_mm(const RatioOptions& options, double shape_parameter,
                                                   Progress& progress);
/// R_omega for which the target-shape bar has that interface displacement. Errors: there is none between 1 and 1000.
[[nodiscard]] Result<double> match_shape_parameter(const RatioOptions& options, double interface_mm, double guess,
                                                   Progress& progress);

[[nodiscard]] std::string ratio_text(const RatioResult& result);
[[nodiscard]] std::string ratio_csv(const RatioResult& result);
[[nodiscard]] std::string ratio_json(const RatioResult& result, const RatioOptions& options);

}  // namespace pliant::calibrate

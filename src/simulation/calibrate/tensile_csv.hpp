// A tensile (or compression) test as a table of text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::calibrate {

/// Uniaxial test of one material: rows of equal length.
struct TensileTest {
    std::vector<double> stretch;    ///< length over rest length, above zero
    std::vector<double> stress_Pa;  ///< nominal: force over the cross-section at rest
};

/// Columns are separated by commas, semicolons or tabs, numbers have a decimal point; lines that begin with # are
/// comments. The first line names the columns: one is "stretch" or "strain" (dimensionless, or with unit %), one is
/// "stress" with its unit, such as "stress (MPa)" or "nominal stress [kPa]"; other columns, and those of true strain or
/// stress, are ignored. Errors name file and line. Text over 64 MB is refused.
[[nodiscard]] Result<TensileTest> parse_tensile_csv(std::string_view text, const std::string& file);

}  // namespace pliant::calibrate

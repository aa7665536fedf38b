// Factors from SI to the units of tables and files.
#pragma once

namespace pliant::report {

inline constexpr double mm_per_m = 1e3;

}  // namespace pliant::report

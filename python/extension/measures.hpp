// Measures as Python tuples: (kind, name, direction).
#pragma once

#include <string>
#include <tuple>

#include "pliant/linearisation.hpp"

namespace pliant::python {

using MeasureTuple = std::tuple<std::string, std::string, Point>;

/// Throws if there is no such kind.
[[nodiscard]] Measure measure_of(const MeasureTuple& tuple);

}  // namespace pliant::python

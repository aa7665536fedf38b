// Deviations of a model part from the core specification that affect no body: reported and ignored.
#pragma once

#include <string>
#include <vector>

#include "geometry/threemf/xml_part.hpp"

namespace pliant::threemf {

/// One line each, with its place: unknown elements and attributes of the core namespace (each kind once), attributes of
/// the namespaces xml and xsi, metadata with an unknown name, an undeclared namespace or given twice. At most 50.
[[nodiscard]] std::vector<std::string> remarks_on(const XmlPart& part);

}  // namespace pliant::threemf

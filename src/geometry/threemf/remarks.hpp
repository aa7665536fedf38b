// What a model part has that the core specification does not allow, but that harms no body: it is said and passed over.
#pragma once

#include <string>
#include <vector>

#include "geometry/threemf/xml_part.hpp"

namespace pliant::threemf {

/// One line each, with its place: elements and attributes of the core namespace that it does not know (each kind once),
/// attributes of the namespaces xml and xsi, metadata without a known name, of an undeclared namespace or given twice.
/// At most 50.
[[nodiscard]] std::vector<std::string> remarks_on(const XmlPart& part);

}  // namespace pliant::threemf

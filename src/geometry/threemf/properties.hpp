// The materials and colours that a model part declares.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "geometry/threemf/xml_part.hpp"

namespace pliant::threemf {

/// A group of properties: what a body of the property p is printed in. Groups that colour surfaces (textures) or mix
/// materials name one material for all their properties.
struct PropertyGroup {
    enum class Kind { base, colour, texture, composite, multi };
    Kind kind = Kind::base;
    std::vector<std::string> materials;  ///< per property
};

/// By the id that objects and triangles use.
using Properties = std::map<int, PropertyGroup>;

/// Reads the element if it is a property group or a texture, and returns whether it was one. Notes: what the
/// specification of materials forbids (missing values, references to groups that are not there or of a wrong kind).
bool read_property_group(const XmlPart& part, const pugi::xml_node& node, int id, Properties& properties,
                         std::map<int, std::string>& textures, Problem& problem);

}  // namespace pliant::threemf

// The materials and colours that a model part declares.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "geometry/threemf/xml_part.hpp"

namespace pliant::threemf {

/// A property group: the material of each property. Groups for surface colour (textures) or mixed materials have one
/// material for all their properties.
struct PropertyGroup {
    enum class Kind { base, colour, texture, composite, multi };
    Kind kind = Kind::base;
    std::vector<std::string> materials;  ///< per property
};

/// By the id that objects and triangles reference.
using Properties = std::map<int, PropertyGroup>;

/// Reads the element if it is a property group or a texture, and returns whether it was one. Problems: what the
/// materials specification forbids (missing values, references to missing groups or groups of a wrong kind).
bool read_property_group(const XmlPart& part, const pugi::xml_node& node, int id, Properties& properties,
                         std::map<int, std::string>& textures, Problem& problem);

}  // namespace pliant::threemf

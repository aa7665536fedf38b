// Slice stacks: bodies as outlines in layers.
#pragma once

#include <string>
#include <vector>

#include "geometry/threemf/read_3mf.hpp"
#include "geometry/threemf/xml_part.hpp"

namespace pliant::threemf {

/// A stack has its own slices or references stacks of other parts. Coordinates are in the part's unit.
struct SliceStack {
    struct Reference {
        std::string path;
        int stack = 0;
    };
    std::vector<Slice> slices;  ///< in file order, tops ascending
    std::vector<Reference> references;
};

/// Problems: tops that do not ascend, missing points. Outlines of fewer than three points enclose nothing: they are
/// left out, and a warning counts them.
[[nodiscard]] SliceStack read_slice_stack(const XmlPart& part, const pugi::xml_node& node, Problem& problem,
                                          std::vector<std::string>& warnings);

}  // namespace pliant::threemf

// Bodies given as outlines in layers.
#pragma once

#include <string>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/section.hpp"

namespace pliant::slice {

/// Returns the outlines of the slice that contains the middle of a layer; heights without a slice are empty.
class OutlineStack {
public:
    /// Errors name the body: slices that do not ascend or are beyond 2 m.
    [[nodiscard]] static Result<OutlineStack> from(std::vector<OutlineSlice> slices, const Layers& layers,
                                                   const std::string& label);

    /// Layers [0, layer_count()) may have outlines.
    [[nodiscard]] int layer_count() const { return layer_count_; }
    /// Appends the outlines at the middle of `layer`. Thread-safe.
    void section(int layer, std::vector<Segment>& segments) const;

    /// Area of the outlines times the height of their slices.
    [[nodiscard]] double volume_mm3() const;
    /// Area of the upright walls, the first bottom and the last top.
    [[nodiscard]] double area_mm2() const;

private:
    std::vector<OutlineSlice> slices_;
    Layers layers_ = 1;
    int layer_count_ = 0;
};

}  // namespace pliant::slice

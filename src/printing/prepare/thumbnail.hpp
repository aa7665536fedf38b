// A small picture of the part, built up while layers are written.
#pragma once

#include <cstdint>
#include <vector>

#include "printing/slice/compose.hpp"
#include "printing/slice/image.hpp"
#include "printing/slice/layers.hpp"

namespace pliant::job {

/// The part from the front, as if seen through: every material has its own grey, brighter the more of it is along the
/// line of sight. Cost: the runs of all layers.
class Thumbnail {
public:
    static constexpr int side_px = 400;

    /// What one column of the picture shows of a layer.
    struct Spot {
        std::uint8_t material = 0;
        std::uint16_t depth_px = 0;  ///< over all materials, along the line of sight; 0: nothing
    };

    explicit Thumbnail(int width_px);
    /// Thread-safe.
    [[nodiscard]] std::vector<Spot> row(const slice::ComposedLayer& layer) const;
    /// Adds layers in order, from 0.
    void add(const std::vector<Spot>& row) { spots_.insert(spots_.end(), row.begin(), row.end()); }
    /// A square picture with the part centred and as large as fits. `pixel_um`: of the layers' images.
    [[nodiscard]] slice::Image picture(const slice::Layers& layers, double pixel_um) const;

private:
    int width_px_, bins_;
    std::vector<Spot> spots_;  ///< (layers, bins)
};

}  // namespace pliant::job

// Detects printing problems: islands, cavities, separate pieces.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "printing/slice/layer_shape.hpp"
#include "printing/slice/layers.hpp"

namespace pliant::slice {

/// Solid that begins in a layer with nothing below it.
struct Island {
    int layer = 0;
    int row = 0, column = 0;  ///< of one of its pixels
    std::int64_t pixels = 0;
};

/// How serious a finding is. `low`: an effect of the raster; `medium`: should be looked at; `high`: will fail.
enum class Severity { low, medium, high };
[[nodiscard]] const char* severity_name(Severity severity);

/// Islands that merge before anything supports them: one object in mid-air.
struct IslandGroup {
    int islands = 0;
    int first_layer = 0, last_layer = 0;  ///< layers in mid-air
    int held_layer = -1;                  ///< the first layer in which it is connected to the platform; -1: never
    Island largest{};                     ///< where to look
    std::int64_t most_pixels = 0;         ///< in one layer, while unsupported
    std::int64_t voxels = 0;              ///< total over those layers
    Severity severity = Severity::high;
};

/// Void that is enclosed by solid while layers [first_layer, last_layer] are made.
struct Cavity {
    enum class End { closed, opened, last_layer };
    int first_layer = 0, last_layer = 0;
    std::int64_t voxels = 0;
    std::int64_t volume = 0;  ///< in pixels times micrometres
    int row = 0, column = 0;  ///< of one of its pixels, in the first layer
    End end = End::closed;    ///< closed for good: a resin trap; opened later, or open only at the part's last layer: a
                              ///< suction cup until then
};

/// A connected component of the solid, through all layers.
struct Piece {
    int first_layer = 0, last_layer = 0;
    std::int64_t voxels = 0;
};

struct Findings {
    std::vector<Island> islands;
    std::vector<IslandGroup> groups;  ///< groups of islands, the worst first
    std::vector<Cavity> cavities;
    std::vector<Piece> pieces;
    std::vector<int> faint_layers;  ///< layers with light, but without a pixel of at least half light
};

/// Tracks solid and void from layer to layer. Layers come in order, from 0; cost: their stretches.
class Inspector {
public:
    explicit Inspector(Layers layers = 1) : layers_(std::move(layers)) {}
    void add(LayerShape shape);
    /// Call after the last layer. Cavities below `least_voxels` are left out: surfaces that touch at a small angle
    /// create many of a pixel or two. Groups of islands of at most that many voxels, supported within two layers, are
    /// of low severity; the others are high if unsupported for more than two layers, otherwise medium.
    [[nodiscard]] Findings finish(std::int64_t least_voxels = 8);

private:
    struct Thing {
        std::uint32_t parent = 0;
        int first_layer = 0, last_layer = 0;
        std::int64_t voxels = 0;
        std::int64_t volume = 0;
        int row = 0, column = 0;
        bool held = false;    ///< for solid: connected to the platform
        IslandGroup group{};  ///< for solid that is not held
    };
    static std::uint32_t root(std::vector<Thing>& things, std::uint32_t i);
    static std::uint32_t join(std::vector<Thing>& things, std::uint32_t a, std::uint32_t b);
    void link_solid(const LayerShape& shape, const std::vector<std::uint32_t>& ids);
    void join_solids(std::uint32_t a, std::uint32_t b);
    void add_islands(const LayerShape& shape, const std::vector<std::uint32_t>& ids, const std::vector<bool>& on_solid);
    void link_voids(const LayerShape& shape, const std::vector<std::uint32_t>& ids);
    void join_voids(std::uint32_t a, std::uint32_t b);

    Layers layers_;
    int layer_ = 0;
    LayerShape below_;
    std::vector<std::uint32_t> solid_below_, voids_below_;  ///< per piece of the layer below: index of its thing
    std::vector<Thing> solids_, voids_{Thing{}};            ///< voids_[0] is the outside
    Findings findings_;
};

/// At most five lines for groups of islands and five for cavities, and one for all others of a severity, with layers,
/// places in millimetres on the platform, areas and volumes.
[[nodiscard]] std::vector<std::string> describe(const Findings& findings, const Raster& raster);

}  // namespace pliant::slice

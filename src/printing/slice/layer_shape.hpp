// Connected components of solid and void in a layer, whatever the material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "printing/slice/compose.hpp"
#include "printing/slice/run_set.hpp"

namespace pliant::slice {

/// Pixels [begin, end) of a row that belong to one component.
struct Stretch {
    std::uint16_t begin = 0, end = 0;
    std::uint32_t piece = 0;
};

/// Pixels of at least this value, half light, are solid.
inline constexpr int solid_value = 128;

/// Stretches of all rows in [first_row, first_row + rows()), from left to right.
struct PieceMap {
    int first_row = 0;
    std::vector<std::uint32_t> starts;  ///< (rows + 1)
    std::vector<Stretch> stretches;
    std::vector<std::int64_t> pixels;  ///< per piece

    [[nodiscard]] int rows() const { return starts.empty() ? 0 : static_cast<int>(starts.size()) - 1; }
    [[nodiscard]] std::span<const Stretch> row(int row) const;
};

/// Pixels below solid_value are void. Components are 4-connected.
struct LayerShape {
    PieceMap solid;
    PieceMap voids;  ///< in the rows of `solid`; piece 0 is the outside, which includes all other rows
    std::vector<int> solid_row, solid_column;  ///< first pixel of each piece of solid
    std::vector<int> void_row, void_column;    ///< the same for voids
    bool faint = false;                        ///< there is light, but no pixel is solid
};

/// The connected components of a set.
[[nodiscard]] PieceMap pieces_of(const RunSet& set);

/// Cost: the runs of the images.
[[nodiscard]] LayerShape shape_of(const ComposedLayer& layer, int width_px);

}  // namespace pliant::slice

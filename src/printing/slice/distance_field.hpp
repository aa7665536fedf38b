// Distance transform on a grid of cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant::slice {

/// Cells of a box; x varies fastest.
struct CellGrid {
    int nx = 0, ny = 0, nz = 0;
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(nx) * ny * nz; }
    [[nodiscard]] std::size_t at(int x, int y, int z) const { return (static_cast<std::size_t>(z) * ny + y) * nx + x; }
    [[nodiscard]] bool has(int x, int y, int z) const {
        return x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz;
    }
};

/// For every cell the squared distance between its centre and that of the nearest cell that is not `solid`, in units of
/// the cells' edge; cells outside the grid are not solid. `height`: of a cell, in the same unit. Exact; cost: linear in
/// the cells.
[[nodiscard]] std::vector<float> squared_distances(const CellGrid& grid, const std::vector<std::uint8_t>& solid,
                                                   double height);

/// The cells that are `solid`, as all of the 26 around them are; cells outside the grid are not.
[[nodiscard]] std::vector<std::uint8_t> surrounded(const CellGrid& grid, std::vector<std::uint8_t> solid);

}  // namespace pliant::slice

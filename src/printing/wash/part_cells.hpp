// A part in cells, as it hangs below the platform, and the surface of it that gets wet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::wash {

/// Cells are `cell_mm` wide and deep, `high_mm` high. x and y count from `x_mm`, `y_mm`, the corner of the first cell
/// from the middle of the platform; z counts down from the platform.
struct PartCells {
    int columns = 0, rows = 0, slabs = 0;
    double cell_mm = 0, high_mm = 0;
    double x_mm = 0, y_mm = 0;
    std::vector<std::uint8_t> solid;  ///< (slabs, rows, columns)

    [[nodiscard]] double height_mm() const { return slabs * high_mm; }
    [[nodiscard]] std::size_t index(int column, int row, int slab) const {
        return (static_cast<std::size_t>(slab) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row)) *
                   static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(column);
    }
    /// Outside of the cells nothing is solid.
    [[nodiscard]] bool at(int column, int row, int slab) const {
        return column >= 0 && row >= 0 && slab >= 0 && column < columns && row < rows && slab < slabs &&
               solid[index(column, row, slab)] != 0;
    }
};

/// A side of a solid cell with nothing behind it. Millimetres from the middle of the platform's face, z up: the part
/// lies below 0.
struct Face {
    Vec3 middle;
    Vec3 axis;            ///< outwards from the cell, of length 1
    Vec3 normal;          ///< of the smooth surface that the cells stand for, of length 1
    double area_mm2 = 0;  ///< of that surface
};

/// All but what is fixed to the platform, slab by slab. Closed pockets count too: nothing reaches them.
[[nodiscard]] std::vector<Face> wet_faces(const PartCells& part);

/// Joins fine cells to larger ones, at most `most` in any direction and not much wider than high; what is filled to a
/// third is solid. Memory: of the larger cells only.
class CellJoiner {
public:
    /// `fine` without its `solid`.
    CellJoiner(const PartCells& fine, int most);
    /// A solid cell of the fine ones.
    void add(int column, int row, int slab);
    [[nodiscard]] PartCells made() &&;

private:
    int wide_ = 1, high_ = 1;
    PartCells out_;
    std::vector<int> filled_;
};

/// The same part in larger cells.
[[nodiscard]] PartCells coarsened(const PartCells& part, int most);

}  // namespace pliant::wash

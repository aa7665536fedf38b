// A part in cells, hanging below the platform, and its wetted surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::wash {

/// Cells are `cell_mm` wide and deep, `high_mm` high. The corner of the first cell is at `x_mm`, `y_mm` from the middle
/// of the platform; z counts down from the platform.
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
    /// Nothing outside the cells is solid.
    [[nodiscard]] bool at(int column, int row, int slab) const {
        return column >= 0 && row >= 0 && slab >= 0 && column < columns && row < rows && slab < slabs &&
               solid[index(column, row, slab)] != 0;
    }
};

/// A face of a solid cell with an empty cell in front of it. Millimetres from the middle of the platform's face, z up:
/// the part is below 0.
struct Face {
    Vec3 middle;
    Vec3 axis;            ///< outward unit normal of the cell's face
    Vec3 normal;          ///< unit normal of the smooth surface that the cells represent
    double area_mm2 = 0;  ///< of that surface
};

/// All faces except those on the platform, slab by slab. Those of closed pockets are included, although nothing reaches
/// them.
[[nodiscard]] std::vector<Face> wet_faces(const PartCells& part);

/// Merges fine cells into larger ones, at most `most` in any direction and not much wider than high; a large cell is
/// solid if a third of it is filled. Memory: of the larger cells only.
class CellJoiner {
public:
    /// `fine`: its `solid` is not used.
    CellJoiner(const PartCells& fine, int most);
    /// Adds a solid fine cell.
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

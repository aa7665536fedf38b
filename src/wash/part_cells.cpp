#include "wash/part_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant::wash {
namespace {

struct Side {
    int column, row, slab;
};
constexpr std::array<Side, 6> sides = {{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

/// Away from what is solid around a cell: cells show a slope as steps, which this smooths. The platform counts as
/// solid.
Vec3 outwards(const PartCells& part, int column, int row, int slab) {
    constexpr int reach = 2;
    Vec3 away;
    for (int s = -reach; s <= reach; ++s) {
        for (int r = -reach; r <= reach; ++r) {
            for (int c = -reach; c <= reach; ++c) {
                if (!part.at(column + c, row + r, std::max(0, slab + s))) continue;
                away -= Vec3{c * part.cell_mm, r * part.cell_mm, -s * part.high_mm};
            }
        }
    }
    return away;
}

Face face_of(const PartCells& part, int column, int row, int slab, const Side& side) {
    const double area = side.slab != 0 ? part.cell_mm * part.cell_mm : part.cell_mm * part.high_mm;
    const Vec3 axis{static_cast<double>(side.column), static_cast<double>(side.row), static_cast<double>(-side.slab)};
    const Vec3 away = outwards(part, column, row, slab);
    // Of a thin wall, whose other side is as near, the sum says nothing.
    const double least = 1e-6 * (part.cell_mm + part.high_mm);
    const Vec3 normal = norm(away) > least && dot(away, axis) > 0 ? unit(away) : axis;
    return {{part.x_mm + (column + 0.5 + 0.5 * side.column) * part.cell_mm,
             part.y_mm + (row + 0.5 + 0.5 * side.row) * part.cell_mm, -(slab + 0.5 + 0.5 * side.slab) * part.high_mm},
            axis,
            normal,
            area * dot(normal, axis)};
}

}  // namespace

std::vector<Face> wet_faces(const PartCells& part) {
    std::vector<Face> faces;
    for (int slab = 0; slab < part.slabs; ++slab) {
        for (int row = 0; row < part.rows; ++row) {
            for (int column = 0; column < part.columns; ++column) {
                if (!part.at(column, row, slab)) continue;
                for (const Side& side : sides) {
                    const bool on_platform = slab + side.slab < 0;
                    if (on_platform || part.at(column + side.column, row + side.row, slab + side.slab)) continue;
                    faces.push_back(face_of(part, column, row, slab, side));
                }
            }
        }
    }
    return faces;
}

PartCells coarsened(const PartCells& part, int most) {
    const int wide = (std::max(part.columns, part.rows) + most - 1) / most;
    // About as high as wide: what a slope looks like is judged from the cells around it.
    const int high = std::max(
        {1, (part.slabs + most - 1) / most, static_cast<int>(std::lround(part.cell_mm * wide / part.high_mm))});
    if (wide <= 1 && high <= 1) return part;
    PartCells out{(part.columns + wide - 1) / wide,
                  (part.rows + wide - 1) / wide,
                  (part.slabs + high - 1) / high,
                  part.cell_mm * wide,
                  part.high_mm * high,
                  part.x_mm,
                  part.y_mm,
                  {}};
    std::vector<int> filled(static_cast<std::size_t>(out.columns) * static_cast<std::size_t>(out.rows) *
                            static_cast<std::size_t>(out.slabs));
    for (int slab = 0; slab < part.slabs; ++slab) {
        for (int row = 0; row < part.rows; ++row) {
            for (int column = 0; column < part.columns; ++column)
                filled[out.index(column / wide, row / wide, slab / high)] += part.at(column, row, slab) ? 1 : 0;
        }
    }
    out.solid.resize(filled.size());
    for (std::size_t i = 0; i < filled.size(); ++i) out.solid[i] = 3 * filled[i] >= wide * wide * high ? 1 : 0;
    return out;
}

}  // namespace pliant::wash

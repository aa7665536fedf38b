#include "printing/wash/part_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pliant::wash {
namespace {

struct Direction {
    int column, row, slab;
};
constexpr std::array<Direction, 6> directions = {{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

/// The direction away from the solid around a cell: smooths the steps by which cells approximate a slope. The platform
/// counts as solid.
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

Face face_of(const PartCells& part, int column, int row, int slab, const Direction& side) {
    const double area = side.slab != 0 ? part.cell_mm * part.cell_mm : part.cell_mm * part.high_mm;
    const Vec3 axis{static_cast<double>(side.column), static_cast<double>(side.row), static_cast<double>(-side.slab)};
    const Vec3 away = outwards(part, column, row, slab);
    // On a thin wall, whose other side is as near, the sum is meaningless.
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
                for (const Direction& side : directions) {
                    const bool on_platform = slab + side.slab < 0;
                    if (on_platform || part.at(column + side.column, row + side.row, slab + side.slab)) continue;
                    faces.push_back(face_of(part, column, row, slab, side));
                }
            }
        }
    }
    return faces;
}

CellJoiner::CellJoiner(const PartCells& fine, int most)
    : wide_(std::max(1, (std::max(fine.columns, fine.rows) + most - 1) / most)) {
    // About as high as wide: slopes are estimated from the surrounding cells.
    const int as_wide = static_cast<int>(std::lround(fine.cell_mm * wide_ / fine.high_mm));
    high_ = std::max({1, (fine.slabs + most - 1) / most, as_wide});
    out_ = {(fine.columns + wide_ - 1) / wide_,
            (fine.rows + wide_ - 1) / wide_,
            (fine.slabs + high_ - 1) / high_,
            fine.cell_mm * wide_,
            fine.high_mm * high_,
            fine.x_mm,
            fine.y_mm,
            {}};
    filled_.resize(static_cast<std::size_t>(out_.columns) * static_cast<std::size_t>(out_.rows) *
                   static_cast<std::size_t>(out_.slabs));
}

void CellJoiner::add(int column, int row, int slab) {
    ++filled_[out_.index(column / wide_, row / wide_, slab / high_)];
}

PartCells CellJoiner::made() && {
    out_.solid.resize(filled_.size());
    for (std::size_t i = 0; i < filled_.size(); ++i) out_.solid[i] = 3 * filled_[i] >= wide_ * wide_ * high_ ? 1 : 0;
    return std::move(out_);
}

PartCells coarsened(const PartCells& part, int most) {
    CellJoiner joiner(part, most);
    for (int slab = 0; slab < part.slabs; ++slab) {
        for (int row = 0; row < part.rows; ++row) {
            for (int column = 0; column < part.columns; ++column) {
                if (part.at(column, row, slab)) joiner.add(column, row, slab);
            }
        }
    }
    return std::move(joiner).made();
}

}  // namespace pliant::wash

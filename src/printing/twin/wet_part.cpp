#include "printing/twin/wet_part.hpp"

#include <algorithm>
#include <utility>

namespace pliant::twin {
namespace {

constexpr int most_cells = 80;

/// Rows and columns that contain anything.
struct Bounds {
    int row = 0, end_row = 0, column = 0, end_column = 0;
};

Bounds bounds_of(const CoarsePart& part) {
    Bounds b{part.rows(), 0, part.columns(), 0};
    for (const CoarsePart::CellRun& run : part.runs()) {
        b.row = std::min(b.row, static_cast<int>(run.row));
        b.end_row = std::max(b.end_row, run.row + 1);
        b.column = std::min(b.column, static_cast<int>(run.begin));
        b.end_column = std::max(b.end_column, static_cast<int>(run.end));
    }
    return b;
}

}  // namespace

wash::PartCells wet_part(const CoarsePart& part, const machine::Projector& projector) {
    wash::PartCells cells;
    if (part.runs().empty()) return cells;
    const Bounds b = bounds_of(part);
    const CoarsePart::Slab& first = part.slabs().front();
    // Slabs are equally high, except the last one and where empty layers are in between.
    const int slab_um = std::max(1, first.top_um - first.bottom_um);
    cells.columns = b.end_column - b.column;
    cells.rows = b.end_row - b.row;
    cells.slabs = (part.slabs().back().top_um + slab_um - 1) / slab_um;
    cells.cell_mm = part.cell_px() * projector.pixel_um / 1000;
    cells.high_mm = slab_um / 1000.0;
    const double left = b.column - part.columns() / 2.0, right = b.end_column - part.columns() / 2.0;
    const double upper = b.row - part.rows() / 2.0, lower = b.end_row - part.rows() / 2.0;
    cells.x_mm = cells.cell_mm * (projector.mirror_x ? -right : left);
    cells.y_mm = cells.cell_mm * (projector.mirror_y ? upper : -lower);
    wash::CellJoiner joiner(cells, most_cells);
    for (const CoarsePart::CellRun& run : part.runs()) {
        const CoarsePart::Slab& slab = part.slabs()[run.slab];
        const int row = projector.mirror_y ? run.row - b.row : b.end_row - 1 - run.row;
        for (int c = run.begin; c < run.end; ++c) {
            const int column = projector.mirror_x ? b.end_column - 1 - c : c - b.column;
            for (int s = slab.bottom_um / slab_um; s * slab_um < slab.top_um; ++s) joiner.add(column, row, s);
        }
    }
    return std::move(joiner).made();
}

}  // namespace pliant::twin

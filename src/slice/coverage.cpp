#include "slice/coverage.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::slice {

CellBuffer::CellBuffer(const Raster& raster) : raster_(raster) {}

void CellBuffer::add(int body, const std::vector<Segment>& segments) {
    body_ = static_cast<std::uint64_t>(body);
    const double pixel = raster_.pixel_um * grid_per_um;
    const double width = raster_.width_px, height = raster_.height_px;
    const auto column = [&](double x) {
        return std::clamp((raster_.mirror_x ? -x : x) / pixel + width / 2, 0.0, width);
    };
    const auto row = [&](double y) {
        return std::clamp((raster_.mirror_y ? y : -y) / pixel + height / 2, 0.0, height);
    };
    const bool reversed = raster_.mirror_x != raster_.mirror_y;  // one mirror turns left into right
    for (const Segment& s : segments) {
        const double u0 = column(s.x0), v0 = row(s.y0), u1 = column(s.x1), v1 = row(s.y1);
        if (reversed) {
            add_line(u1, v1, u0, v0);
        } else {
            add_line(u0, v0, u1, v1);
        }
    }
}

void CellBuffer::add_line(double u0, double v0, double u1, double v1) {
    if (v0 == v1) return;
    const double slope = (u1 - u0) / (v1 - v0);
    const auto u_at = [&](double v) { return std::clamp(u0 + (v - v0) * slope, std::min(u0, u1), std::max(u0, u1)); };
    const int step = v1 > v0 ? 1 : -1;
    // The row of the piece that starts at v and goes towards v1.
    int row = step > 0 ? static_cast<int>(std::floor(v0)) : static_cast<int>(std::ceil(v0)) - 1;
    double u = u0, v = v0;
    while (v != v1) {
        const double border = step > 0 ? row + 1 : row;
        const bool last = step > 0 ? v1 <= border : v1 >= border;
        const double v_next = last ? v1 : border;
        const double u_next = last ? u1 : u_at(border);
        add_in_row(row, u, v, u_next, v_next);
        u = u_next;
        v = v_next;
        row += step;
    }
}

/// A piece inside one row of pixels, cut where it passes from column to column.
void CellBuffer::add_in_row(int row, double u0, double v0, double u1, double v1) {
    const int first = static_cast<int>(std::floor(std::min(u0, u1)));
    const int last = static_cast<int>(std::ceil(std::max(u0, u1))) - 1;
    // The solid lies to the left of an outline seen from above, so to the right of one that runs down the image.
    const double height = v1 - v0;
    if (last <= first) {
        add_cell(row, first, height, height * (1 - ((u0 + u1) / 2 - first)));
        return;
    }
    const double low_u = std::min(u0, u1), high_u = std::max(u0, u1);
    const double per_column = height / (high_u - low_u);
    double left = low_u, rest = height;
    for (int column = first; column <= last; ++column) {
        const double right = column == last ? high_u : column + 1;
        const double cover = column == last ? rest : (right - left) * per_column;
        add_cell(row, column, cover, cover * (1 - ((left + right) / 2 - column)));
        rest -= cover;
        left = right;
    }
}

void CellBuffer::add_cell(int row, int column, double cover, double area) {
    const std::uint64_t key =
        (static_cast<std::uint64_t>(row) << 48) | (static_cast<std::uint64_t>(column) << 31) | body_;
    if (!cells_.empty() && cells_.back().key == key) {
        cells_.back().cover += cover;
        cells_.back().area += area;
    } else {
        cells_.push_back({key, cover, area});
    }
}

const std::vector<Cell>& CellBuffer::sorted() {
    std::stable_sort(cells_.begin(), cells_.end(), [](const Cell& l, const Cell& r) { return l.key < r.key; });
    return cells_;
}

}  // namespace pliant::slice

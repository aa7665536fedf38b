#include "printing/twin/coarse_part.hpp"

#include <algorithm>
#include <utility>

namespace pliant::twin {
namespace {

constexpr int most_columns = 1024;
constexpr int most_slabs = 256;

}  // namespace

CoarsePart::CoarsePart(int width_px, int height_px, double pixel_um, int part_um, double least_share)
    : width_px_(width_px),
      height_px_(height_px),
      pixel_um_(pixel_um),
      least_share_(static_cast<float>(least_share)),
      cell_px_((std::max(width_px, height_px) + most_columns - 1) / most_columns),
      slab_um_(std::max(1, part_um / most_slabs)) {
    size_up();
}

void CoarsePart::size_up() {
    columns_ = (width_px_ + cell_px_ - 1) / cell_px_;
    rows_ = (height_px_ + cell_px_ - 1) / cell_px_;
    filled_.clear();
    first_row_ = rows_;
    end_row_ = 0;
}

float& CoarsePart::filled(int material, int row, int column) {
    const auto m = static_cast<std::size_t>(material);
    if (filled_.size() <= m) filled_.resize(m + 1);
    std::vector<float>& cells = filled_[m];
    if (cells.empty()) cells.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)];
}

/// Adds the pixels [begin, end) of one row, each with the given weight.
void CoarsePart::cover(int row, int begin, int end, int material, float weight) {
    begin = std::max(begin, 0);
    end = std::min(end, width_px_);
    if (row < 0 || row >= height_px_ || begin >= end) return;
    const int cell_row = row / cell_px_;
    first_row_ = std::min(first_row_, cell_row);
    end_row_ = std::max(end_row_, cell_row + 1);
    for (int px = begin; px < end;) {
        const int column = px / cell_px_, stop = std::min(end, (column + 1) * cell_px_);
        filled(material, cell_row, column) += weight * static_cast<float>(stop - px);
        px = stop;
    }
}

void CoarsePart::add(int bottom_um, int top_um, int material, const Runs& runs) {
    constexpr int most_materials = 255;
    if (top_um <= bottom_um || material < 0 || material >= most_materials) return;
    if (slabs_.size() > closed_ && bottom_um >= slabs_[closed_].bottom_um + slab_um_) close_open();
    if (slabs_.size() == closed_) slabs_.push_back({bottom_um, top_um, runs_.size()});
    slabs_[closed_].top_um = std::max(slabs_[closed_].top_um, top_um);
    top_um_ = std::max(top_um_, top_um);
    const auto thick = static_cast<float>(top_um - bottom_um);
    for (const Run& run : runs)
        cover(run.row, run.begin, run.end, material, thick * static_cast<float>(std::min<int>(run.value, 255)) / 255);
    write_open();
}

/// Writes the runs of the open slab anew.
void CoarsePart::write_open() {
    const Slab& slab = slabs_[closed_];
    runs_.resize(slab.first);
    const auto area = static_cast<float>(cell_px_) * static_cast<float>(cell_px_);
    const float least = least_share_ * area * static_cast<float>(slab.top_um - slab.bottom_um);
    for (int row = first_row_; row < end_row_; ++row) write_row(row, least);
}

/// A cell gets the material with the largest share if all of them together reach `least`.
void CoarsePart::write_row(int row, float least) {
    int owner_before = -1;
    for (int column = 0; column < columns_; ++column) {
        const std::size_t at =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
        int owner = -1;
        float most = 0, all = 0;
        for (std::size_t m = 0; m < filled_.size(); ++m) {
            if (filled_[m].empty()) continue;
            all += filled_[m][at];
            if (filled_[m][at] <= most) continue;
            most = filled_[m][at];
            owner = static_cast<int>(m);
        }
        if (all < least) owner = -1;
        if (owner >= 0 && owner == owner_before) {
            ++runs_.back().end;
        } else if (owner >= 0) {
            runs_.push_back({static_cast<std::uint32_t>(closed_), static_cast<std::uint16_t>(row),
                             static_cast<std::uint16_t>(column), static_cast<std::uint16_t>(column + 1),
                             static_cast<std::uint8_t>(owner)});
        }
        owner_before = owner;
    }
}

void CoarsePart::empty_open() {
    const auto width = static_cast<std::ptrdiff_t>(columns_);
    for (std::vector<float>& cells : filled_) {
        if (cells.empty() || first_row_ >= end_row_) continue;
        std::fill(cells.begin() + first_row_ * width, cells.begin() + end_row_ * width, 0.0F);
    }
    first_row_ = rows_;
    end_row_ = 0;
}

void CoarsePart::close_open() {
    empty_open();
    ++closed_;
    while (runs_.size() > most_runs && cell_px_ < std::max(width_px_, height_px_)) coarsen();
}

/// Enlarges the cells; makes slabs thicker, too, if a cell is wider than a slab is thick.
void CoarsePart::coarsen() {
    const std::vector<Slab> slabs = std::exchange(slabs_, {});
    const std::vector<CellRun> runs = std::exchange(runs_, {});
    const int old_px = cell_px_;
    if (cell_px_ * pixel_um_ >= slab_um_) slab_um_ *= 2;
    cell_px_ *= 2;
    ++revision_;
    closed_ = 0;
    size_up();
    for (std::size_t s = 0; s < slabs.size(); ++s) {
        const std::size_t end = s + 1 < slabs.size() ? slabs[s + 1].first : runs.size();
        std::vector<Runs> parts(1);
        for (std::size_t r = slabs[s].first; r < end; ++r) {
            const CellRun& run = runs[r];
            if (parts.size() <= run.material) parts.resize(run.material + std::size_t{1});
            for (int k = 0; k < old_px; ++k)
                parts[run.material].push_back({run.row * old_px + k, run.begin * old_px, run.end * old_px, 255});
        }
        for (std::size_t m = 0; m < parts.size(); ++m)
            add(slabs[s].bottom_um, slabs[s].top_um, static_cast<int>(m), parts[m]);
    }
    // New layers are added as pixels, so they cannot go into a slab that was made from cells.
    if (slabs_.size() > closed_) {
        empty_open();
        ++closed_;
    }
}

}  // namespace pliant::twin

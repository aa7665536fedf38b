// A coarse model of a part as it grows, small enough to be sent to a page and drawn: slabs of cells, each of one
// material or empty. It never exceeds `most_runs` runs of cells: when there are more, the cells grow and everything is
// sent anew.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "printing/twin/runs.hpp"

namespace pliant::twin {

class CoarsePart {
public:
    static constexpr std::size_t most_runs = 40000;
    /// A wall thinner than a cell remains visible.
    static constexpr double usual_share = 0.3;

    /// For a frame of this many pixels, a part of that height. `least_share`: fraction of a cell that must be solid for
    /// it to count.
    CoarsePart(int width_px, int height_px, double pixel_um, int part_um, double least_share = usual_share);

    /// Adds what has become solid between two heights; from low to high, within a layer material (0 to 254) by
    /// material.
    void add(int bottom_um, int top_um, int material, const Runs& runs);

    /// Cells [begin, end) of one row of a slab.
    struct CellRun {
        std::uint32_t slab;
        std::uint16_t row, begin, end;
        std::uint8_t material;
    };
    struct Slab {
        int bottom_um, top_um;
        std::size_t first;  ///< index of its first run; they end where those of the next slab begin
    };
    /// The last one may still change.
    [[nodiscard]] const std::vector<Slab>& slabs() const { return slabs_; }
    [[nodiscard]] const std::vector<CellRun>& runs() const { return runs_; }
    /// Number of slabs that are final.
    [[nodiscard]] std::size_t closed() const { return closed_; }
    /// Increases when the cells grow: everything sent before is then invalid.
    [[nodiscard]] int revision() const { return revision_; }
    [[nodiscard]] int cell_px() const { return cell_px_; }
    [[nodiscard]] int columns() const { return columns_; }
    [[nodiscard]] int rows() const { return rows_; }
    /// Height reached so far.
    [[nodiscard]] int top_um() const { return top_um_; }

private:
    void size_up();
    void cover(int row, int begin, int end, int material, float weight);
    void write_open();
    void write_row(int row, float least);
    void empty_open();
    void close_open();
    void coarsen();
    [[nodiscard]] float& filled(int material, int row, int column);

    int width_px_, height_px_;
    double pixel_um_;
    float least_share_;
    int cell_px_;
    int slab_um_;
    int columns_ = 0, rows_ = 0;
    int revision_ = 0;
    int top_um_ = 0;
    std::size_t closed_ = 0;
    std::vector<Slab> slabs_;
    std::vector<CellRun> runs_;
    std::vector<std::vector<float>> filled_;  ///< of the open slab, by material: thickness in um times area in pixels
    int first_row_ = 0, end_row_ = 0;         ///< of the open slab
};

}  // namespace pliant::twin

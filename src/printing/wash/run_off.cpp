#include "printing/wash/run_off.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace pliant::wash {
namespace {

constexpr std::size_t none = SIZE_MAX;

struct Cell {
    int column, row, slab;
};

/// Sides of a cell in the order of wet_faces(): west, east, south, north, up to the platform, down.
enum Side { west, east, south, north, up, down, sides };
constexpr std::array<Cell, sides> behind = {{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

class Flow {
public:
    Flow(const PartCells& part, const std::vector<Face>& faces, const std::vector<double>& rates)
        : part_(part), faces_(faces), face_of_(part.solid.size() * sides, none), flow_mm3_s_(faces.size()) {
        number_faces();
        for (std::size_t f = 0; f < faces.size(); ++f) flow_mm3_s_[f] = rates[f] * faces[f].area_mm2;
    }

    /// From the platform down: no face passes solution to one above it.
    std::vector<double> run() {
        for (int slab = 0; slab < part_.slabs; ++slab) {
            spread_ledges(slab);
            for_cells(slab, [&](const Cell& cell) {
                for (const Side side : {west, east, south, north}) run_down(cell, side);
            });
            for_cells(slab, [&](const Cell& cell) { drip(cell); });
        }
        std::vector<double> rates(faces_.size());
        for (std::size_t f = 0; f < faces_.size(); ++f)
            rates[f] = faces_[f].area_mm2 > 0 ? flow_mm3_s_[f] / faces_[f].area_mm2 : 0;
        return rates;
    }

private:
    template <class Work>
    void for_cells(int slab, Work work) {
        for (int row = 0; row < part_.rows; ++row) {
            for (int column = 0; column < part_.columns; ++column) {
                if (part_.at(column, row, slab)) work(Cell{column, row, slab});
            }
        }
    }
    /// In the order in which wet_faces() lists them.
    void number_faces() {
        std::size_t next = 0;
        for (int slab = 0; slab < part_.slabs; ++slab) {
            for_cells(slab, [&](const Cell& cell) {
                for (int side = 0; side < sides; ++side) {
                    const Cell& step = behind[static_cast<std::size_t>(side)];
                    const bool on_platform = slab + step.slab < 0;
                    if (on_platform || part_.at(cell.column + step.column, cell.row + step.row, cell.slab + step.slab))
                        continue;
                    face_of_[slot(cell, static_cast<Side>(side))] = next++;
                }
            });
        }
    }
    [[nodiscard]] std::size_t slot(const Cell& c, Side side) const {
        return part_.index(c.column, c.row, c.slab) * sides + static_cast<std::size_t>(side);
    }
    [[nodiscard]] std::size_t face(const Cell& c, Side side) const {
        return part_.at(c.column, c.row, c.slab) ? face_of_[slot(c, side)] : none;
    }
    void give(std::size_t to, double mm3_s) {
        if (to != none) flow_mm3_s_[to] += mm3_s;
    }

    /// Down a wall: to its next cell, onto a ledge, or around its lower edge.
    void run_down(const Cell& cell, Side side) {
        const std::size_t from = face(cell, side);
        if (from == none) return;
        const Cell& out = behind[static_cast<std::size_t>(side)];
        const Cell below{cell.column, cell.row, cell.slab + 1};
        const Cell ledge{cell.column + out.column, cell.row + out.row, cell.slab + 1};
        const double q = flow_mm3_s_[from];
        if (const std::size_t onto = face(ledge, up); onto != none) return give(onto, q);
        if (const std::size_t on = face(below, side); on != none) return give(on, q);
        give(face(cell, down), q);
    }

    /// From an underside onto the next face below.
    void drip(const Cell& cell) {
        const std::size_t from = face(cell, down);
        if (from == none) return;
        for (Cell below{cell.column, cell.row, cell.slab + 1}; below.slab < part_.slabs; ++below.slab) {
            if (const std::size_t onto = face(below, up); onto != none) return give(onto, flow_mm3_s_[from]);
        }
    }

    /// Solution on a ledge spreads evenly and leaves evenly over its edges.
    void spread_ledges(int slab) {
        std::vector<std::uint8_t> seen(static_cast<std::size_t>(part_.columns) * static_cast<std::size_t>(part_.rows));
        const auto at = [&](const Cell& c) {
            return static_cast<std::size_t>(c.row) * static_cast<std::size_t>(part_.columns) +
                   static_cast<std::size_t>(c.column);
        };
        for_cells(slab, [&](const Cell& first) {
            if (face(first, up) == none || seen[at(first)] != 0) return;
            std::vector<Cell> ledge = {first};
            seen[at(first)] = 1;
            for (std::size_t i = 0; i < ledge.size(); ++i) {
                for (const Side side : {west, east, south, north}) {
                    const Cell& step = behind[static_cast<std::size_t>(side)];
                    const Cell next{ledge[i].column + step.column, ledge[i].row + step.row, slab};
                    if (face(next, up) == none || seen[at(next)] != 0) continue;
                    seen[at(next)] = 1;
                    ledge.push_back(next);
                }
            }
            spread(ledge);
        });
    }

    void spread(const std::vector<Cell>& ledge) {
        double flow = 0, area = 0;
        std::vector<std::size_t> edge;
        for (const Cell& cell : ledge) {
            const std::size_t f = face(cell, up);
            flow += flow_mm3_s_[f];
            area += faces_[f].area_mm2;
            for (const Side side : {west, east, south, north}) {
                if (const std::size_t wall = face(cell, side); wall != none) edge.push_back(wall);
            }
        }
        for (const Cell& cell : ledge) {
            const std::size_t f = face(cell, up);
            flow_mm3_s_[f] = area > 0 ? flow * faces_[f].area_mm2 / area : 0;
        }
        for (const std::size_t wall : edge) give(wall, flow / static_cast<double>(edge.size()));
    }

    const PartCells& part_;
    const std::vector<Face>& faces_;
    std::vector<std::size_t> face_of_;  ///< (cells, sides)
    std::vector<double> flow_mm3_s_;    ///< flow over each face
};

}  // namespace

std::vector<double> with_run_off(const PartCells& part, const std::vector<Face>& faces,
                                 const std::vector<double>& rates_mm_s) {
    return Flow(part, faces, rates_mm_s).run();
}

std::vector<double> washed_rates(const PartCells& part, const std::vector<Face>& faces, const machine::Printer& printer,
                                 const Strokes& strokes) {
    return with_run_off(part, faces, spray_rates(part, faces, printer, strokes));
}

}  // namespace pliant::wash

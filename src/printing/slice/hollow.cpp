#include "printing/slice/hollow.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/core/parallel.hpp"
#include "printing/slice/distance_field.hpp"
#include "printing/slice/layer_shape.hpp"

namespace pliant::slice {
namespace {

/// The first and the last slab of cells that a layer reaches into.
struct Slabs {
    int first = 0, last = 0;
};

/// The grid of cells over pixels and layers. If all layers are of one thickness, a slab of cells is some of them;
/// else a layer may reach into two slabs.
struct Cells {
    CellGrid grid;
    int edge_px = 1;
    int left_px = 0, top_px = 0;  ///< position of the first cell
    double height_um = 0;
    int layer_count = 0;

    [[nodiscard]] Slabs slabs_of(const Layers& layers, int k) const {
        constexpr double rounding = 1e-6;
        const int first = std::min(static_cast<int>(layers.bottom_um(k) / height_um + rounding), grid.nz - 1);
        const int end = static_cast<int>(std::ceil(layers.top_um(k) / height_um - rounding));
        return {first, std::clamp(end - 1, first, grid.nz - 1)};
    }
    /// Whether the cavity takes the pixels of this cell from a layer: a wall must not get thinner by a layer that
    /// reaches into it.
    [[nodiscard]] bool takes(const std::vector<std::uint8_t>& hollow, int x, int y, Slabs slabs) const {
        for (int z = slabs.first; z <= slabs.last; ++z) {
            if (hollow[grid.at(x, y, z)] == 0) return false;
        }
        return true;
    }
};

/// A hole along a row or a column of the image.
struct Drain {
    double z_um = 0;       ///< of its axis
    double across_px = 0;  ///< of its axis: the row of a hole along a row, else the column
    int begin_px = 0, end_px = 0;
    bool along_rows = false;
};

class CavityRemoval final : public Removal {
public:
    CavityRemoval(const Raster& raster, Layers layers, Cells cells, std::vector<std::uint8_t> hollow,
                  std::vector<Drain> drains, double drain_um)
        : raster_(raster),
          layers_(std::move(layers)),
          cells_(cells),
          hollow_(std::move(hollow)),
          drains_(std::move(drains)),
          radius_um_(drain_um / 2) {}

    [[nodiscard]] RunSet at(int layer) const override {
        RunSet removed = cavity(layer);
        for (const Drain& drain : drains_) {
            const double up_um = layers_.middle2_um(layer) / 2.0 - drain.z_um;
            if (std::fabs(up_um) < radius_um_)
                removed = united(removed, hole(drain, std::sqrt(radius_um_ * radius_um_ - up_um * up_um)));
        }
        return removed;
    }

private:
    [[nodiscard]] RunSet cavity(int layer) const {
        RunSet set(raster_.width_px, raster_.height_px);
        if (layer >= cells_.layer_count) return set;
        const Slabs slabs = cells_.slabs_of(layers_, layer);
        for (int y = 0; y < cells_.grid.ny; ++y) {
            const std::vector<PixelSpan> spans = row_of(y, slabs);
            for (int r = 0; r < cells_.edge_px; ++r) set.append_row(cells_.top_px + y * cells_.edge_px + r, spans);
        }
        return set;
    }

    [[nodiscard]] std::vector<PixelSpan> row_of(int y, Slabs slabs) const {
        std::vector<PixelSpan> spans;
        for (int x = 0; x < cells_.grid.nx; ++x) {
            if (!cells_.takes(hollow_, x, y, slabs)) continue;
            const int begin = cells_.left_px + x * cells_.edge_px, end = begin + cells_.edge_px;
            if (!spans.empty() && spans.back().end == begin)
                spans.back().end = end;
            else
                spans.push_back({begin, end});
        }
        return spans;
    }

    [[nodiscard]] RunSet hole(const Drain& drain, double half_um) const {
        RunSet set(raster_.width_px, raster_.height_px);
        const double half = half_um / raster_.pixel_um;
        const int low = static_cast<int>(std::lround(drain.across_px - half));
        const int high = static_cast<int>(std::lround(drain.across_px + half));
        const PixelSpan along{std::max(0, drain.begin_px),
                              std::min(drain.end_px, drain.along_rows ? raster_.width_px : raster_.height_px)};
        const PixelSpan across{std::max(0, low),
                               std::min(high, drain.along_rows ? raster_.height_px : raster_.width_px)};
        const PixelSpan rows = drain.along_rows ? across : along, columns = drain.along_rows ? along : across;
        if (columns.begin >= columns.end) return set;
        for (int row = rows.begin; row < rows.end; ++row) set.append_row(row, {columns});
        return set;
    }

    Raster raster_;
    Layers layers_;
    Cells cells_;
    std::vector<std::uint8_t> hollow_;
    std::vector<Drain> drains_;
    double radius_um_;
};

class Hollower {
public:
    Hollower(const Slicer& slicer, const HollowSettings& wanted)
        : slicer_(slicer), wanted_(wanted), raster_(slicer.settings().raster), layers_(slicer.layers()) {}

    Result<Hollowing> run(Progress& progress) {
        lay_cells();
        if (Status status = fill_solid(progress); !status) return tl::unexpected(status.error());
        mark_hollow();
        Hollowing result;
        std::vector<Drain> drains = find_cavities(result);
        result.volume_mm3 = volume_mm3();
        if (result.volume_mm3 == 0)
            return input_error("hollow: nothing of the part lies {:.4g} mm deep inside of it", wanted_.wall_um / 1000);
        result.drains = static_cast<int>(drains.size());
        result.removed = std::make_shared<CavityRemoval>(raster_, layers_, cells_, std::move(hollow_),
                                                         std::move(drains), wanted_.drain_um);
        return result;
    }

private:
    /// Calls `visit(row, run)` for solid runs of a layer.
    template <class Visit>
    void solid_runs(int k, const Visit& visit) const {
        const SlicedLayer layer = slicer_.layer(k);
        for (const MaterialImage& m : layer.images) {
            for (int row = m.image.first_row(); row < m.image.end_row(); ++row) {
                for (const Run& run : m.image.row(row)) {
                    if (run.value >= solid_value) visit(row, run);
                }
            }
        }
    }

    void lay_cells() {
        int left = raster_.width_px, right = 0, top = raster_.height_px, bottom = 0;
        cells_.layer_count = slicer_.layer_count();
        const int stride = std::max(1, cells_.layer_count / 200);
        for (int k = 0; k < cells_.layer_count; k += stride) {
            solid_runs(k, [&](int row, const Run& run) {
                left = std::min<int>(left, run.begin);
                right = std::max<int>(right, run.end);
                top = std::min(top, row);
                bottom = std::max(bottom, row + 1);
            });
        }
        const double height_um = layers_.top_um(cells_.layer_count - 1);
        constexpr double most_cells = 60e6;
        cells_.edge_px = std::max(1, static_cast<int>(wanted_.wall_um / 10 / raster_.pixel_um));
        for (;; ++cells_.edge_px) {
            const double edge_um = cells_.edge_px * raster_.pixel_um;
            cells_.height_um = height_of(edge_um);
            cells_.grid = {std::max(0, right - left) / cells_.edge_px + 1,
                           std::max(0, bottom - top) / cells_.edge_px + 1,
                           static_cast<int>(height_um / cells_.height_um) + 1};
            if (static_cast<double>(cells_.grid.size()) <= most_cells) break;
        }
        cells_.left_px = std::min(left, right);
        cells_.top_px = std::min(top, bottom);
    }

    /// Of a cell: about its edge, but whole layers if all are of one thickness, and no less than the thickest.
    [[nodiscard]] double height_of(double edge_um) const {
        constexpr double rounding = 1e-6;
        int thickest_um = layers_.thickness_um(0);
        for (int k = 0; k < cells_.layer_count; ++k) thickest_um = std::max(thickest_um, layers_.thickness_um(k));
        if (layers_.alike()) return thickest_um * std::max(1.0, std::ceil(edge_um / thickest_um - rounding));
        return std::max<double>(edge_um, thickest_um);
    }

    /// A cell is solid if every pixel of every layer that reaches into it is. One that the part's top ends in is not.
    Status fill_solid(Progress& progress) {
        const CellGrid& g = cells_.grid;
        solid_.assign(g.size(), 0);
        std::vector<std::vector<int>> layers_of(static_cast<std::size_t>(g.nz));
        for (int k = 0; k < cells_.layer_count; ++k) {
            const Slabs slabs = cells_.slabs_of(layers_, k);
            for (int z = slabs.first; z <= slabs.last; ++z) layers_of[static_cast<std::size_t>(z)].push_back(k);
        }
        constexpr double rounding_um = 1e-3;
        const int top_um = layers_.top_um(cells_.layer_count - 1);
        if (g.nz * cells_.height_um > top_um + rounding_um) layers_of.back().clear();
        constexpr std::size_t batch = layers_at_once;
        for (std::size_t first = 0; first < layers_of.size(); first += batch) {
            if (progress.cancelled()) return cancelled();
            progress.advance("hollow", static_cast<double>(first) / static_cast<double>(layers_of.size()));
            parallel_for(std::min(batch, layers_of.size() - first), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t z = first + begin; z < first + end; ++z) fill_slab(z, layers_of[z]);
            });
        }
        return {};
    }

    void fill_slab(std::size_t z, const std::vector<int>& layers) {
        std::vector<int> count(static_cast<std::size_t>(cells_.grid.nx) * static_cast<std::size_t>(cells_.grid.ny));
        for (const int k : layers) count_pixels(k, count);
        const int all = cells_.edge_px * cells_.edge_px * static_cast<int>(layers.size());
        for (std::size_t i = 0; i < count.size(); ++i)
            solid_[z * count.size() + i] = all > 0 && count[i] == all ? 1 : 0;
    }

    void count_pixels(int k, std::vector<int>& count) const {
        const CellGrid& g = cells_.grid;
        solid_runs(k, [&](int row, const Run& run) {
            const int y = (row - cells_.top_px) / cells_.edge_px;
            if (row < cells_.top_px || y >= g.ny) return;
            for (int at = std::max<int>(run.begin, cells_.left_px); at < run.end;) {
                const int x = (at - cells_.left_px) / cells_.edge_px;
                if (x >= g.nx) break;
                const int end = std::min<int>(run.end, cells_.left_px + (x + 1) * cells_.edge_px);
                count[static_cast<std::size_t>(y) * g.nx + x] += end - at;
                at = end;
            }
        });
    }

    /// A cell is hollow if the way from its border to that of any cell that is not solid is as long as the wall, in
    /// every direction: the way between the centres of this cell and a neighbour of that one.
    void mark_hollow() {
        constexpr double rounding = 1e-5;
        const double edge_um = cells_.edge_px * raster_.pixel_um;
        const double least = wanted_.wall_um / edge_um * (1 - rounding);
        const std::vector<float> squares =
            squared_distances(cells_.grid, surrounded(cells_.grid, solid_), cells_.height_um / edge_um);
        hollow_.assign(squares.size(), 0);
        for (std::size_t i = 0; i < squares.size(); ++i) hollow_[i] = squares[i] >= least * least ? 1 : 0;
    }

    /// What the cavities take from the layers.
    [[nodiscard]] double volume_mm3() const {
        const CellGrid& g = cells_.grid;
        const double cell_mm2 = std::pow(cells_.edge_px * raster_.pixel_um / 1000, 2);
        double volume = 0;
        for (int k = 0; k < cells_.layer_count; ++k) {
            const Slabs slabs = cells_.slabs_of(layers_, k);
            long taken = 0;
            for (int y = 0; y < g.ny; ++y) {
                for (int x = 0; x < g.nx; ++x) taken += cells_.takes(hollow_, x, y, slabs) ? 1 : 0;
            }
            volume += cell_mm2 * static_cast<double>(taken) * layers_.thickness_um(k) / 1000;
        }
        return volume;
    }

    struct Cell {
        int x, y, z;
    };

    std::vector<Drain> find_cavities(Hollowing& result) {
        std::vector<Drain> drains;
        std::vector<std::uint8_t> seen(hollow_.size(), 0);
        const CellGrid& g = cells_.grid;
        for (int z = 0; z < g.nz; ++z) {
            for (int y = 0; y < g.ny; ++y) {
                for (int x = 0; x < g.nx; ++x) {
                    if (hollow_[g.at(x, y, z)] == 0 || seen[g.at(x, y, z)] != 0) continue;
                    const std::vector<Cell> cavity = flood({x, y, z}, seen);
                    ++result.cavities;
                    if (wanted_.drain_um > 0) drill(cavity, drains, result);
                }
            }
        }
        return drains;
    }

    std::vector<Cell> flood(Cell start, std::vector<std::uint8_t>& seen) const {
        const CellGrid& g = cells_.grid;
        std::vector<Cell> cells{start};
        seen[g.at(start.x, start.y, start.z)] = 1;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const Cell c = cells[i];
            for (const Cell& n : {Cell{c.x - 1, c.y, c.z}, Cell{c.x + 1, c.y, c.z}, Cell{c.x, c.y - 1, c.z},
                                  Cell{c.x, c.y + 1, c.z}, Cell{c.x, c.y, c.z - 1}, Cell{c.x, c.y, c.z + 1}}) {
                if (!g.has(n.x, n.y, n.z) || hollow_[g.at(n.x, n.y, n.z)] == 0 || seen[g.at(n.x, n.y, n.z)] != 0)
                    continue;
                seen[g.at(n.x, n.y, n.z)] = 1;
                cells.push_back(n);
            }
        }
        return cells;
    }

    void drill(const std::vector<Cell>& cavity, std::vector<Drain>& drains, Hollowing& result) const {
        const auto [low, high] =
            std::minmax_element(cavity.begin(), cavity.end(), [](const Cell& l, const Cell& r) { return l.z < r.z; });
        const double bottom_um = low->z * cells_.height_um, top_um = (high->z + 1) * cells_.height_um;
        if (top_um - bottom_um < wanted_.drain_um) {
            result.warnings.push_back(fmt::format("a cavity {:.3g} mm high is too low for a drain of {:.3g} mm",
                                                  (top_um - bottom_um) / 1000, wanted_.drain_um / 1000));
            return;
        }
        for (const bool at_top : {false, true}) {
            const double z_um = at_top ? top_um - wanted_.drain_um / 2 : bottom_um + wanted_.drain_um / 2;
            const int z = std::clamp(static_cast<int>(z_um / cells_.height_um), low->z, high->z);
            if (const auto drain = shortest(cavity, (at_top ? high : low)->z, z, z_um)) drains.push_back(*drain);
        }
    }

    /// The shortest way out, at slab `z`, from directly above or below the cavity's cells in slab `end`, so that the
    /// hole reaches the end of the cavity however narrow that is.
    [[nodiscard]] std::optional<Drain> shortest(const std::vector<Cell>& cavity, int end, int z, double z_um) const {
        const CellGrid& g = cells_.grid;
        std::optional<Drain> best;
        int least = INT32_MAX;
        for (const Cell& c : cavity) {
            if (c.z != end) continue;
            for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
                int n = 1;
                while (g.has(c.x + n * dx, c.y + n * dy, z) && solid_[g.at(c.x + n * dx, c.y + n * dy, z)] != 0) ++n;
                if (n >= least) continue;
                least = n;
                const int from = dx != 0 ? c.x : c.y, to = from + (dx + dy) * (n + 2);
                const int origin = dx != 0 ? cells_.left_px : cells_.top_px;
                const int across =
                    dx != 0 ? cells_.top_px + c.y * cells_.edge_px : cells_.left_px + c.x * cells_.edge_px;
                best = Drain{z_um, across + cells_.edge_px / 2.0, origin + std::min(from, to) * cells_.edge_px,
                             origin + (std::max(from, to) + 1) * cells_.edge_px, dx != 0};
            }
        }
        return best;
    }

    const Slicer& slicer_;
    HollowSettings wanted_;
    Raster raster_;
    Layers layers_;
    Cells cells_;
    std::vector<std::uint8_t> solid_, hollow_;
};

}  // namespace

Status check(const HollowSettings& hollow) {
    constexpr double most_um = 100000;
    if (!(hollow.wall_um > 0 && hollow.wall_um <= most_um))
        return input_error("hollow: wall of {:.6g} um: must be above 0 and at most 100 mm", hollow.wall_um);
    if (!(hollow.drain_um >= 0 && hollow.drain_um <= most_um))
        return input_error("hollow: drain of {:.6g} um: must be 0 to 100 mm", hollow.drain_um);
    return {};
}

Result<Hollowing> hollow_out(std::span<const Body> part, const Settings& settings, const HollowSettings& hollow,
                             Progress& progress) {
    if (auto status = check(hollow); !status) return tl::unexpected(status.error());
    Settings plain = settings;
    plain.bonds.clear();
    plain.compensation.clear();
    plain.removed = nullptr;
    const auto slicer = Slicer::prepare(part, plain);
    if (!slicer) return tl::unexpected(slicer.error());
    return Hollower(*slicer, hollow).run(progress);
}

}  // namespace pliant::slice

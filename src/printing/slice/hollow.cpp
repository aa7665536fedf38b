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

/// The way of a hole: from a cavity along rows or columns of the image.
struct DrainWay {
    double z_um = 0;       ///< of its axis
    double across_px = 0;  ///< of its axis: the row of a hole along rows, else the column
    int start_px = 0;      ///< the first pixel, in the cavity
    int step = 1;          ///< 1 or -1
    int most_px = 0;       ///< pixels that it may take of a line
    bool along_rows = false;
};

class CavityRemoval final : public Removal {
public:
    CavityRemoval(const Raster& raster, Layers layers, Cells cells, std::vector<std::uint8_t> hollow,
                  std::vector<RunSet> holes)
        : raster_(raster),
          layers_(std::move(layers)),
          cells_(cells),
          hollow_(std::move(hollow)),
          holes_(std::move(holes)) {}

    [[nodiscard]] RunSet at(int layer) const override {
        RunSet removed = cavity(layer);
        const auto k = static_cast<std::size_t>(layer);
        if (k < holes_.size() && !holes_[k].empty()) removed = united(removed, holes_[k]);
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

    Raster raster_;
    Layers layers_;
    Cells cells_;
    std::vector<std::uint8_t> hollow_;
    std::vector<RunSet> holes_;  ///< by layer; empty if there is none
};

class Hollower {
public:
    /// `slicer`: of the part as drawn; `grown_um`: how far its outlines are moved outwards when it is printed.
    Hollower(const Slicer& slicer, const HollowSettings& wanted, double grown_um)
        : slicer_(slicer),
          wanted_(wanted),
          grown_um_(grown_um),
          raster_(slicer.settings().raster),
          layers_(slicer.layers()) {}

    Result<Hollowing> run(Progress& progress) {
        lay_cells();
        if (Status status = fill_solid(progress); !status) return tl::unexpected(status.error());
        mark_hollow();
        if (wanted_.drain_um > 0) mark_outside();
        Hollowing result;
        const std::vector<DrainWay> ways = find_cavities(result);
        result.volume_mm3 = volume_mm3();
        if (result.volume_mm3 == 0)
            return input_error("hollow: nothing of the part lies {:.4g} mm deep inside of it", wanted_.wall_um / 1000);
        result.drains = static_cast<int>(ways.size());
        auto holes = make_holes(ways, progress);
        if (!holes) return tl::unexpected(holes.error());
        result.removed =
            std::make_shared<CavityRemoval>(raster_, layers_, cells_, std::move(hollow_), std::move(*holes));
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
        if (wanted_.drain_um > 0) air_.assign(g.size(), 0);
        std::vector<std::vector<int>> layers_of(static_cast<std::size_t>(g.nz));
        for (int k = 0; k < cells_.layer_count; ++k) {
            const Slabs slabs = cells_.slabs_of(layers_, k);
            for (int z = slabs.first; z <= slabs.last; ++z) layers_of[static_cast<std::size_t>(z)].push_back(k);
        }
        constexpr double rounding_um = 1e-3;
        const int top_um = layers_.top_um(cells_.layer_count - 1);
        const bool whole = g.nz * cells_.height_um <= top_um + rounding_um;
        constexpr std::size_t batch = layers_at_once;
        for (std::size_t first = 0; first < layers_of.size(); first += batch) {
            if (progress.cancelled()) return cancelled();
            progress.advance("hollow", static_cast<double>(first) / static_cast<double>(layers_of.size()));
            parallel_for(std::min(batch, layers_of.size() - first), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t z = first + begin; z < first + end; ++z)
                    fill_slab(z, layers_of[z], whole || z + 1 < layers_of.size());
            });
        }
        return {};
    }

    /// `whole`: the layers fill the slab.
    void fill_slab(std::size_t z, const std::vector<int>& layers, bool whole) {
        std::vector<int> count(static_cast<std::size_t>(cells_.grid.nx) * static_cast<std::size_t>(cells_.grid.ny));
        for (const int k : layers) count_pixels(k, count);
        const int all = whole ? cells_.edge_px * cells_.edge_px * static_cast<int>(layers.size()) : 0;
        for (std::size_t i = 0; i < count.size(); ++i) {
            solid_[z * count.size() + i] = all > 0 && count[i] == all ? 1 : 0;
            if (!air_.empty()) air_[z * count.size() + i] = count[i] == 0 ? enclosed : 0;
        }
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

    /// Marks the air that reaches the border of the grid. Cells in part filled do not join it: through them it would
    /// leak into voids behind thin walls.
    void mark_outside() {
        const CellGrid& g = cells_.grid;
        std::vector<Cell> reached;
        const auto reach = [&](int x, int y, int z) {
            if (!g.has(x, y, z) || air_[g.at(x, y, z)] != enclosed) return;
            air_[g.at(x, y, z)] = outside_air;
            reached.push_back({x, y, z});
        };
        for (int z = 0; z < g.nz; ++z) {
            for (int y = 0; y < g.ny; ++y) {
                const bool whole_row = z == 0 || z == g.nz - 1 || y == 0 || y == g.ny - 1;
                for (int x = 0; x < g.nx; x += whole_row ? 1 : std::max(1, g.nx - 1)) reach(x, y, z);
            }
        }
        while (!reached.empty()) {
            const Cell c = reached.back();
            reached.pop_back();
            for (const int step : {-1, 1}) {
                reach(c.x + step, c.y, c.z);
                reach(c.x, c.y + step, c.z);
                reach(c.x, c.y, c.z + step);
            }
        }
    }

    std::vector<DrainWay> find_cavities(Hollowing& result) {
        std::vector<DrainWay> drains;
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

    void drill(const std::vector<Cell>& cavity, std::vector<DrainWay>& drains, Hollowing& result) const {
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
            if (const auto way = shortest(cavity, (at_top ? high : low)->z, z_um))
                drains.push_back(*way);
            else
                result.warnings.push_back(
                    fmt::format("a cavity from {:.3g} to {:.3g} mm gets no drain at its {}: no way along x or y leads "
                                "from there out of the part",
                                bottom_um / 1000, top_um / 1000, at_top ? "top" : "bottom"));
        }
    }

    /// Cells from a line's first one to the end of the part.
    struct WayOut {
        int cells = 0;
        bool out = false;  ///< ends in the outside air, not in a void of the part or at another wall
    };
    [[nodiscard]] WayOut way_out(Cell c, int dx, int dy, int most) const {
        const CellGrid& g = cells_.grid;
        bool left_wall = false;
        for (int n = 1; n <= most; ++n) {
            c = {c.x + dx, c.y + dy, c.z};
            if (!g.has(c.x, c.y, c.z) || air_[g.at(c.x, c.y, c.z)] == outside_air) return {n, true};
            if (air_[g.at(c.x, c.y, c.z)] == enclosed) return {n, false};
            const bool solid = solid_[g.at(c.x, c.y, c.z)] != 0;
            if (solid && left_wall) return {n, false};
            left_wall = !solid;
        }
        return {most, false};
    }

    [[nodiscard]] int slab_of(double z_um) const {
        return std::clamp(static_cast<int>(z_um / cells_.height_um), 0, cells_.grid.nz - 1);
    }

    /// Where walls slope, the lines of a hole leave the part at different places. A line that runs on by more than this
    /// lies in another limb.
    [[nodiscard]] int most_slope() const {
        constexpr double diameters = 2;
        return static_cast<int>(std::ceil(diameters * wanted_.drain_um / (cells_.edge_px * raster_.pixel_um)));
    }

    /// The length of the whole hole from a cell at the end of the cavity, in cells: that of its longest line, of the
    /// axis and of eight around it. Nothing if the axis does not lead out, or the hole is no shorter than `least`.
    [[nodiscard]] std::optional<int> length(const Cell& from, int dx, int dy, double z_um, int least,
                                            int axis_cells) const {
        constexpr double inside = 0.98, diagonal = 0.7;  // of the radius: within the hole
        const double radius_um = inside * wanted_.drain_um / 2;
        const int most = axis_cells + most_slope();
        int longest = axis_cells;
        for (const int up : {-1, 0, 1}) {
            for (const int aside : {-1, 0, 1}) {
                const double r_um = radius_um * (up != 0 && aside != 0 ? diagonal : 1);
                const int shift = static_cast<int>(std::lround(aside * r_um / (cells_.edge_px * raster_.pixel_um)));
                const Cell start{from.x + (dx != 0 ? 0 : shift), from.y + (dx != 0 ? shift : 0),
                                 slab_of(z_um + up * r_um)};
                const WayOut way = way_out(start, dx, dy, most);
                longest = std::max(longest, way.out ? way.cells : most);
                if (longest >= least) return std::nullopt;
            }
        }
        return longest;
    }

    /// The shortest hole that leads out, with its axis at `z_um`, from directly above or below the cavity's cells in
    /// slab `end`, so that it reaches the end of the cavity however narrow that is.
    [[nodiscard]] std::optional<DrainWay> shortest(const std::vector<Cell>& cavity, int end, double z_um) const {
        const CellGrid& g = cells_.grid;
        std::optional<DrainWay> best;
        int least = INT32_MAX;
        for (const Cell& c : cavity) {
            if (c.z != end) continue;
            for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
                // From the next cell of the cavity the same way is shorter.
                if (g.has(c.x + dx, c.y + dy, c.z) && hollow_[g.at(c.x + dx, c.y + dy, c.z)] != 0) continue;
                const WayOut axis = way_out({c.x, c.y, slab_of(z_um)}, dx, dy, least);
                if (!axis.out || axis.cells >= least) continue;
                const std::optional<int> cells = length(c, dx, dy, z_um, least, axis.cells);
                if (!cells) continue;
                least = *cells;
                best = way_from(c, dx, dy, z_um, axis.cells);
            }
        }
        return best;
    }

    [[nodiscard]] DrainWay way_from(const Cell& c, int dx, int dy, double z_um, int axis_cells) const {
        const int edge = cells_.edge_px, x_px = cells_.left_px + c.x * edge, y_px = cells_.top_px + c.y * edge;
        const int step = dx + dy;
        const int start_px = (dx != 0 ? x_px : y_px) + (step > 0 ? 0 : edge - 1);
        return {z_um, (dx != 0 ? y_px : x_px) + edge / 2.0,   start_px,
                step, (axis_cells + 1 + most_slope()) * edge, dx != 0};
    }

    Result<std::vector<RunSet>> make_holes(const std::vector<DrainWay>& ways, Progress& progress) const {
        std::vector<RunSet> holes;
        if (ways.empty()) return holes;
        holes.resize(static_cast<std::size_t>(cells_.layer_count));
        constexpr std::size_t batch = layers_at_once;
        for (std::size_t first = 0; first < holes.size(); first += batch) {
            if (progress.cancelled()) return cancelled();
            parallel_for(std::min(batch, holes.size() - first), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t k = first + begin; k < first + end; ++k)
                    holes[k] = holes_in(static_cast<int>(k), ways);
            });
        }
        return holes;
    }

    [[nodiscard]] RunSet holes_in(int k, const std::vector<DrainWay>& ways) const {
        const double radius_um = wanted_.drain_um / 2;
        RunSet holes(raster_.width_px, raster_.height_px), lit;
        for (const DrainWay& way : ways) {
            const double up_um = layers_.middle2_um(k) / 2.0 - way.z_um;
            if (std::fabs(up_um) >= radius_um) continue;
            if (lit.width_px() == 0) lit = lit_pixels(k);
            holes = united(holes, hole(way, k, std::sqrt(radius_um * radius_um - up_um * up_um), lit));
        }
        return holes;
    }

    [[nodiscard]] RunSet lit_pixels(int k) const {
        RunSet lit(raster_.width_px, raster_.height_px);
        const SlicedLayer layer = slicer_.layer(k);
        for (const MaterialImage& m : layer.images) lit = united(lit, RunSet::lit(m.image));
        return lit;
    }

    /// A part of the image.
    struct Window {
        PixelSpan columns, rows;
        std::vector<std::uint8_t> pixels;

        [[nodiscard]] std::size_t at(int column, int row) const {
            return static_cast<std::size_t>(row - rows.begin) * static_cast<std::size_t>(columns.end - columns.begin) +
                   static_cast<std::size_t>(column - columns.begin);
        }
    };

    /// What the hole takes from a layer: of every line the pixels up to the end of the part, and what they are grown
    /// by.
    [[nodiscard]] RunSet hole(const DrainWay& way, int k, double half_um, const RunSet& lit) const {
        const int along_px = way.along_rows ? raster_.width_px : raster_.height_px;
        const int across_px = way.along_rows ? raster_.height_px : raster_.width_px;
        const double half = half_um / raster_.pixel_um;
        const int far_px = way.start_px + way.step * (way.most_px - 1);
        const PixelSpan along{std::max(0, std::min(way.start_px, far_px)),
                              std::min(along_px, std::max(way.start_px, far_px) + 1)};
        const PixelSpan across{std::max(0, static_cast<int>(std::lround(way.across_px - half))),
                               std::min(across_px, static_cast<int>(std::lround(way.across_px + half)))};
        if (along.begin >= along.end || across.begin >= across.end) return {raster_.width_px, raster_.height_px};
        Window window{way.along_rows ? along : across, way.along_rows ? across : along, {}};
        window.pixels.assign(
            static_cast<std::size_t>(along.end - along.begin) * static_cast<std::size_t>(across.end - across.begin), 0);
        for (int row = window.rows.begin; row < window.rows.end; ++row) {
            for (const PixelSpan& span : lit.row(row)) {
                const int end = std::min(span.end, window.columns.end);
                for (int x = std::max(span.begin, window.columns.begin); x < end; ++x)
                    window.pixels[window.at(x, row)] = 1;
            }
        }
        for (int line = across.begin; line < across.end; ++line) cut_line(way, along, line, k, window);
        return set_of(window);
    }

    /// Leaves of a line of lit pixels those that the hole takes.
    void cut_line(const DrainWay& way, PixelSpan along, int line, int k, Window& window) const {
        const auto column = [&](int at) { return way.along_rows ? at : line; };
        const auto row = [&](int at) { return way.along_rows ? line : at; };
        const auto pixel = [&](int at) -> std::uint8_t& { return window.pixels[window.at(column(at), row(at))]; };
        const auto has = [&](int at) { return at >= along.begin && at < along.end; };
        int at = way.start_px;
        for (;;) {
            while (has(at) && pixel(at) != 0) at += way.step;
            bool is_void = false;
            int gap_px = 0;
            for (; has(at + gap_px * way.step) && pixel(at + gap_px * way.step) == 0; ++gap_px)
                is_void = is_void || in_void(column(at + gap_px * way.step), row(at + gap_px * way.step), k);
            if (!is_void) {
                const int grown = std::clamp(gap_px - grown_px(), 0, grown_px());
                for (int n = 0; n < grown; ++n, at += way.step) pixel(at) = 1;
                break;
            }
            at += gap_px * way.step;
        }
        for (; has(at); at += way.step) pixel(at) = 0;
    }

    /// Whether a pixel lies in a void of the part.
    [[nodiscard]] bool in_void(int column, int row, int k) const {
        const int x = (column - cells_.left_px) / cells_.edge_px, y = (row - cells_.top_px) / cells_.edge_px;
        if (column < cells_.left_px || row < cells_.top_px || x >= cells_.grid.nx || y >= cells_.grid.ny) return false;
        const Slabs slabs = cells_.slabs_of(layers_, k);
        for (int z = slabs.first; z <= slabs.last; ++z) {
            if (air_[cells_.grid.at(x, y, z)] == enclosed) return true;
        }
        return false;
    }

    [[nodiscard]] int grown_px() const { return static_cast<int>(std::ceil(grown_um_ / raster_.pixel_um)); }

    [[nodiscard]] RunSet set_of(const Window& window) const {
        RunSet set(raster_.width_px, raster_.height_px);
        for (int row = window.rows.begin; row < window.rows.end; ++row) {
            std::vector<PixelSpan> spans;
            for (int x = window.columns.begin; x < window.columns.end; ++x) {
                if (window.pixels[window.at(x, row)] == 0) continue;
                if (!spans.empty() && spans.back().end == x)
                    spans.back().end = x + 1;
                else
                    spans.push_back({x, x + 1});
            }
            set.append_row(row, std::move(spans));
        }
        return set;
    }

    static constexpr std::uint8_t enclosed = 1, outside_air = 2;

    const Slicer& slicer_;
    HollowSettings wanted_;
    double grown_um_;
    Raster raster_;
    Layers layers_;
    Cells cells_;
    std::vector<std::uint8_t> solid_, hollow_;
    std::vector<std::uint8_t> air_;  ///< cells without any material; empty if there are no drains
};

}  // namespace

Status check(const HollowSettings& hollow) {
    if (!(hollow.wall_um > 0 && hollow.wall_um <= most_hollow_um))
        return input_error("hollow: wall of {:.6g} um: must be above 0 and at most 100 mm", hollow.wall_um);
    if (!(hollow.drain_um >= 0 && hollow.drain_um <= most_hollow_um))
        return input_error("hollow: drain of {:.6g} um: must be 0 to 100 mm", hollow.drain_um);
    return {};
}

Result<Hollowing> hollow_out(std::span<const Body> part, const Settings& settings, const HollowSettings& hollow,
                             Progress& progress) {
    if (auto status = check(hollow); !status) return tl::unexpected(status.error());
    double grown_um = 0;
    for (const auto& [material, own] : settings.compensation) grown_um = std::max(grown_um, own.grow_um);
    Settings plain = settings;
    plain.bonds.clear();
    plain.compensation.clear();
    plain.teeth.clear();  // they may name the material of supports, which come later
    plain.removed = nullptr;
    const auto slicer = Slicer::prepare(part, plain);
    if (!slicer) return tl::unexpected(slicer.error());
    return Hollower(*slicer, hollow, grown_um).run(progress);
}

}  // namespace pliant::slice

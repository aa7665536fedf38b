#include "slice/inspect.hpp"

#include <algorithm>
#include <set>

namespace pliant::slice {
namespace {

/// Calls `meet(a, b)` for stretches of two rows that share a column.
template <class Meet>
void overlaps(std::span<const Stretch> above, std::span<const Stretch> below, const Meet& meet) {
    for (auto a = above.begin(), b = below.begin(); a != above.end() && b != below.end();) {
        if (a->begin < b->end && b->begin < a->end) meet(*a, *b);
        if (a->end < b->end) {
            ++a;
        } else {
            ++b;
        }
    }
}

/// Where a pixel's centre lies on the platform, without turns, offsets and mirrors: in the image as it is seen.
std::string place(const Raster& raster, int row, int column) {
    return fmt::format("row {}, column {} ({:.2f} mm, {:.2f} mm from the image's centre)", row, column,
                       (column + 0.5 - raster.width_px / 2.0) * raster.pixel_um / 1000,
                       (raster.height_px / 2.0 - row - 0.5) * raster.pixel_um / 1000);
}

}  // namespace

std::uint32_t Inspector::root(std::vector<Thing>& things, std::uint32_t i) {
    while (things[i].parent != i) i = things[i].parent = things[things[i].parent].parent;
    return i;
}

/// The smaller root stays.
std::uint32_t Inspector::join(std::vector<Thing>& things, std::uint32_t a, std::uint32_t b) {
    a = root(things, a);
    b = root(things, b);
    if (a == b) return a;
    if (a > b) std::swap(a, b);
    things[b].parent = a;
    if (things[b].first_layer < things[a].first_layer) {
        things[a].first_layer = things[b].first_layer;
        things[a].row = things[b].row;
        things[a].column = things[b].column;
    }
    things[a].last_layer = std::max(things[a].last_layer, things[b].last_layer);
    things[a].voxels += things[b].voxels;
    things[a].volume += things[b].volume;
    return a;
}

void Inspector::add(LayerShape shape) {
    const auto number = [&](std::vector<Thing>& things, const PieceMap& map, const std::vector<int>& rows,
                            const std::vector<int>& columns, std::size_t known) {
        std::vector<std::uint32_t> ids(std::min(known, map.pixels.size()), 0);
        for (std::size_t p = ids.size(); p < map.pixels.size(); ++p) {
            ids.push_back(static_cast<std::uint32_t>(things.size()));
            things.push_back({ids.back(), layer_, layer_, map.pixels[p], map.pixels[p] * layers_.thickness_um(layer_),
                              rows[p], columns[p]});
        }
        return ids;
    };
    const std::vector<std::uint32_t> solids = number(solids_, shape.solid, shape.solid_row, shape.solid_column, 0);
    const std::vector<std::uint32_t> voids = number(voids_, shape.voids, shape.void_row, shape.void_column, 1);
    link_solid(shape, solids);
    if (layer_ > 0) link_voids(shape, voids);
    if (shape.faint && !shape.voids.starts.empty()) findings_.faint_layers.push_back(layer_);
    below_ = std::move(shape);
    solid_below_ = solids;
    voids_below_ = voids;
    ++layer_;
}

void Inspector::link_solid(const LayerShape& shape, const std::vector<std::uint32_t>& ids) {
    std::vector<bool> held(ids.size(), layer_ == 0);
    for (int row = shape.solid.first_row; row < shape.solid.first_row + shape.solid.rows(); ++row) {
        overlaps(shape.solid.row(row), below_.solid.row(row), [&](const Stretch& a, const Stretch& b) {
            held[a.piece] = true;
            join(solids_, ids[a.piece], solid_below_[b.piece]);
        });
    }
    for (std::size_t p = 0; p < held.size(); ++p) {
        if (!held[p])
            findings_.islands.push_back({layer_, shape.solid_row[p], shape.solid_column[p], shape.solid.pixels[p]});
    }
}

void Inspector::link_voids(const LayerShape& shape, const std::vector<std::uint32_t>& ids) {
    const PieceMap &here = shape.voids, &below = below_.voids;
    const Stretch all{0, UINT16_MAX, 0};
    const std::span<const Stretch> outside(&all, 1);
    const int first =
        std::min(here.rows() > 0 ? here.first_row : INT32_MAX, below.rows() > 0 ? below.first_row : INT32_MAX);
    const int end = std::max(here.rows() > 0 ? here.first_row + here.rows() : 0,
                             below.rows() > 0 ? below.first_row + below.rows() : 0);
    const auto inside = [](const PieceMap& map, int row) {
        return row >= map.first_row && row < map.first_row + map.rows();
    };
    for (int row = first; row < end; ++row) {
        const bool h = inside(here, row), b = inside(below, row);
        overlaps(h ? here.row(row) : outside, b ? below.row(row) : outside, [&](const Stretch& x, const Stretch& y) {
            join_voids(h ? ids[x.piece] : 0, b ? voids_below_[y.piece] : 0);
        });
    }
}

/// A void that was closed until this layer and opens in it was a suction cup.
void Inspector::join_voids(std::uint32_t a, std::uint32_t b) {
    a = root(voids_, a);
    b = root(voids_, b);
    if (a == b) return;
    const std::uint32_t closed = std::max(a, b);
    if (std::min(a, b) == 0 && voids_[closed].first_layer < layer_)
        findings_.cavities.push_back({voids_[closed].first_layer, layer_ - 1, voids_[closed].voxels,
                                      voids_[closed].volume, voids_[closed].row, voids_[closed].column,
                                      Cavity::End::opened});
    join(voids_, a, b);
}

Findings Inspector::finish(std::int64_t least_voxels) {
    for (std::uint32_t i = 1; i < voids_.size(); ++i) {
        if (voids_[i].parent != i) continue;
        const bool open = voids_[i].last_layer == layer_ - 1;
        findings_.cavities.push_back({voids_[i].first_layer, voids_[i].last_layer, voids_[i].voxels, voids_[i].volume,
                                      voids_[i].row, voids_[i].column,
                                      open ? Cavity::End::last_layer : Cavity::End::closed});
    }
    for (std::uint32_t i = 0; i < solids_.size(); ++i) {
        if (solids_[i].parent == i)
            findings_.pieces.push_back({solids_[i].first_layer, solids_[i].last_layer, solids_[i].voxels});
    }
    std::erase_if(findings_.cavities, [&](const Cavity& c) { return c.voxels < least_voxels; });
    std::stable_sort(findings_.cavities.begin(), findings_.cavities.end(),
                     [](const Cavity& l, const Cavity& r) { return l.voxels > r.voxels; });
    return std::move(findings_);
}

std::vector<std::string> describe(const Findings& findings, const Raster& raster) {
    std::vector<std::string> lines;
    const double pixel_mm2 = raster.pixel_um * raster.pixel_um / 1e6;
    if (!findings.islands.empty()) {
        const auto& largest = *std::max_element(findings.islands.begin(), findings.islands.end(),
                                                [](const Island& l, const Island& r) { return l.pixels < r.pixels; });
        std::set<int> layers;
        for (const Island& island : findings.islands) layers.insert(island.layer);
        lines.push_back(fmt::format(
            "{} islands begin in mid-air, in {} layers from {} to {}; the largest, {:.4g} mm^2 in layer {}, at {}",
            findings.islands.size(), layers.size(), *layers.begin(), *layers.rbegin(),
            static_cast<double>(largest.pixels) * pixel_mm2, largest.layer,
            place(raster, largest.row, largest.column)));
    }
    constexpr std::size_t most_lines = 5;
    for (std::size_t i = 0; i < std::min(findings.cavities.size(), most_lines); ++i) {
        const Cavity& c = findings.cavities[i];
        const char* what = c.end == Cavity::End::closed   ? "resin trap, closed for good"
                           : c.end == Cavity::End::opened ? "suction cup, which opens in the layer after"
                                                          : "suction cup, open at the part's last layer only";
        lines.push_back(fmt::format("cavity of {:.4g} mm^3 in layers {} to {}: {}",
                                    static_cast<double>(c.volume) / 1000 * pixel_mm2, c.first_layer, c.last_layer,
                                    what));
    }
    if (findings.cavities.size() > most_lines)
        lines.push_back(fmt::format("{} smaller cavities", findings.cavities.size() - most_lines));
    if (!findings.faint_layers.empty())
        lines.push_back(fmt::format("{} layers hold only features thinner than half a pixel, the first is layer {}",
                                    findings.faint_layers.size(), findings.faint_layers.front()));
    return lines;
}

}  // namespace pliant::slice

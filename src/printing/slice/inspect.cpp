#include "printing/slice/inspect.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "base/core/counted.hpp"
#include "printing/slice/layer_text.hpp"

namespace pliant::slice {
namespace {

/// Calls `meet(a, b)` for stretches of two rows with a common column.
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

/// Position of a pixel's centre on the platform in image orientation, without rotation, offset and mirroring.
std::string place(const Raster& raster, int row, int column) {
    return fmt::format("row {}, column {} ({:.2f} mm, {:.2f} mm from the image's centre)", row, column,
                       (column + 0.5 - raster.width_px / 2.0) * raster.pixel_um / 1000,
                       (raster.height_px / 2.0 - row - 0.5) * raster.pixel_um / 1000);
}

/// Combines two groups that have merged.
IslandGroup joined(const IslandGroup& a, const IslandGroup& b) {
    if (a.islands == 0 || b.islands == 0) return a.islands == 0 ? b : a;
    IslandGroup both = a.largest.pixels >= b.largest.pixels ? a : b;
    both.islands = a.islands + b.islands;
    both.first_layer = std::min(a.first_layer, b.first_layer);
    both.last_layer = std::max(a.last_layer, b.last_layer);
    both.most_pixels = std::max(a.most_pixels, b.most_pixels);
    both.voxels = a.voxels + b.voxels;
    return both;
}

/// Light of the next layers reaches down into the last one or two, so what these support mostly holds. The loss of a
/// few voxels goes unnoticed.
Severity severity_of(const IslandGroup& group, std::int64_t few_voxels) {
    constexpr int soon_layers = 2;
    if (group.held_layer < 0 || group.held_layer - group.first_layer > soon_layers) return Severity::high;
    return group.voxels > few_voxels ? Severity::medium : Severity::low;
}

constexpr std::size_t most_lines = 5;

std::string area_text(std::int64_t pixels, const Raster& raster) {
    return fmt::format("{:.4g} mm^2", static_cast<double>(pixels) * raster.pixel_um * raster.pixel_um / 1e6);
}

std::string group_text(const IslandGroup& g, const Raster& raster) {
    return fmt::format(
        "{} in mid-air in {}, {}: up to {}, at {}",
        g.islands == 1 ? "an island begins" : fmt::format("{} islands that grow together begin", g.islands),
        layer_text(g.first_layer),
        g.held_layer < 0 ? "and nothing ever holds it" : fmt::format("held from {} on", layer_text(g.held_layer)),
        area_text(g.most_pixels, raster), place(raster, g.largest.row, g.largest.column));
}

/// Summary of groups in one line: their number, the place of the first and of the largest.
std::string summary_text(std::span<const IslandGroup> groups, std::string_view what, const Raster& raster) {
    const auto by_area = [](const IslandGroup& l, const IslandGroup& r) { return l.most_pixels < r.most_pixels; };
    const auto by_layer = [](const IslandGroup& l, const IslandGroup& r) { return l.first_layer < r.first_layer; };
    const IslandGroup& largest = *std::max_element(groups.begin(), groups.end(), by_area);
    const auto [first, last] = std::minmax_element(groups.begin(), groups.end(), by_layer);
    std::size_t islands = 0;
    for (const IslandGroup& g : groups) islands += static_cast<std::size_t>(g.islands);
    return fmt::format("{} in mid-air{}, in {}; the largest, {} in {}, at {}", counted(islands, "island"), what,
                       layers_text(first->first_layer, last->first_layer), area_text(largest.most_pixels, raster),
                       layer_text(largest.largest.layer), place(raster, largest.largest.row, largest.largest.column));
}

/// The worst groups one by one, the others of each severity in one line.
void describe_islands(std::span<const IslandGroup> groups, const Raster& raster, std::vector<std::string>& lines) {
    const auto below = [&](Severity severity) {
        const auto end =
            std::find_if(groups.begin(), groups.end(), [&](const IslandGroup& g) { return g.severity < severity; });
        return static_cast<std::size_t>(end - groups.begin());
    };
    const std::size_t high = below(Severity::high), medium = below(Severity::medium);
    const std::size_t shown = std::min(high, most_lines);
    for (const IslandGroup& group : groups.first(shown)) lines.push_back(group_text(group, raster));
    const std::tuple<std::size_t, std::size_t, const char*> rest[] = {
        {shown, high, " besides"},
        {high, medium, ", held within two layers"},
        {medium, groups.size(), " of a few pixels, the grain of the raster"}};
    for (const auto& [begin, end, what] : rest) {
        if (begin < end) lines.push_back(summary_text(groups.subspan(begin, end - begin), what, raster));
    }
}

void describe_cavities(std::span<const Cavity> cavities, const Raster& raster, std::vector<std::string>& lines) {
    const double pixel_mm2 = raster.pixel_um * raster.pixel_um / 1e6;
    for (const Cavity& c : cavities.first(std::min(cavities.size(), most_lines))) {
        const char* what = c.end == Cavity::End::closed   ? "resin trap, closed for good"
                           : c.end == Cavity::End::opened ? "suction cup, which opens in the layer after"
                                                          : "suction cup, open at the part's last layer only";
        lines.push_back(fmt::format("cavity of {:.4g} mm^3 in {}: {}", static_cast<double>(c.volume) / 1000 * pixel_mm2,
                                    layers_text(c.first_layer, c.last_layer), what));
    }
    if (cavities.size() > most_lines)
        lines.push_back(fmt::format("{} smaller cavit{}", cavities.size() - most_lines,
                                    cavities.size() - most_lines == 1 ? "y" : "ies"));
}

}  // namespace

std::uint32_t Inspector::root(std::vector<Thing>& things, std::uint32_t i) {
    while (things[i].parent != i) i = things[i].parent = things[things[i].parent].parent;
    return i;
}

/// The smaller root is kept.
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
    std::vector<bool> on_solid(ids.size(), layer_ == 0);
    if (layer_ == 0) {
        for (const std::uint32_t id : ids) solids_[id].held = true;
    }
    for (int row = shape.solid.first_row; row < shape.solid.first_row + shape.solid.rows(); ++row) {
        overlaps(shape.solid.row(row), below_.solid.row(row), [&](const Stretch& a, const Stretch& b) {
            on_solid[a.piece] = true;
            join_solids(ids[a.piece], solid_below_[b.piece]);
        });
    }
    add_islands(shape, ids, on_solid);
}

/// A group ends when it meets something held.
void Inspector::join_solids(std::uint32_t a, std::uint32_t b) {
    a = root(solids_, a);
    b = root(solids_, b);
    if (a == b) return;
    const bool held = solids_[a].held || solids_[b].held;
    for (const std::uint32_t thing : {a, b}) {
        IslandGroup& group = solids_[thing].group;
        if (!held || group.islands == 0) continue;
        group.held_layer = layer_;
        findings_.groups.push_back(std::exchange(group, {}));
    }
    const IslandGroup group = joined(solids_[a].group, solids_[b].group);
    Thing& both = solids_[join(solids_, a, b)];
    both.group = group;
    both.held = held;
}

void Inspector::add_islands(const LayerShape& shape, const std::vector<std::uint32_t>& ids,
                            const std::vector<bool>& on_solid) {
    std::map<std::uint32_t, std::int64_t> loose_pixels;  // by thing
    for (std::size_t p = 0; p < ids.size(); ++p) {
        const Island island{layer_, shape.solid_row[p], shape.solid_column[p], shape.solid.pixels[p]};
        const std::uint32_t thing = root(solids_, ids[p]);
        if (!on_solid[p]) {
            findings_.islands.push_back(island);
            solids_[thing].group = {1, layer_, layer_, -1, island, 0, 0, Severity::high};
        }
        if (!solids_[thing].held) loose_pixels[thing] += island.pixels;
    }
    for (const auto& [thing, pixels] : loose_pixels) {
        IslandGroup& group = solids_[thing].group;
        group.most_pixels = std::max(group.most_pixels, pixels);
        group.voxels += pixels;
        group.last_layer = layer_;
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

/// A void that was closed up to this layer and now opens was a suction cup.
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
        if (solids_[i].parent != i) continue;
        findings_.pieces.push_back({solids_[i].first_layer, solids_[i].last_layer, solids_[i].voxels});
        if (solids_[i].group.islands > 0) findings_.groups.push_back(solids_[i].group);
    }
    for (IslandGroup& group : findings_.groups) group.severity = severity_of(group, least_voxels);
    std::stable_sort(findings_.groups.begin(), findings_.groups.end(), [](const IslandGroup& l, const IslandGroup& r) {
        return std::pair(l.severity, l.voxels) > std::pair(r.severity, r.voxels);
    });
    std::erase_if(findings_.cavities, [&](const Cavity& c) { return c.voxels < least_voxels; });
    std::stable_sort(findings_.cavities.begin(), findings_.cavities.end(),
                     [](const Cavity& l, const Cavity& r) { return l.voxels > r.voxels; });
    return std::move(findings_);
}

const char* severity_name(Severity severity) {
    switch (severity) {
        case Severity::low:
            return "low";
        case Severity::medium:
            return "medium";
        case Severity::high:
            return "high";
    }
    return "";
}

std::vector<std::string> describe(const Findings& findings, const Raster& raster) {
    std::vector<std::string> lines;
    describe_islands(findings.groups, raster, lines);
    describe_cavities(findings.cavities, raster, lines);
    if (!findings.faint_layers.empty())
        lines.push_back(fmt::format("{} hold{} only features thinner than half a pixel, the first is {}",
                                    counted(findings.faint_layers.size(), "layer"),
                                    findings.faint_layers.size() == 1 ? "s" : "",
                                    layer_text(findings.faint_layers.front())));
    return lines;
}

}  // namespace pliant::slice

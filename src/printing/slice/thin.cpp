#include "printing/slice/thin.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/core/counted.hpp"
#include "printing/slice/layer_shape.hpp"
#include "printing/slice/layer_text.hpp"
#include "printing/slice/run_set.hpp"

namespace pliant::slice {
namespace {

/// Pixels of at least half light.
RunSet solid(const RunImage& image) {
    constexpr int half_light = 128;
    RunImage bright(image.width_px(), image.height_px());
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        for (const Run& run : image.row(row)) {
            if (run.value >= half_light) bright.append(row, run.begin, run.end, 255);
        }
    }
    return RunSet::lit(bright);
}

constexpr int fine = 4;  // cells along the edge of a pixel

/// Pixels [begin, end) of one value, which may be 0.
struct Level {
    int begin = 0, end = 0;
    double value = 0;
};

/// The values between two rows, `share` of the way from the upper one to the lower, from the left to the right border.
std::vector<Level> levels_between(std::span<const Run> upper, std::span<const Run> lower, double share, int width) {
    std::vector<Level> levels;
    for (int at = -1; at <= width;) {
        int end = width + 1;
        double value = 0;
        for (const auto& [runs, weight] : {std::pair{&upper, 1 - share}, std::pair{&lower, share}}) {
            while (!runs->empty() && runs->front().end <= at) *runs = runs->subspan(1);
            if (runs->empty()) continue;
            const Run& run = runs->front();
            end = std::min<int>(end, run.begin > at ? run.begin : run.end);
            if (run.begin <= at) value += weight * run.value;
        }
        levels.push_back({at, end, value});
        at = end;
    }
    return levels;
}

/// The cells of a row that have at least half light, interpolated between the centres of pixels.
std::vector<PixelSpan> bright_cells(const std::vector<Level>& levels, int width) {
    constexpr double half_light = 127.5;
    std::vector<PixelSpan> spans;
    const auto add = [&](int begin, int end, double value) {
        begin = std::max(begin, 0);
        end = std::min(end, fine * width);
        if (value < half_light || begin >= end) return;
        if (!spans.empty() && spans.back().end == begin)
            spans.back().end = end;
        else
            spans.push_back({begin, end});
    };
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const Level& level = levels[i];
        const int last_centre = fine * (level.end - 1) + fine / 2;
        add(fine * level.begin + fine / 2, last_centre, level.value);
        const double next = i + 1 < levels.size() ? levels[i + 1].value : 0;
        for (int j = 0; j < fine; ++j)
            add(last_centre + j, last_centre + j + 1, level.value + (next - level.value) * (j + 0.5) / fine);
    }
    return spans;
}

/// The image in cells of a quarter of a pixel. The grey of a pixel tells where in it the outline is: so slanted walls
/// are as wide as they are drawn, not as their stairs of pixels.
RunSet solid_cells(const RunImage& image) {
    RunSet cells(fine * image.width_px(), fine * image.height_px());
    for (int row = image.first_row() - 1; row < image.end_row(); ++row) {
        for (int j = 0; j < fine; ++j) {
            const int cell_row = fine * row + fine / 2 + j;
            if (cell_row < 0 || cell_row >= cells.height_px()) continue;
            const auto levels = levels_between(image.row(row), image.row(row + 1), (j + 0.5) / fine, image.width_px());
            cells.append_row(cell_row, bright_cells(levels, image.width_px()));
        }
    }
    return cells;
}

/// Pixels whose centre is in one of the cells.
RunSet pixels_of(const RunSet& cells, int width, int height) {
    RunSet pixels(width, height);
    for (int row = cells.first_row() / fine; row < height && row * fine < cells.end_row(); ++row) {
        std::vector<PixelSpan> spans;
        for (const PixelSpan& span : cells.row(fine * row + fine / 2)) {
            const int begin = (span.begin + fine / 2 - 1) / fine, end = (span.end + fine / 2 - 1) / fine;
            if (begin >= end) continue;
            if (!spans.empty() && spans.back().end == begin)
                spans.back().end = end;
            else
                spans.push_back({begin, end});
        }
        pixels.append_row(row, std::move(spans));
    }
    return pixels;
}

/// One for each connected piece of a layer.
std::vector<ThinSpot> spots_of(const RunSet& thin, int layer, int material) {
    const PieceMap pieces = pieces_of(thin);
    std::vector<ThinSpot> spots;
    for (const std::int64_t pixels : pieces.pixels) spots.push_back({layer, layer, material, pixels, -1});
    for (int row = pieces.first_row; row < pieces.first_row + pieces.rows(); ++row) {
        for (const Stretch& s : pieces.row(row)) {
            ThinSpot& spot = spots[s.piece];
            if (spot.row < 0) {
                spot.row = spot.first_row = row;
                spot.column = spot.first_column = s.begin;
            }
            spot.end_row = row + 1;
            spot.first_column = std::min<int>(spot.first_column, s.begin);
            spot.end_column = std::max<int>(spot.end_column, s.end);
        }
    }
    return spots;
}

bool goes_on(const ThinSpot& below, const ThinSpot& above) {
    return below.material == above.material && below.last_layer == above.layer - 1 &&
           below.first_row <= above.end_row && above.first_row <= below.end_row &&
           below.first_column <= above.end_column && above.first_column <= below.end_column;
}

}  // namespace

std::vector<ThinSpot> thin_spots(const ComposedLayer& layer, int k, double least_um, const Raster& raster) {
    std::vector<ThinSpot> spots;
    // Shrinking by r removes walls of 2 r cells but not those of 2 r + 1, and of slanted ones those of 2 r - 2.
    if (least_um <= raster.pixel_um * (1 + 1e-9)) return spots;
    const int radius = (static_cast<int>(std::lround(fine * least_um / raster.pixel_um)) - 1) / 2;
    for (const MaterialImage& m : layer.images) {
        const RunSet thick = grown(shrunk(solid_cells(m.image), radius), 2 * radius);
        const RunSet thin = without(solid(m.image), pixels_of(thick, m.image.width_px(), m.image.height_px()));
        const std::vector<ThinSpot> own = spots_of(thin, k, m.material);
        spots.insert(spots.end(), own.begin(), own.end());
    }
    return spots;
}

std::vector<ThinSpot> joined(const std::vector<ThinSpot>& spots) {
    std::vector<ThinSpot> features;
    std::vector<std::size_t> open;  // those that the layer before reached
    std::vector<std::size_t> reached;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        const ThinSpot& spot = spots[i];
        if (i > 0 && spot.layer != spots[i - 1].layer) open = std::exchange(reached, {});
        const auto found =
            std::ranges::find_if(open, [&](std::size_t feature) { return goes_on(features[feature], spot); });
        if (found == open.end()) {
            reached.push_back(features.size());
            features.push_back(spot);
            continue;
        }
        ThinSpot& feature = features[*found];
        const ThinSpot first = feature;
        feature = spot;
        feature.layer = first.layer;
        feature.row = first.row;
        feature.column = first.column;
        feature.pixels = std::max(first.pixels, spot.pixels);
        reached.push_back(*found);
        open.erase(found);
    }
    return features;
}

std::vector<std::string> describe(const std::vector<ThinSpot>& features, const std::vector<std::string>& materials,
                                  double least_um, const Raster& raster) {
    std::vector<std::string> lines;
    const double pixel_mm2 = raster.pixel_um * raster.pixel_um / 1e6;
    for (std::size_t m = 0; m < materials.size(); ++m) {
        std::vector<ThinSpot> own;
        std::ranges::copy_if(features, std::back_inserter(own),
                             [&](const ThinSpot& s) { return s.material == static_cast<int>(m); });
        if (own.empty()) continue;
        const ThinSpot& most = *std::ranges::max_element(own, {}, &ThinSpot::pixels);
        const int first = std::ranges::min(own, {}, &ThinSpot::layer).layer;
        const int last = std::ranges::max(own, {}, &ThinSpot::last_layer).last_layer;
        lines.push_back(fmt::format(
            "material \"{}\": {} narrower than {:.4g} mm in {}; the largest, {:.4g} mm^2, begins in {} at row {}, "
            "column {}",
            materials[m], counted(own.size(), "feature"), least_um / 1000, layers_text(first, last),
            static_cast<double>(most.pixels) * pixel_mm2, layer_text(most.layer), most.row, most.column));
    }
    return lines;
}

}  // namespace pliant::slice

#include "printing/slice/thin.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/core/counted.hpp"
#include "printing/slice/layer_shape.hpp"
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
    // Shrinking by r removes walls of 2 r pixels but not those of 2 r + 1.
    const int radius = static_cast<int>(std::ceil(least_um / raster.pixel_um - 1e-9)) / 2;
    if (radius < 1) return spots;
    for (const MaterialImage& m : layer.images) {
        const RunSet all = solid(m.image);
        const RunSet thin = without(all, grown(shrunk(all, radius), 2 * radius));
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
            "material \"{}\": {} narrower than {:.4g} mm in layers {} to {}; the largest, {:.4g} mm^2, begins in layer "
            "{} at row {}, column {}",
            materials[m], counted(own.size(), "feature"), least_um / 1000, first, last,
            static_cast<double>(most.pixels) * pixel_mm2, most.layer, most.row, most.column));
    }
    return lines;
}

}  // namespace pliant::slice

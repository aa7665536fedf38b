#include "printing/slice/thin.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/counted.hpp"
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

}  // namespace

std::vector<ThinSpot> thin_spots(const ComposedLayer& layer, int k, double least_um, const Raster& raster) {
    std::vector<ThinSpot> spots;
    // Shrinking by r removes walls of 2 r pixels but not those of 2 r + 1.
    const int radius = static_cast<int>(std::ceil(least_um / raster.pixel_um - 1e-9)) / 2;
    if (radius < 1) return spots;
    for (const MaterialImage& m : layer.images) {
        const RunSet all = solid(m.image);
        const RunSet thin = without(all, grown(shrunk(all, radius), 2 * radius));
        for (int row = thin.first_row(); row < thin.end_row(); ++row) {
            if (thin.row(row).empty()) continue;
            spots.push_back({k, m.material, thin.pixels(), row, thin.row(row).front().begin});
            break;
        }
    }
    return spots;
}

std::vector<std::string> describe(const std::vector<ThinSpot>& spots, const std::vector<std::string>& materials,
                                  double least_um, const Raster& raster) {
    std::vector<std::string> lines;
    const double pixel_mm2 = raster.pixel_um * raster.pixel_um / 1e6;
    for (std::size_t m = 0; m < materials.size(); ++m) {
        std::vector<ThinSpot> own;
        std::copy_if(spots.begin(), spots.end(), std::back_inserter(own),
                     [&](const ThinSpot& s) { return s.material == static_cast<int>(m); });
        if (own.empty()) continue;
        const ThinSpot& most = *std::max_element(
            own.begin(), own.end(), [](const ThinSpot& l, const ThinSpot& r) { return l.pixels < r.pixels; });
        lines.push_back(fmt::format(
            "material \"{}\": features narrower than {:.4g} mm in {} from {} to {}; most, {:.4g} mm^2, in layer "
            "{} from row {}, column {} on",
            materials[m], least_um / 1000, counted(own.size(), "layer"), own.front().layer, own.back().layer,
            static_cast<double>(most.pixels) * pixel_mm2, most.layer, most.row, most.column));
    }
    return lines;
}

}  // namespace pliant::slice

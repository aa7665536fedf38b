// A small job for tests of prints: 8 x 6 pixels of 158.75 um, left half soft, right half rigid, and between them a grey
// column that both share.
#pragma once

#include <fmt/format.h>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"

namespace pliant::app::halves {

inline constexpr int width_px = 8, height_px = 6;
inline constexpr double pixel_um = 158.75;
inline constexpr double pixel_mm2 = pixel_um * pixel_um / 1e6;
/// Area of the soft material: 24 full pixels and 6 of grey 100; rigid covers the rest of the 48.
inline constexpr double soft_mm2 = pixel_mm2 * (24 + 6 * 100.0 / 255);
inline constexpr double rigid_mm2 = pixel_mm2 * 48 - soft_mm2;

/// The image of a material in every layer.
inline Result<job::Image> image(int /*layer*/, int material) {
    job::Image image{width_px, height_px, std::vector<std::uint8_t>(width_px * height_px)};
    for (int i = 0; i < width_px * height_px; ++i) {
        const int x = i % width_px;
        const int soft = x < 4 ? 255 : (x == 4 ? 100 : 0);
        image.pixels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(material == 0 ? soft : 255 - soft);
    }
    return image;
}

struct Look {
    int layers = 5;
    int bottom_layers = 2;
    double bottom_exposure_s = 12;
    double area_mm2 = 0;  ///< of each material's image
    std::string soft_resin = "semi-flex", rigid_resin = "rigid-flex";
};

/// Layers of 50 um; images are called layers/00000_0.png and so on.
inline job::Manifest job(const Look& look) {
    job::Manifest job;
    job.name = "halves";
    job.pliant_version = "0";
    job.width_px = width_px;
    job.height_px = height_px;
    job.pixel_um = pixel_um;
    job.bottom_layers = look.bottom_layers;
    const double height_mm = 0.05 * look.layers;
    job.materials = {{"soft", look.soft_resin, soft_mm2 * height_mm, look.area_mm2, 2.5, look.bottom_exposure_s},
                     {"rigid", look.rigid_resin, rigid_mm2 * height_mm, look.area_mm2, 2.5, look.bottom_exposure_s}};
    for (int layer = 0; layer < look.layers; ++layer) {
        job.layers.push_back({50 * (layer + 1), 50, {}});
        for (int material = 0; material < 2; ++material)
            job.layers.back().images.push_back(
                {material, fmt::format("layers/{:05}_{}.png", layer, material), material == 0 ? soft_mm2 : rigid_mm2});
    }
    return job;
}

}  // namespace pliant::app::halves

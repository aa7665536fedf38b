#include "studio/print/job_part.hpp"

#include <algorithm>

#include "printing/operate/job_file.hpp"
#include "printing/twin/coarse_part.hpp"
#include "studio/print/growing_part.hpp"

namespace pliant::studio {
namespace {

constexpr std::size_t most_images = 250;

/// Number of layers represented by one: 1, or more if there are many.
std::size_t layers_a_step(const job::Manifest& manifest) {
    std::size_t images = 0;
    for (const job::Layer& layer : manifest.layers) images += layer.images.size();
    return std::max<std::size_t>(1, (images + most_images - 1) / most_images);
}

}  // namespace

Result<std::string> job_part(OpenJob& open) {
    const std::lock_guard lock(open.mutex);
    if (Status unchanged = open.unchanged(); !unchanged) return tl::unexpected(unchanged.error());
    if (!open.part.empty()) return open.part;
    const job::Manifest& manifest = open.archive.manifest();
    const auto& layers = manifest.layers;
    twin::CoarsePart part(manifest.width_px, manifest.height_px, manifest.pixel_um,
                          layers.empty() ? 0 : layers.back().z_um);
    const std::size_t step = layers_a_step(manifest);
    for (std::size_t first = 0; first < layers.size(); first += step) {
        const std::size_t last = std::min(first + step, layers.size()) - 1;
        const std::size_t shown = (first + last) / 2;
        const int bottom_um = layers[first].z_um - layers[first].thickness_um;
        for (const job::LayerImage& entry : layers[shown].images) {
            const Result<job::Image> image = operate::image_of(open.archive, static_cast<int>(shown), entry.material);
            if (!image) return tl::unexpected(image.error());
            part.add(bottom_um, layers[last].z_um, entry.material, twin::runs_of(*image));
        }
    }
    open.part = part_packet(part, "drawn", open.revision, 0);
    return open.part;
}

}  // namespace pliant::studio

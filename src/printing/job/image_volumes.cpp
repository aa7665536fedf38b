#include "printing/job/image_volumes.hpp"

namespace pliant::job {

std::vector<double> image_volumes_mm3(const Manifest& manifest) {
    std::vector<double> volumes(manifest.materials.size(), 0.0);
    for (const Layer& layer : manifest.layers) {
        for (const LayerImage& image : layer.images)
            volumes[static_cast<std::size_t>(image.material)] += image.area_mm2 * layer.thickness_um / 1000;
    }
    return volumes;
}

}  // namespace pliant::job

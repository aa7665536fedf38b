#include "printing/job/verify.hpp"

#include <cmath>
#include <vector>

#include "printing/slice/layer_text.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::job {
namespace {

/// The overlap of two images.
struct Shared {
    std::int64_t light = 0;     ///< sum of the smaller of both values
    int row = -1, column = -1;  ///< first shared pixel
};

Shared shared_pixels(const slice::RunImage& a, const slice::RunImage& b) {
    Shared shared;
    for (int row = a.first_row(); row < a.end_row(); ++row) {
        const auto left = a.row(row), right = b.row(row);
        for (auto i = left.begin(), j = right.begin(); i != left.end() && j != right.end();) {
            const int begin = std::max(i->begin, j->begin), end = std::min(i->end, j->end);
            if (begin < end) {
                if (shared.light == 0) shared = {0, row, begin};
                shared.light += std::int64_t{std::min(i->value, j->value)} * (end - begin);
            }
            if (i->end < j->end) {
                ++i;
            } else {
                ++j;
            }
        }
    }
    return shared;
}

/// Checks that images share no more light than the manifest says.
Status check_shared(const Manifest& m, std::size_t k, const std::vector<slice::RunImage>& images, bool corrected,
                    const std::string& path) {
    const std::vector<LayerImage>& entries = m.layers[k].images;
    const double pixel_mm2 = m.pixel_um * m.pixel_um / 1e6;
    for (std::size_t i = 0; i < images.size(); ++i) {
        for (std::size_t j = i + 1; j < images.size(); ++j) {
            const Shared shared = shared_pixels(images[i], images[j]);
            const double said = (entries[i].shared_mm2 + entries[j].shared_mm2) / pixel_mm2;
            // Calibrated greys change the amount of shared light, but not whether there is any.
            const bool agreed = corrected ? said > 0 : static_cast<double>(shared.light) / 255 <= said * (1 + 1e-6);
            if (shared.light == 0 || agreed) continue;
            return input_error("{}: {}: {} and {} both light the pixel at row {}, column {}", path,
                               slice::layer_text(static_cast<int>(k)), entries[i].file, entries[j].file, shared.row,
                               shared.column);
        }
    }
    return {};
}

}  // namespace

Status verify_images(const Archive& archive, bool corrected, const std::string& path, const PlatformEdge* edge,
                     Progress* progress) {
    Progress silent;
    Progress& told = progress != nullptr ? *progress : silent;
    const Manifest& m = archive.manifest();
    const double pixel_mm2 = m.pixel_um * m.pixel_um / 1e6;
    Image image;  // one for all: an allocator that gives memory back would fetch and clear its megabytes for each
    for (std::size_t k = 0; k < m.layers.size(); ++k) {
        told.advance("images", static_cast<double>(k) / static_cast<double>(m.layers.size()));
        if (told.cancelled()) return cancelled();
        std::vector<slice::RunImage> seen;
        for (const LayerImage& entry : m.layers[k].images) {
            if (Status status = archive.image(entry.file, image); !status) return status;
            seen.push_back(slice::RunImage::from_image(image));
            const double area = static_cast<double>(seen.back().value_sum()) / 255 * pixel_mm2;
            if (!corrected && std::fabs(area - entry.area_mm2) > 1e-6 * (area + pixel_mm2))
                return input_error("{}: {}: its pixels hold {:.10g} mm^2, the manifest says {:.10g}", path, entry.file,
                                   area, entry.area_mm2);
            const Beyond beyond = edge != nullptr ? edge->beyond(seen.back()) : Beyond{};
            if (beyond.um > 0) return input_error("{}: {}: its light {}", path, entry.file, edge->text(beyond));
        }
        if (auto status = check_shared(m, k, seen, corrected, path); !status) return status;
    }
    return {};
}

}  // namespace pliant::job

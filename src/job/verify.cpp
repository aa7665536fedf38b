#include "job/verify.hpp"

#include <cmath>
#include <vector>

#include "slice/run_image.hpp"

namespace pliant::job {
namespace {

/// The first pixel that both images light, as "row 3, column 7"; "" if there is none.
std::string shared_pixel(const slice::RunImage& a, const slice::RunImage& b) {
    for (int row = a.first_row(); row < a.end_row(); ++row) {
        const auto left = a.row(row), right = b.row(row);
        for (auto i = left.begin(), j = right.begin(); i != left.end() && j != right.end();) {
            if (i->begin < j->end && j->begin < i->end)
                return fmt::format("row {}, column {}", row, std::max(i->begin, j->begin));
            if (i->end < j->end) {
                ++i;
            } else {
                ++j;
            }
        }
    }
    return {};
}

}  // namespace

Status verify_images(const Archive& archive, bool corrected, const std::string& path) {
    const Manifest& m = archive.manifest();
    const double pixel_mm2 = m.pixel_um * m.pixel_um / 1e6;
    for (std::size_t k = 0; k < m.layers.size(); ++k) {
        std::vector<slice::RunImage> seen;
        for (const LayerImage& entry : m.layers[k].images) {
            const auto image = archive.image(entry.file);
            if (!image) return tl::unexpected(image.error());
            seen.push_back(slice::RunImage::from_image(*image));
            const double area = static_cast<double>(seen.back().value_sum()) / 255 * pixel_mm2;
            if (!corrected && std::fabs(area - entry.area_mm2) > 1e-6 * (area + pixel_mm2))
                return input_error("{}: {}: its pixels hold {:.6g} mm^2, the manifest says {:.6g}", path, entry.file,
                                   area, entry.area_mm2);
        }
        for (std::size_t i = 0; i < seen.size(); ++i) {
            for (std::size_t j = i + 1; j < seen.size(); ++j) {
                if (const std::string where = shared_pixel(seen[i], seen[j]); !where.empty())
                    return input_error("{}: layer {}: {} and {} both light the pixel at {}", path, k,
                                       m.layers[k].images[i].file, m.layers[k].images[j].file, where);
            }
        }
    }
    return {};
}

}  // namespace pliant::job

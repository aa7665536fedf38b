#include "printing/job/image_areas.hpp"

#include <algorithm>
#include <vector>

#include "printing/slice/layer_shape.hpp"

namespace pliant::job {
namespace {

/// The image with every lit pixel at full light.
slice::RunImage full_where_lit(const slice::RunImage& image) {
    slice::RunImage full(image.width_px(), image.height_px());
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        for (const slice::Run& run : image.row(row)) full.append(row, run.begin, run.end, 255);
    }
    return full;
}

}  // namespace

ImageAreas areas_of(const slice::Image& image) {
    const slice::RunImage runs = slice::RunImage::from_image(image);
    if (runs.blank()) return {};
    slice::ComposedLayer layer;
    layer.images.emplace_back();
    layer.images.back().image = full_where_lit(runs);
    const slice::PieceMap pieces = slice::shape_of(layer, runs.width_px()).solid;
    std::vector<double> area_px(pieces.pixels.size(), 0.0);
    ImageAreas areas{static_cast<int>(area_px.size()), 0, 0, 0, runs.width_px(), runs.height_px(), 0, 0};
    for (int row = runs.first_row(); row < runs.end_row(); ++row) {
        auto piece = pieces.row(row).begin();
        for (const slice::Run& run : runs.row(row)) {
            while (piece->end <= run.begin) ++piece;
            area_px[piece->piece] += (run.end - run.begin) * run.value / 255.0;
            areas.min_x = std::min<int>(areas.min_x, run.begin);
            areas.max_x = std::max<int>(areas.max_x, run.end - 1);
            areas.min_y = std::min(areas.min_y, row);
            areas.max_y = std::max(areas.max_y, row);
        }
    }
    for (const double area : area_px) areas.total_px += area;
    areas.largest_px = *std::max_element(area_px.begin(), area_px.end());
    areas.smallest_px = *std::min_element(area_px.begin(), area_px.end());
    return areas;
}

}  // namespace pliant::job

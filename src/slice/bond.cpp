#include "slice/bond.hpp"

#include <algorithm>

#include "slice/mask.hpp"

namespace pliant::slice {
namespace {

const RunImage* find(const ComposedLayer& layer, int material) {
    const auto found = std::find_if(layer.images.begin(), layer.images.end(),
                                    [&](const MaterialImage& m) { return m.material == material; });
    return found == layer.images.end() ? nullptr : &found->image;
}

MaterialImage& of_material(ComposedLayer& layer, int material, const RunImage& like) {
    const auto place = std::lower_bound(layer.images.begin(), layer.images.end(), material,
                                        [](const MaterialImage& m, int wanted) { return m.material < wanted; });
    if (place != layer.images.end() && place->material == material) return *place;
    return *layer.images.insert(place, {material, RunImage(like.width_px(), like.height_px()), 0, 0});
}

}  // namespace

Status check(const Bond& bond) {
    if (bond.first == bond.second)
        return input_error("overlap of '{}' into '{}': two different materials are needed", bond.first, bond.second);
    if (bond.depth_px < 0 || bond.depth_px > 1000)
        return input_error("overlap of '{}' into '{}': {} pixels: must be 0 to 1000", bond.first, bond.second,
                           bond.depth_px);
    if (bond.layers < 0 || bond.layers > 1000)
        return input_error("overlap of '{}' into '{}': {} layers: must be 0 to 1000", bond.first, bond.second,
                           bond.layers);
    if (bond.depth_px == 0 && bond.layers == 0)
        return input_error("overlap of '{}' into '{}': by no pixel and no layer is none", bond.first, bond.second);
    return {};
}

void add_bond(ComposedLayer& layer, const ComposedLayer& owned, std::span<const ComposedLayer> around, int first,
              int second, int depth_px) {
    const RunImage* into = find(owned, second);
    if (into == nullptr) return;
    RunSet near(into->width_px(), into->height_px());
    if (const RunImage* own = find(owned, first); own != nullptr) near = grown(RunSet::lit(*own), depth_px);
    for (const ComposedLayer& neighbour : around) {
        if (const RunImage* image = find(neighbour, first); image != nullptr) near = united(near, RunSet::lit(*image));
    }
    RunImage added = inside(*into, near);
    if (added.blank()) return;
    MaterialImage& image = of_material(layer, first, *into);
    // What another bond has added already.
    added = outside(added, RunSet::lit(image.image));
    const std::int64_t sum = added.value_sum();
    image.image = together(image.image, added);
    image.value_sum += sum;
    image.shared_sum += sum;
}

}  // namespace pliant::slice

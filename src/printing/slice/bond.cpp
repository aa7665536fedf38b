#include "printing/slice/bond.hpp"

#include <algorithm>

#include "printing/slice/mask.hpp"

namespace pliant::slice {
namespace {

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
        return input_error("overlap of '{}' into '{}': 0 pixels and 0 layers: one of them must be above 0", bond.first,
                           bond.second);
    return {};
}

bool add_bond(ComposedLayer& layer, const ComposedLayer& owned, std::span<const ComposedLayer> around, int first,
              int second, int depth_px) {
    const MaterialImage* found = find(owned, second);
    if (found == nullptr) return false;
    const RunImage& into = found->image;
    RunSet near(into.width_px(), into.height_px());
    if (const MaterialImage* own = find(owned, first)) near = grown(RunSet::lit(own->image), depth_px);
    for (const ComposedLayer& neighbour : around) {
        if (const MaterialImage* other = find(neighbour, first)) near = united(near, RunSet::lit(other->image));
    }
    RunImage added = inside(into, near);
    if (added.blank()) return false;
    MaterialImage& image = of_material(layer, first, into);
    // Without what another bond has added already.
    added = outside(added, RunSet::lit(image.image));
    const std::int64_t sum = added.value_sum();
    image.image = together(image.image, added);
    image.value_sum += sum;
    image.shared_sum += sum;
    return true;
}

}  // namespace pliant::slice

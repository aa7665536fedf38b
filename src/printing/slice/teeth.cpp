#include "printing/slice/teeth.hpp"

#include <algorithm>

#include "printing/slice/mask.hpp"

namespace pliant::slice {
Status check(const Teeth& teeth) {
    if (teeth.first == teeth.second)
        return input_error("interlock '{}' with '{}': two different materials are needed", teeth.first, teeth.second);
    if (teeth.depth_px < 1 || teeth.depth_px > 1000)
        return input_error("interlock '{}' with '{}': depth of {} pixels: must be 1 to 1000", teeth.first, teeth.second,
                           teeth.depth_px);
    if (teeth.layers < 1 || teeth.layers > 10000)
        return input_error("interlock '{}' with '{}': {} layers: must be 1 to 10000", teeth.first, teeth.second,
                           teeth.layers);
    return {};
}

bool take_teeth(ComposedLayer& layer, int taker, int giver, int depth_px) {
    MaterialImage *to = find(layer, taker), *from = find(layer, giver);
    if (to == nullptr || from == nullptr) return false;
    const RunSet taken = common(grown(RunSet::lit(to->image), depth_px), RunSet::lit(from->image));
    if (taken.empty()) return false;
    to->image = together(to->image, inside(from->image, taken));
    from->image = outside(from->image, taken);
    to->value_sum = to->image.value_sum();
    from->value_sum = from->image.value_sum();
    std::erase_if(layer.images, [](const MaterialImage& m) { return m.image.blank(); });
    return true;
}

}  // namespace pliant::slice

#include "geometry/mesh/order_in_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace pliant::mesh {
namespace {

constexpr int bits = 21;  // of a layer number: three of these make a key
constexpr double most_layers = (1 << bits) - 1;

struct Keyed {
    std::uint64_t key;
    int item;
};

struct Box {
    Vec3 low, high;
};

Box box_of(std::span<const int> items, const std::vector<Vec3>& place) {
    Box box{place[items[0]], place[items[0]]};
    for (const int item : items) {
        for (std::size_t i = 0; i < 3; ++i) {
            box.low[i] = std::min(box.low[i], place[item][i]);
            box.high[i] = std::max(box.high[i], place[item][i]);
        }
    }
    return box;
}

std::array<std::size_t, 3> longest_first(const Vec3& sides) {
    std::array<std::size_t, 3> axes = {0, 1, 2};
    std::stable_sort(axes.begin(), axes.end(), [&](std::size_t a, std::size_t b) { return sides[a] > sides[b]; });
    return axes;
}

}  // namespace

void order_in_space(std::span<int> items, const std::vector<Vec3>& place, double layer) {
    if (items.empty()) return;
    const Box box = box_of(items, place);
    const auto axes = longest_first(box.high - box.low);
    std::vector<Keyed> keyed;
    keyed.reserve(items.size());
    for (const int item : items) {
        std::uint64_t key = 0;
        for (const std::size_t i : axes) {
            const double number = (place[item][i] - box.low[i]) / layer;
            // NaN if the box has no extent: then everything is in one layer.
            key = key << bits | static_cast<std::uint64_t>(number > 0 ? std::min(number, most_layers) : 0);
        }
        keyed.push_back({key, item});
    }
    std::sort(keyed.begin(), keyed.end(),
              [](const Keyed& a, const Keyed& b) { return a.key != b.key ? a.key < b.key : a.item < b.item; });
    for (std::size_t k = 0; k < items.size(); ++k) items[k] = keyed[k].item;
}

double layer_of(const TetMesh& mesh) {
    return std::cbrt(6 * volume(mesh) / static_cast<double>(mesh.tet_count()));
}

}  // namespace pliant::mesh

// The heights of layers, uniform or individual.
#pragma once

#include <cstdint>
#include <vector>

namespace pliant::slice {

/// Layer k extends from bottom_um(k) to top_um(k) above the platform and is cut at half its height. Whole micrometres.
class Layers {
public:
    /// All of one thickness. Precondition: above 0.
    Layers(int layer_um) : layer_um_(layer_um) {}  // NOLINT: implicit on purpose, a thickness means uniform layers
    /// Ascending tops, above 0; higher layers are as thick as the last one. Precondition: at least one.
    explicit Layers(std::vector<int> tops_um)
        : layer_um_(tops_um.back() - (tops_um.size() > 1 ? tops_um[tops_um.size() - 2] : 0)),
          tops_um_(std::move(tops_um)) {}

    [[nodiscard]] int top_um(int k) const {
        const int known = static_cast<int>(tops_um_.size());
        if (k < known) return tops_um_[static_cast<std::size_t>(k)];
        return known == 0 ? (k + 1) * layer_um_ : tops_um_.back() + (k + 1 - known) * layer_um_;
    }
    [[nodiscard]] int bottom_um(int k) const { return k == 0 ? 0 : top_um(k - 1); }
    [[nodiscard]] int thickness_um(int k) const { return top_um(k) - bottom_um(k); }
    /// Twice the height of the middle, which is an integer too.
    [[nodiscard]] int middle2_um(int k) const { return bottom_um(k) + top_um(k); }
    [[nodiscard]] bool alike() const { return tops_um_.empty(); }

    /// The number of layers whose middle is at or below the height `z` / `units_per_um`; cost: logarithmic in the
    /// number of layers if they are not uniform.
    [[nodiscard]] int middles_up_to(std::int64_t z, std::int64_t units_per_um) const {
        const std::int64_t twice = 2 * z;
        const int known = static_cast<int>(tops_um_.size());
        if (known == 0 || twice >= middle2_um(known - 1) * units_per_um) {
            const std::int64_t first = middle2_um(known) * units_per_um, step = 2 * units_per_um * layer_um_;
            return known + (twice < first ? 0 : static_cast<int>((twice - first) / step) + 1);
        }
        int low = 0, high = known - 1;  // the answer lies in [low, high]
        while (low < high) {
            const int k = (low + high) / 2;
            if (middle2_um(k) * units_per_um <= twice)
                low = k + 1;
            else
                high = k;
        }
        return low;
    }

private:
    int layer_um_;
    std::vector<int> tops_um_;  ///< empty: uniform
};

}  // namespace pliant::slice

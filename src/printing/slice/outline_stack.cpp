#include "printing/slice/outline_stack.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::slice {
namespace {

double area_um2(const OutlineSlice& slice) {
    double twice = 0;
    for (const auto& o : slice.outlines_um) {
        for (std::size_t i = 0; i < o.size(); ++i) {
            const auto &p = o[i], &q = o[(i + 1) % o.size()];
            twice += p[0] * q[1] - q[0] * p[1];
        }
    }
    return std::fabs(twice) / 2;
}

double length_um(const OutlineSlice& slice) {
    double length = 0;
    for (const auto& o : slice.outlines_um) {
        for (std::size_t i = 0; i < o.size(); ++i) {
            const auto &p = o[i], &q = o[(i + 1) % o.size()];
            length += std::hypot(q[0] - p[0], q[1] - p[1]);
        }
    }
    return length;
}

}  // namespace

Result<OutlineStack> OutlineStack::from(std::vector<OutlineSlice> slices, const Layers& layers,
                                        const std::string& label) {
    OutlineStack stack;
    stack.layers_ = layers;
    double below = -max_coordinate_um;
    for (const OutlineSlice& slice : slices) {
        if (!(slice.bottom_um >= below - 1e-6 && slice.top_um > slice.bottom_um && slice.top_um <= max_coordinate_um))
            return input_error(
                "{}: a slice from {:.6g} to {:.6g} um does not lie above the one before, or not within 2 m", label,
                slice.bottom_um, slice.top_um);
        below = slice.top_um;
        if (slice.outlines_um.empty()) continue;
        // The layers whose middle is below the slice's top.
        const auto units = static_cast<std::int64_t>(std::ceil(slice.top_um * grid_per_um));
        stack.layer_count_ = std::max(stack.layer_count_, layers.middles_up_to(units - 1, grid_per_um));
    }
    stack.slices_ = std::move(slices);
    return stack;
}

void OutlineStack::section(int layer, std::vector<Segment>& segments) const {
    const double z = layers_.middle2_um(layer) / 2.0;
    const auto found = std::upper_bound(slices_.begin(), slices_.end(), z,
                                        [](double height, const OutlineSlice& s) { return height < s.top_um; });
    if (found == slices_.end() || z < found->bottom_um) return;
    for (const auto& o : found->outlines_um) {
        for (std::size_t i = 0; i < o.size(); ++i) {
            const auto &p = o[i], &q = o[(i + 1) % o.size()];
            segments.push_back({p[0] * grid_per_um, p[1] * grid_per_um, q[0] * grid_per_um, q[1] * grid_per_um});
        }
    }
}

double OutlineStack::volume_mm3() const {
    double volume = 0;
    for (const OutlineSlice& s : slices_) volume += area_um2(s) * (s.top_um - s.bottom_um) / 1e9;
    return volume;
}

double OutlineStack::area_mm2() const {
    double area = 0;
    const OutlineSlice *first = nullptr, *last = nullptr;
    for (const OutlineSlice& s : slices_) {
        area += length_um(s) * (s.top_um - s.bottom_um) / 1e6;
        if (s.outlines_um.empty()) continue;
        if (first == nullptr) first = &s;
        last = &s;
    }
    return first == nullptr ? 0 : area + (area_um2(*first) + area_um2(*last)) / 1e6;
}

}  // namespace pliant::slice

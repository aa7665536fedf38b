#include "printing/slice/adaptive.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::slice {
namespace {

/// The maximum thickness at every height, in bins.
class Limits {
public:
    Limits(const AdaptiveHeights& heights, double top_um)
        : bin_um_(std::max(1.0, heights.least_um / 5.0)),
          most_um_(static_cast<std::size_t>(std::max(0.0, top_um) / bin_um_) + 2, static_cast<float>(heights.most_um)) {
    }

    void limit(double low_um, double high_um, double thickness_um) {
        if (high_um <= 0) return;
        const auto first = static_cast<std::size_t>(std::max(0.0, low_um) / bin_um_);
        const auto last = std::min(most_um_.size() - 1, static_cast<std::size_t>(high_um / bin_um_));
        for (std::size_t i = first; i <= last; ++i)
            most_um_[i] = std::min(most_um_[i], static_cast<float>(thickness_um));
    }

    /// The minimum over [low, high).
    [[nodiscard]] double least(double low_um, double high_um) const {
        const auto first = std::min(most_um_.size() - 1, static_cast<std::size_t>(low_um / bin_um_));
        const auto end = std::min(most_um_.size(), static_cast<std::size_t>(std::ceil(high_um / bin_um_)));
        float least = most_um_[first];
        for (std::size_t i = first; i < end; ++i) least = std::min(least, most_um_[i]);
        return least;
    }

private:
    double bin_um_;
    std::vector<float> most_um_;
};

void limit_by(const Body& body, const AdaptiveHeights& heights, Limits& limits) {
    for (const OutlineSlice& s : body.slices) limits.limit(s.bottom_um, s.top_um, s.top_um - s.bottom_um);
    if (!body.slices.empty()) return;
    for (const auto& t : body.surface_um.triangles) {
        const Vec3 &a = body.surface_um.points[t[0]], &b = body.surface_um.points[t[1]],
                   &c = body.surface_um.points[t[2]];
        const Vec3 normal = cross(b - a, c - a);
        const double length = norm(normal), low = std::min({a.z, b.z, c.z}), high = std::max({a.z, b.z, c.z});
        // Horizontal faces cause no steps.
        if (!(length > 0) || high - low < 1e-3) continue;
        limits.limit(low, high, heights.least_um * length / std::max(1e-9 * length, std::fabs(normal.z)));
    }
}

/// The last layer ends at the top of the part, unless that would make a layer thinner than the minimum.
int to_the_top(int thickness_um, int rest_um, const AdaptiveHeights& heights) {
    if (rest_um <= thickness_um) return std::max(rest_um, heights.least_um);
    if (rest_um - thickness_um >= heights.least_um) return thickness_um;
    return std::max(rest_um - heights.least_um, heights.least_um);
}

}  // namespace

Result<std::vector<int>> adaptive_tops(std::span<const Body> bodies, const AdaptiveHeights& heights) {
    constexpr int thickest_um = 10000, most_layers = 1000000;
    if (heights.least_um < 1 || heights.most_um < heights.least_um || heights.most_um > thickest_um)
        return input_error("layers of {} to {} um: must be 1 to {} um, the thinner first", heights.least_um,
                           heights.most_um, thickest_um);
    double top_um = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto box = bounds(bodies[i], describe(bodies[i], i));
        if (!box) return tl::unexpected(box.error());
        if (!box->empty()) top_um = std::max(top_um, box->high.z);
    }
    if (top_um / heights.least_um > most_layers)
        return input_error("{:.3f} mm in layers of {} um and more: more than a million layers", top_um / 1000,
                           heights.least_um);
    Limits limits(heights, top_um);
    for (const Body& body : bodies) limit_by(body, heights, limits);
    const int step_um = heights.least_um % 5 == 0 && heights.most_um % 5 == 0 ? 5 : 1;
    std::vector<int> tops{};
    for (int z_um = 0; z_um < top_um;) {
        int thickness_um = heights.most_um;
        // A thinner layer may end below the place that required it.
        while (thickness_um > heights.least_um && limits.least(z_um, z_um + thickness_um) < thickness_um)
            thickness_um -= step_um;
        z_um +=
            to_the_top(std::max(thickness_um, heights.least_um), static_cast<int>(std::ceil(top_um)) - z_um, heights);
        tops.push_back(z_um);
    }
    if (tops.empty()) tops.push_back(heights.most_um);
    return tops;
}

}  // namespace pliant::slice

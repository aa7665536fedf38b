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

bool is_flat(double low_um, double high_um) {
    return high_um - low_um < 1e-3;
}

void limit_by(const mesh::TriMesh& surface, const AdaptiveHeights& heights, Limits& limits) {
    for (const auto& t : surface.triangles) {
        const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
        const Vec3 normal = cross(b - a, c - a);
        const double length = norm(normal), low = std::min({a.z, b.z, c.z}), high = std::max({a.z, b.z, c.z});
        // Horizontal faces cause no steps: a layer ends at them.
        if (!(length > 0) || is_flat(low, high)) continue;
        limits.limit(low, high, heights.least_um * length / std::max(1e-9 * length, std::fabs(normal.z)));
    }
}

void limit_by(const Body& body, const AdaptiveHeights& heights, Limits& limits) {
    for (const OutlineSlice& s : body.slices) limits.limit(s.bottom_um, s.top_um, s.top_um - s.bottom_um);
    if (!body.slices.empty()) return;
    limit_by(body.surface_um, heights, limits);
    for (const mesh::TriMesh& air : body.air_um) limit_by(air, heights, limits);
}

void add_flats(const mesh::TriMesh& surface, std::vector<double>& flats_um) {
    const std::vector<Vec3>& points = surface.points;
    for (const auto& t : surface.triangles) {
        const auto [low, high] = std::minmax({points[t[0]].z, points[t[1]].z, points[t[2]].z});
        if (is_flat(low, high)) flats_um.push_back(high);
    }
}

void add_flats(const Body& body, std::vector<double>& flats_um) {
    if (!body.slices.empty()) {
        flats_um.push_back(body.slices.front().bottom_um);
        flats_um.push_back(body.slices.back().top_um);
        return;
    }
    add_flats(body.surface_um, flats_um);
    for (const mesh::TriMesh& air : body.air_um) add_flats(air, flats_um);
}

/// Heights at which layers should end, ascending: those of horizontal faces, and the top of the part.
std::vector<int> ends_of(std::span<const Body> bodies, double top_um) {
    std::vector<double> flats_um;
    for (const Body& body : bodies) add_flats(body, flats_um);
    std::vector<int> ends;
    for (const double z_um : flats_um) {
        if (z_um >= 0.5 && z_um < top_um - 1) ends.push_back(static_cast<int>(std::lround(z_um)));
    }
    ends.push_back(static_cast<int>(std::ceil(top_um)));
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    return ends;
}

/// A layer ends at the next horizontal face, unless that would make a layer thinner than the minimum.
int to_the_end(int thickness_um, int rest_um, const AdaptiveHeights& heights) {
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
    const std::vector<int> ends = ends_of(bodies, top_um);
    const int step_um = heights.least_um % 5 == 0 && heights.most_um % 5 == 0 ? 5 : 1;
    std::vector<int> tops{};
    for (int z_um = 0; z_um < top_um;) {
        int thickness_um = heights.most_um;
        // A thinner layer may end below the place that required it.
        while (thickness_um > heights.least_um && limits.least(z_um, z_um + thickness_um) < thickness_um)
            thickness_um -= step_um;
        const int end_um = *std::upper_bound(ends.begin(), ends.end(), z_um);  // at latest the top
        z_um += to_the_end(std::max(thickness_um, heights.least_um), end_um - z_um, heights);
        tops.push_back(z_um);
    }
    if (tops.empty()) tops.push_back(heights.most_um);
    return tops;
}

}  // namespace pliant::slice

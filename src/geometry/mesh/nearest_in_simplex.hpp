// The point of a segment, triangle or tet nearest to a given point.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

template <std::size_t N>
Vec3 weighted(const std::array<Vec3, N>& corner, const std::array<double, N>& weight) {
    Vec3 sum;
    for (std::size_t i = 0; i < N; ++i) sum += weight[i] * corner[i];
    return sum;
}

/// As non-negative weights of the corners: the foot of the perpendicular on a triangle's plane if inside, `p` itself if
/// inside a tet, else the nearest over the faces. A degenerate simplex is treated as its faces.
template <std::size_t N>
std::array<double, N> nearest_weights(const std::array<Vec3, N>& corner, const Vec3& p);

template <>
inline std::array<double, 2> nearest_weights(const std::array<Vec3, 2>& c, const Vec3& p) {
    const Vec3 d = c[1] - c[0];
    const double length2 = dot(d, d);
    const double t = length2 > 0 ? std::clamp(dot(p - c[0], d) / length2, 0.0, 1.0) : 0;
    return {1 - t, t};
}

/// The nearest over the N faces that leave out one corner each.
template <std::size_t N>
std::array<double, N> nearest_on_faces(const std::array<Vec3, N>& corner, const Vec3& p) {
    std::array<double, N> best{};
    double best_distance = std::numeric_limits<double>::infinity();
    for (std::size_t left_out = 0; left_out < N; ++left_out) {
        std::array<Vec3, N - 1> face;
        for (std::size_t i = 0, k = 0; i < N; ++i) {
            if (i != left_out) face[k++] = corner[i];
        }
        const auto weights = nearest_weights<N - 1>(face, p);
        const double distance = norm(weighted(face, weights) - p);
        if (distance >= best_distance) continue;
        best_distance = distance;
        for (std::size_t i = 0, k = 0; i < N; ++i) best[i] = i == left_out ? 0 : weights[k++];
    }
    return best;
}

template <>
inline std::array<double, 3> nearest_weights(const std::array<Vec3, 3>& c, const Vec3& p) {
    const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
    const double area2 = dot(n, n);
    if (area2 > 0) {
        const double w1 = dot(cross(p - c[0], c[2] - c[0]), n) / area2;
        const double w2 = dot(cross(c[1] - c[0], p - c[0]), n) / area2;
        if (w1 >= 0 && w2 >= 0 && w1 + w2 <= 1) return {1 - w1 - w2, w1, w2};
    }
    return nearest_on_faces(c, p);
}

template <>
inline std::array<double, 4> nearest_weights(const std::array<Vec3, 4>& c, const Vec3& p) {
    const double volume = signed_tet_volume(c[0], c[1], c[2], c[3]);
    if (volume != 0) {
        std::array<double, 4> w{};
        for (std::size_t i = 0; i < 4; ++i) {
            auto moved = c;
            moved[i] = p;
            w[i] = signed_tet_volume(moved[0], moved[1], moved[2], moved[3]) / volume;
        }
        const double sum = w[0] + w[1] + w[2] + w[3];
        if (std::all_of(w.begin(), w.end(), [](double x) { return x >= 0; }) && sum > 0.5 && sum < 2) {
            constexpr double usual_rounding = 1e-12;
            const bool spoilt = sum < 1 - usual_rounding || sum > 1 + usual_rounding;
            for (double& weight : w) weight /= sum;
            if (!spoilt) return w;
            // In a tet so thin that rounding counts, a face may be nearer than the point of these weights.
            const auto on_face = nearest_on_faces(c, p);
            return norm(weighted(c, w) - p) <= norm(weighted(c, on_face) - p) ? w : on_face;
        }
    }
    return nearest_on_faces(c, p);
}

}  // namespace pliant::mesh

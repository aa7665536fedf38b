#include "report/lighting.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant::report {
namespace {

constexpr int sky_rays = 128, key_rays = 48;               // on the robot
constexpr int floor_sky_rays = 512, floor_key_rays = 128;  // on the floor, where nothing hides a step of light
constexpr double key_radius = 0.16;                        // tangent of the key light's angular radius
constexpr double ground_radiance = 0.50;                   // what comes back from below, relative to the zenith
constexpr double golden_angle = 2.399963229728653;         // pi (3 - sqrt 5)

Vec3 unit(const Vec3& v) {
    return v / norm(v);
}

double smoothstep(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace

std::vector<Lighting::Ray> Lighting::sky(int count) {
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {  // spherical Fibonacci points
        const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), angle = golden_angle * i;
        const double radiance = ground_radiance + (1 - ground_radiance) * smoothstep(-0.6, 0.7, z);
        rays.push_back({{r * std::cos(angle), r * std::sin(angle), z}, radiance});
    }
    return rays;
}

std::vector<Lighting::Ray> Lighting::key(int count, const Vec3& axis) {
    const Vec3 side = unit(cross(axis, Vec3{0.3, 0.9, 0.2})), other = cross(axis, side);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {  // Vogel's spiral over the light's disc
        const double r = key_radius * std::sqrt((i + 0.5) / count), angle = golden_angle * i;
        rays.push_back({unit(axis + r * std::cos(angle) * side + r * std::sin(angle) * other), 1});
    }
    return rays;
}

Lighting::Lighting(const Camera& camera, double reach_m)
    : key_axis_(unit(Vec3{0, 0, 0.9} - 0.45 * camera.right + 0.25 * camera.up - 0.85 * camera.forward)),
      sky_(sky(sky_rays)),
      key_(key(key_rays, key_axis_)),
      floor_sky_(sky(floor_sky_rays)),
      floor_key_(key(floor_key_rays, key_axis_)),
      reach_m_(reach_m) {}

/// Sum of radiance times cosine over the rays that nothing blocks; the cosines in proportion to `normal`.
double Lighting::gathered(const EmbreeScene& scene, const Vec3& origin, const Vec3& normal, std::span<const Ray> rays,
                          double reach, bool free) {
    std::array<Vec3, 8> directions;
    std::array<double, 8> weights{};
    std::size_t filled = 0;
    double sum = 0;
    const auto flush = [&] {
        if (filled == 0) return;
        for (std::size_t i = filled; i < 8; ++i) directions[i] = directions[0];
        const auto hit = free ? std::array<bool, 8>{} : scene.blocked(origin, directions, reach);
        for (std::size_t i = 0; i < filled; ++i) sum += hit[i] ? 0 : weights[i];
        filled = 0;
    };
    for (const Ray& ray : rays) {
        const double cosine = dot(ray.direction, normal);
        if (cosine <= 0) continue;
        directions[filled] = ray.direction;
        weights[filled++] = cosine * ray.radiance;
        if (filled == 8) flush();
    }
    flush();
    return sum;
}

Light Lighting::at(const EmbreeScene& scene, const Vec3& point, const Vec3& normal, const Vec3& geometric) const {
    const Vec3 origin = point + (3e-4 * reach_m_) * geometric;
    return {4.0 / sky_rays * gathered(scene, origin, normal, sky_, reach_m_, false),
            gathered(scene, origin, normal, key_, 10 * reach_m_, false) / key_rays};
}

Light Lighting::on_floor(const EmbreeScene& scene, const Vec3& point) const {
    const Vec3 up{0, 0, 1};
    const auto share = [&](const std::vector<Ray>& rays, double reach) {
        return gathered(scene, point, up, rays, reach, false) / gathered(scene, point, up, rays, reach, true);
    };
    return {share(floor_sky_, reach_m_), share(floor_key_, 10 * reach_m_)};
}

Light Lighting::unshadowed(const Vec3& normal) const {
    const double up = 0.5 + 0.5 * normal.z;
    return {ground_radiance + (1 - ground_radiance) * up, std::max(0.0, dot(normal, key_axis_))};
}

}  // namespace pliant::report

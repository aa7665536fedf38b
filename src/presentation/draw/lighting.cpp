#include "presentation/draw/lighting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pliant::report {
namespace {

constexpr int sky_rays = 128, key_rays = 48;               // on the robot
constexpr int floor_sky_rays = 512, floor_key_rays = 128;  // on the floor, where steps in the light would be visible
constexpr double key_radius = 0.16;                        // tangent of the key light's angular radius
constexpr double ground_radiance = 0.50;                   // light reflected from below, relative to the zenith
constexpr Vec3 upwards{0, 0, 1};
constexpr double golden_angle = 2.399963229728653;  // pi (3 - sqrt 5)

/// Sorts rays so that eight consecutive ones have similar directions: they are traced as a packet.
template <class Ray>
void bundle(std::span<Ray> rays) {
    if (rays.size() <= 8) return;
    Box3 box;
    for (const Ray& ray : rays) box.add(ray.direction);
    const Vec3 size = box.high - box.low;
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = (rays.size() / 2 + 7) / 8 * 8;
    std::nth_element(rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(half), rays.end(),
                     [&](const Ray& a, const Ray& b) { return a.direction[axis] < b.direction[axis]; });
    bundle(rays.first(half));
    bundle(rays.subspan(half));
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
    bundle(std::span(rays));
    return rays;
}

std::vector<Lighting::Ray> Lighting::key(int count, const Vec3& axis) {
    const Vec3 side = unit(cross(axis, Vec3{0.3, 0.9, 0.2})), other = cross(axis, side);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {  // Vogel's spiral over the light's disc
        const double r = key_radius * std::sqrt((i + 0.5) / count), angle = golden_angle * i;
        rays.push_back({unit(axis + r * std::cos(angle) * side + r * std::sin(angle) * other), 1});
    }
    bundle(std::span(rays));
    return rays;
}

Lighting::Lighting(const Camera& camera, double reach_m)
    : key_axis_(unit(Vec3{0, 0, 0.9} - 0.45 * camera.right + 0.25 * camera.up - 0.85 * camera.forward)),
      sky_(sky(sky_rays)),
      key_(key(key_rays, key_axis_)),
      floor_sky_(sky(floor_sky_rays)),
      floor_key_(key(floor_key_rays, key_axis_)),
      on_free_floor_{gathered({}, upwards, floor_sky_, {}), gathered({}, upwards, floor_key_, {})},
      reach_m_(reach_m) {}

/// Sum of radiance times cosine over the unblocked rays; the cosines are relative to `normal`.
double Lighting::gathered(const Vec3& origin, const Vec3& normal, std::span<const Ray> rays,
                          const std::optional<Blocking>& blocking) {
    std::array<Vec3, 8> directions;
    std::array<double, 8> weights{};
    std::size_t filled = 0;
    double sum = 0;
    const auto flush = [&] {
        if (filled == 0) return;
        for (std::size_t i = filled; i < 8; ++i) directions[i] = directions[0];
        const auto hit =
            blocking ? blocking->scene->blocked(origin, directions, blocking->reach) : std::array<bool, 8>{};
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
    return {4.0 / sky_rays * gathered(origin, normal, sky_, Blocking{&scene, reach_m_}),
            gathered(origin, normal, key_, Blocking{&scene, 10 * reach_m_}) / key_rays};
}

Light Lighting::on_floor(const EmbreeScene& scene, const Vec3& point) const {
    return {gathered(point, upwards, floor_sky_, Blocking{&scene, reach_m_}) / on_free_floor_.sky,
            gathered(point, upwards, floor_key_, Blocking{&scene, 10 * reach_m_}) / on_free_floor_.key};
}

Light Lighting::unshadowed(const Vec3& normal) const {
    const double share = 0.5 + 0.5 * normal.z;
    return {ground_radiance + (1 - ground_radiance) * share, std::max(0.0, dot(normal, key_axis_))};
}

}  // namespace pliant::report

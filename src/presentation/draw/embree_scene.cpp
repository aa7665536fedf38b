#include "presentation/draw/embree_scene.hpp"

#include <limits>

namespace pliant::report {

EmbreeDevice::EmbreeDevice()
    : device_(library_.is_there() ? library_.new_device("set_affinity=0") : nullptr, library_.release_device) {}

Status EmbreeDevice::status() const {
    if (!library_.is_there()) return failure("pictures: the library {} is not installed", library_.name());
    if (!device_) return failure("pictures: Embree cannot start on this machine");
    if (const RTCError code = library_.get_device_error(device_.get()); code != RTC_ERROR_NONE) {
        return failure("pictures: Embree reports error {}", static_cast<int>(code));
    }
    return {};
}

EmbreeScene::EmbreeScene(const EmbreeDevice& device)
    : library_(&device.library()),
      device_(device.get()),
      scene_(library_->new_scene(device_), library_->release_scene) {
    library_->set_scene_flags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
}

void EmbreeScene::attach(RTCGeometry geometry) {
    library_->commit_geometry(geometry);
    library_->attach_geometry(scene_.get(), geometry);
    library_->release_geometry(geometry);
}

void EmbreeScene::add_triangles(std::span<const Vec3> points, std::span<const std::array<int, 3>> triangles) {
    RTCGeometry geometry = library_->new_geometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(library_->set_new_geometry_buffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), points.size()));
    auto* indices = static_cast<unsigned*>(library_->set_new_geometry_buffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles.size()));
    if (vertices != nullptr && indices != nullptr) {
        for (const Vec3& p : points) {
            for (std::size_t k = 0; k < 3; ++k) *vertices++ = static_cast<float>(p[k]);
        }
        for (const auto& t : triangles) {
            for (const int i : t) *indices++ = static_cast<unsigned>(i);
        }
    }
    attach(geometry);
}

void EmbreeScene::add_tube(std::span<const Vec3> points, double radius) {
    const auto fill = [&](RTCGeometry geometry, double r) {
        auto* vertices = static_cast<float*>(library_->set_new_geometry_buffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), points.size()));
        for (std::size_t i = 0; vertices != nullptr && i < points.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) *vertices++ = static_cast<float>(points[i][k]);
            *vertices++ = static_cast<float>(r);
        }
    };
    RTCGeometry curve = library_->new_geometry(device_, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
    fill(curve, radius);
    auto* segments = static_cast<unsigned*>(library_->set_new_geometry_buffer(
        curve, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(unsigned), points.size() - 1));
    for (unsigned i = 0; segments != nullptr && i + 1 < points.size(); ++i) segments[i] = i;
    attach(curve);
    RTCGeometry beads = library_->new_geometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    fill(beads, 1.7 * radius);
    attach(beads);
}

void EmbreeScene::commit() {
    library_->commit_scene(scene_.get());
}

Hit EmbreeScene::closest(const Vec3& origin, const Vec3& direction) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(origin.x);
    ray.ray.org_y = static_cast<float>(origin.y);
    ray.ray.org_z = static_cast<float>(origin.z);
    ray.ray.dir_x = static_cast<float>(direction.x);
    ray.ray.dir_y = static_cast<float>(direction.y);
    ray.ray.dir_z = static_cast<float>(direction.z);
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    library_->intersect_1(scene_.get(), &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {true,
            ray.ray.tfar,
            ray.hit.geomID,
            ray.hit.primID,
            ray.hit.u,
            ray.hit.v,
            {ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z}};
}

std::array<bool, 8> EmbreeScene::blocked(const Vec3& origin, std::span<const Vec3, 8> directions, double reach) const {
    alignas(32) static constexpr std::array<int, 8> all = {-1, -1, -1, -1, -1, -1, -1, -1};
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay8 rays{};
    for (std::size_t i = 0; i < 8; ++i) {
        rays.org_x[i] = static_cast<float>(origin.x);
        rays.org_y[i] = static_cast<float>(origin.y);
        rays.org_z[i] = static_cast<float>(origin.z);
        rays.dir_x[i] = static_cast<float>(directions[i].x);
        rays.dir_y[i] = static_cast<float>(directions[i].y);
        rays.dir_z[i] = static_cast<float>(directions[i].z);
        rays.tfar[i] = static_cast<float>(reach);
        rays.mask[i] = ~0U;
    }
    library_->occluded_8(all.data(), scene_.get(), &context, &rays);
    std::array<bool, 8> result{};
    for (std::size_t i = 0; i < 8; ++i) result[i] = rays.tfar[i] < 0;
    return result;
}

}  // namespace pliant::report

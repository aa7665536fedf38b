// Owning wrappers of Embree's device and scenes, with the few queries that the pictures need.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"
#include "presentation/draw/embree_library.hpp"

namespace pliant::report {

struct Hit {
    bool found = false;
    double distance = 0;    ///< along the ray, in units of its direction
    unsigned geometry = 0;  ///< index, in the order of add_*
    unsigned primitive = 0;
    double u = 0, v = 0;  ///< barycentric coordinates of corners 1 and 2
    Vec3 normal;          ///< of the geometry, not normalised
};

class EmbreeDevice {
public:
    EmbreeDevice();
    [[nodiscard]] RTCDevice get() const { return device_.get(); }
    [[nodiscard]] const EmbreeLibrary& library() const { return library_; }
    /// An error means that no scenes can be created.
    [[nodiscard]] Status status() const;

private:
    EmbreeLibrary library_;
    std::unique_ptr<RTCDeviceTy, decltype(&rtcReleaseDevice)> device_;
};

class EmbreeScene {
public:
    explicit EmbreeScene(const EmbreeDevice& device);
    void add_triangles(std::span<const Vec3> points, std::span<const std::array<int, 3>> triangles);
    /// Round tubes along polylines, with a bead of 1.7 times the radius at each point.
    void add_tube(std::span<const Vec3> points, double radius);
    void commit();

    [[nodiscard]] Hit closest(const Vec3& origin, const Vec3& direction) const;
    /// For eight directions, whether something is within `reach` (in units of the direction): 1 blocked, 0 free.
    [[nodiscard]] std::array<bool, 8> blocked(const Vec3& origin, std::span<const Vec3, 8> directions,
                                              double reach) const;

private:
    void attach(RTCGeometry geometry);
    const EmbreeLibrary* library_;
    RTCDevice device_;
    std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)> scene_;
};

}  // namespace pliant::report

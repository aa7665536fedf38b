// The light of the pictures: a sky dome that is brighter above than below, and a round key light over the viewer's left
// shoulder. Both are sampled in fixed directions, so that neighbouring pixels never differ by noise.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/core/vec3.hpp"
#include "presentation/draw/camera.hpp"
#include "presentation/draw/embree_scene.hpp"

namespace pliant::report {

/// How much of each light arrives, relative to a free surface that faces it.
struct Light {
    double sky = 1;
    double key = 1;
};

class Lighting {
public:
    /// `reach_m`: how far off something may be to cast a shadow.
    Lighting(const Camera& camera, double reach_m);

    /// At a point whose surface looks along `geometric` and is shaded with `normal` (both unit).
    [[nodiscard]] Light at(const EmbreeScene& scene, const Vec3& point, const Vec3& normal,
                           const Vec3& geometric) const;
    /// The same on a floor that looks along +Z, relative to a floor with nothing on it: 1 is no shadow.
    [[nodiscard]] Light on_floor(const EmbreeScene& scene, const Vec3& point) const;
    /// Without any shadow.
    [[nodiscard]] Light unshadowed(const Vec3& normal) const;
    [[nodiscard]] const Vec3& key_direction() const { return key_axis_; }

private:
    struct Ray {
        Vec3 direction;
        double radiance;
    };
    struct Blocking {
        const EmbreeScene* scene;
        double reach;
    };
    [[nodiscard]] static double gathered(const Vec3& origin, const Vec3& normal, std::span<const Ray> rays,
                                         const std::optional<Blocking>& blocking);
    [[nodiscard]] static std::vector<Ray> sky(int count);
    [[nodiscard]] static std::vector<Ray> key(int count, const Vec3& axis);

    Vec3 key_axis_;
    std::vector<Ray> sky_, key_, floor_sky_, floor_key_;
    Light on_free_floor_;  ///< sums, not shares
    double reach_m_;
};

}  // namespace pliant::report

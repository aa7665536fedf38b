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

/// Share of each light that arrives, relative to a free surface facing it.
struct Light {
    double sky = 1;
    double key = 1;
};

class Lighting {
public:
    /// `reach_m`: largest distance at which something casts a shadow.
    Lighting(const Camera& camera, double reach_m);

    /// Light at a point whose geometric normal is `geometric` and whose shading normal is `normal` (both unit).
    [[nodiscard]] Light at(const EmbreeScene& scene, const Vec3& point, const Vec3& normal,
                           const Vec3& geometric) const;
    /// Light on a floor facing +Z, relative to an empty floor: 1 is no shadow.
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

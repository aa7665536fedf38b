// Ray-cast still pictures, without a display: sky and key light with soft shadows, a floor that only shows shadows,
// cables visible through the body, a translucent ghost. Embree computes the hits.
//
// Every light is sampled in the same directions at every point, so that pictures have no noise, compress well, and are
// byte-identical on any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "base/core/vec3.hpp"
#include "presentation/draw/camera.hpp"
#include "presentation/draw/colour.hpp"
#include "presentation/draw/surface.hpp"

namespace pliant::report {

/// 8-bit sRGB, row by row from the top.
struct Image {
    int width_px = 0;
    int height_px = 0;
    std::vector<std::uint8_t> rgb;  ///< (height_px, width_px, 3)
};

/// The polyline of a cable; drawn as a round tube with a bead at each point.
struct Cable {
    std::vector<Vec3> points;
};

/// A rigid body beside the robot, matte grey.
struct Thing {
    const Surface* surface = nullptr;
    Pose place;
    std::vector<double> opacity;  ///< (v), 0 to 1
    bool open = false;            ///< a piece of a plane: visible from the front only, casts no shadow
};

struct Scene {
    const Surface* surface = nullptr;
    Pose body;
    std::vector<Colour> vertex_colours;  ///< (v), sRGB
    std::vector<Thing> things;
    std::vector<Cable> cables;
    double cable_radius_m = 0.001;
    std::optional<Pose> ghost;  ///< the same surface in another pose, drawn translucent
    double floor_z_m = 0;
    double shading = 1;  ///< 0: flat colours without light and shadow, best for reading field values
    Colour backdrop_top{0.975, 0.980, 0.986}, backdrop_bottom{0.900, 0.912, 0.928};  ///< sRGB
};

/// Renders `width` x `height` pixels with 4 x 4 stratified samples each. Errors: cancelled, or Embree is out of memory.
[[nodiscard]] Result<Image> render(const Scene& scene, const Camera& camera, int width_px, int height_px,
                                   const Progress& progress);

}  // namespace pliant::report

// Ray-cast stills without a display: sky and key light with soft shadows, a floor that only shows shadows, cables that
// shine through the body, a translucent ghost. Embree finds the hits.
//
// Every light is sampled in the same directions at every point, so that pictures hold no noise, compress well, and are
// the same bytes on any number of threads.
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

/// A rigid thing beside the robot, matte grey.
struct Thing {
    const Surface* surface = nullptr;
    Pose place;
    std::vector<double> opacity;  ///< (v), 0 to 1
    bool open = false;            ///< a piece of a plane: seen from in front only, throws no shadow
};

struct Scene {
    const Surface* surface = nullptr;
    Pose body;
    std::vector<Colour> vertex_colours;  ///< (v), sRGB
    std::vector<Thing> things;
    std::vector<Cable> cables;
    double cable_radius_m = 0.001;
    std::optional<Pose> ghost;  ///< the same surface elsewhere, drawn translucent
    double floor_z_m = 0;
    double shading = 1;  ///< 0: plain colours without light and shadow, as a field's colours are read best
    Colour backdrop_top{0.975, 0.980, 0.986}, backdrop_bottom{0.900, 0.912, 0.928};  ///< sRGB
};

/// Renders `width` x `height` pixels with 4 x 4 stratified samples each. Fails if the progress is cancelled or Embree
/// has no memory.
[[nodiscard]] Result<Image> render(const Scene& scene, const Camera& camera, int width_px, int height_px,
                                   const Progress& progress);

}  // namespace pliant::report

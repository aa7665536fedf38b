// Draws the elements of meshed space that drive actuators, like the thesis' figures of gap and air elements.
#pragma once

#include "presentation/draw/camera.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// Position of a camera's picture on a canvas, in canvas units.
struct Frame {
    Point2 corner;  ///< top left
    double width = 0, height = 0;
};

/// Draws the faces on the surface of that space that face the camera, tinted, with their edges in a darker tone. They
/// are visible through the body in front of them.
void draw_elements(Canvas& canvas, const Frame& frame, const Camera& camera, const Simulation& simulation,
                   std::size_t step);

}  // namespace pliant::report

// The elements of empty space that drive actuators, as the thesis' figures of gap and air elements show them.
#pragma once

#include "presentation/draw/camera.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// Where on a canvas, in its units, the picture of a camera lies.
struct Frame {
    Point2 corner;  ///< top left
    double width = 0, height = 0;
};

/// The tets' faces on the surface of that space which look at the camera, tinted, with their edges in a darker tone.
/// They are seen through the body that is in front of them.
void draw_elements(Canvas& canvas, const Frame& frame, const Camera& camera, const Simulation& simulation,
                   std::size_t step);

}  // namespace pliant::report

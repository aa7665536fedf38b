// Annotations of a picture: heading, material legend, scale bar, colour bar, marker paths.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "presentation/draw/camera.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

void draw_heading(Canvas& canvas, const std::string& title, const std::string& line);

/// Two lines above a panel with its top left corner at `corner`, fitted to its width.
void draw_panel_caption(Canvas& canvas, const Point2& corner, double width, const std::string& title,
                        const std::string& line);

/// Swatches with names from the bottom left.
void draw_legend(Canvas& canvas, const std::vector<std::pair<Colour, std::string>>& entries);

/// A bar of a round length, to scale at the depth of `centre`, at the bottom right.
void draw_scale_bar(Canvas& canvas, const Camera& camera, const Vec3& centre);

/// The colour map from 0 to `top`, at the right; `highest` is the largest value present.
void draw_colour_bar(Canvas& canvas, const std::string& title, double top, const std::string& unit, double highest);

/// The path of each marker over all steps, with its name at the end.
void draw_marker_paths(Canvas& canvas, const Camera& camera, const sim::Trajectory& result);

/// Measured points as rings, with a thin line connecting those of a marker.
void draw_measured(Canvas& canvas, const Camera& camera, const std::vector<MeasuredPath>& paths);

}  // namespace pliant::report

#include "presentation/report/drawn_elements.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace pliant::report {
namespace {

constexpr double tint = 0.45, edge_opacity = 0.85, edge_width = 1.3;  // for a picture that fills the canvas

/// A projected face: its border in order, and its distance.
struct DrawnFace {
    std::vector<Point2> border;  ///< closed: the last point repeats the first
    double depth_m = 0;
};

/// Twice the signed area, positive for a clockwise border in picture coordinates, whose y points down.
double turn_of(const std::vector<Point2>& border) {
    double sum = 0;
    for (std::size_t k = 1; k < border.size(); ++k)
        sum += border[k - 1].x * border[k].y - border[k].x * border[k - 1].y;
    return sum;
}

DrawnFace drawn_face(const mesh::Face& face, std::span<const Vec3> positions, const Frame& frame,
                     const Camera& camera) {
    // Corners and, for a quadratic mesh, the mid-edge nodes between them.
    static constexpr std::array<std::size_t, 7> round = {0, 3, 1, 4, 2, 5, 0};
    DrawnFace drawn;
    for (const std::size_t k : round) {
        if (face.nodes[k] < 0) continue;
        const auto [u, v, depth] = camera.project(positions[static_cast<std::size_t>(face.nodes[k])]);
        drawn.border.push_back(
            {frame.corner.x + (u + 1) / 2 * frame.width, frame.corner.y + (1 - v) / 2 * frame.height});
        drawn.depth_m = std::max(drawn.depth_m, depth);
    }
    return drawn;
}

}  // namespace

void draw_elements(Canvas& canvas, const Frame& frame, const Camera& camera, const Simulation& s, std::size_t step) {
    std::vector<DrawnFace> faces;
    for (std::size_t region = 0; region < s.region_actuates.size(); ++region) {
        if (!s.region_actuates[region]) continue;
        for (const mesh::Face& face : mesh::region_faces(s.mesh, static_cast<int>(region))) {
            DrawnFace drawn = drawn_face(face, s.result.steps[step].positions, frame, camera);
            // The border is counter-clockwise if the outward normal faces the camera.
            if (turn_of(drawn.border) < 0) faces.push_back(std::move(drawn));
        }
    }
    std::stable_sort(faces.begin(), faces.end(),
                     [](const DrawnFace& a, const DrawnFace& b) { return a.depth_m > b.depth_m; });
    const double width = edge_width * std::sqrt(frame.height / canvas.height());  // thinner in small pictures, but
                                                                                  // still visible
    for (const DrawnFace& face : faces) {
        canvas.area(face.border, element_colour, tint);
        canvas.line(face.border, width, element_edge_colour, edge_opacity);
    }
}

}  // namespace pliant::report

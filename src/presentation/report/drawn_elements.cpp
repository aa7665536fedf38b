#include "presentation/report/drawn_elements.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace pliant::report {
namespace {

constexpr double tint = 0.45, edge_opacity = 0.85, edge_width = 1.3;  // of a picture that fills the canvas

/// A face in the picture: its border in order, and how far away it is.
struct DrawnFace {
    std::vector<Point2> border;  ///< closed: the first point is the last one, too
    double depth_m = 0;
};

/// Twice the area, positive for a border that runs clockwise on the picture, whose y points down.
double turn_of(const std::vector<Point2>& border) {
    double sum = 0;
    for (std::size_t k = 1; k < border.size(); ++k)
        sum += border[k - 1].x * border[k].y - border[k].x * border[k - 1].y;
    return sum;
}

DrawnFace drawn_face(const mesh::Face& face, std::span<const Vec3> positions, const Frame& frame,
                     const Camera& camera) {
    // Corners and, where the mesh is quadratic, the nodes in the middle of the edges between them.
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
            // Corners run counter-clockwise where their normal, out of the space, looks at the camera.
            if (turn_of(drawn.border) < 0) faces.push_back(std::move(drawn));
        }
    }
    std::stable_sort(faces.begin(), faces.end(),
                     [](const DrawnFace& a, const DrawnFace& b) { return a.depth_m > b.depth_m; });
    const double width = edge_width * std::sqrt(frame.height / canvas.height());  // thinner, but still seen
    for (const DrawnFace& face : faces) {
        canvas.area(face.border, element_colour, tint);
        canvas.line(face.border, width, element_edge_colour, edge_opacity);
    }
}

}  // namespace pliant::report

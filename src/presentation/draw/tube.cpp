#include "presentation/draw/tube.hpp"

#include <cmath>
#include <numbers>

namespace pliant::report {
namespace {

constexpr int sides = 10;

/// Unit directions of the segments; a segment of zero length takes that of the previous one or, at the start, of the
/// next.
std::vector<Vec3> segment_directions(std::span<const Vec3> points) {
    std::vector<Vec3> directions(points.size() - 1);
    Vec3 last{1, 0, 0};
    for (std::size_t i = directions.size(); i-- > 0;) {
        const Vec3 d = points[i + 1] - points[i];
        if (norm(d) > 0) last = unit(d);
        directions[i] = last;
    }
    return directions;
}

Vec3 any_perpendicular(const Vec3& d) {
    const Vec3 axis = std::abs(d.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return unit(cross(d, axis));
}

/// Direction of the tube at a point: along the bisector of the segments that meet there.
Vec3 direction_at(std::size_t i, const std::vector<Vec3>& segments) {
    const Vec3& before = segments[i == 0 ? 0 : i - 1];
    const Vec3& after = segments[i < segments.size() ? i : segments.size() - 1];
    const Vec3 sum = before + after;
    return norm(sum) > 1e-6 ? unit(sum) : after;
}

void add_cap(Tube& tube, const Vec3& centre, const Vec3& outward, int ring, bool start) {
    const int first = static_cast<int>(tube.positions.size());
    for (int k = 0; k < sides; ++k) {
        tube.positions.push_back(tube.positions[static_cast<std::size_t>(ring * sides + k)]);
        tube.normals.push_back(outward);
    }
    tube.positions.push_back(centre);
    tube.normals.push_back(outward);
    for (int k = 0; k < sides; ++k) {
        const int a = first + k, b = first + (k + 1) % sides;
        tube.triangles.push_back(start ? std::array{first + sides, b, a} : std::array{first + sides, a, b});
    }
}

}  // namespace

Tube tube_around(std::span<const Vec3> points, double radius_m) {
    const auto segments = segment_directions(points);
    Tube tube;
    Vec3 side = any_perpendicular(segments.front());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 along = direction_at(i, segments);
        side -= dot(side, along) * along;  // parallel transport, without twist
        side = norm(side) > 1e-9 ? unit(side) : any_perpendicular(along);
        const Vec3 other = cross(along, side);
        for (int k = 0; k < sides; ++k) {
            const double angle = 2 * std::numbers::pi * k / sides;
            const Vec3 n = std::cos(angle) * side + std::sin(angle) * other;
            tube.positions.push_back(points[i] + radius_m * n);
            tube.normals.push_back(n);
        }
    }
    const int rings = static_cast<int>(points.size());
    for (int r = 0; r + 1 < rings; ++r) {
        for (int k = 0; k < sides; ++k) {
            const int a = r * sides + k, b = r * sides + (k + 1) % sides;
            tube.triangles.push_back({a, b, b + sides});
            tube.triangles.push_back({a, b + sides, a + sides});
        }
    }
    add_cap(tube, points.front(), -segments.front(), 0, true);
    add_cap(tube, points.back(), segments.back(), rings - 1, false);
    return tube;
}

}  // namespace pliant::report

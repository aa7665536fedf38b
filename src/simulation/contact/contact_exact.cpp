// Obstacles without triangles: half-spaces, which meet points, and spheres, which meet triangles.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/contact/contact_search.hpp"

namespace pliant::sim::contact {
namespace {

Bounds box_of(std::span<const int> nodes, std::span<const double> x, std::span<const double> dx) {
    Bounds box;
    for (const int node : nodes) {
        const Vec3 p = node_at(x, node);
        box.add(p);
        if (!dx.empty()) box.add(p + node_at(dx, node));
    }
    return box;
}

/// Calls visit(index, stencil's nodes) for the triangles of a surface that may come within `margin` of a sphere about a
/// node; with `dx`, on the way to x + dx.
template <class Visit>
void visit_near(const Surface& surface, int center, double radius_m, std::span<const double> x,
                std::span<const double> dx, double margin, const Visit& visit) {
    Bounds around = box_of({&center, 1}, x, dx);
    around.widen(radius_m + margin);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto& [a, b, c] = surface.triangles[t];
        if (around.overlaps(box_of(surface.triangles[t], x, dx))) visit(t, std::array{center, a, b, c});
    }
}

/// The part of a sphere that is within `reach_m` of a plane that touches it, m2: on one large triangle no more presses.
double cap_area(double radius_m, double reach_m) {
    return 2 * std::numbers::pi * radius_m * reach_m;
}

}  // namespace

void Contact::find_exact(std::span<const double> x, double within_m, Pairs& pairs) const {
    visit_moving_sides([&](const Side& side) { find_planes(side, x, within_m, pairs); });
    if (balls_.empty()) return;
    Pairs of_balls;
    visit_moving_sides([&](const Side& side) { find_balls(side, x, within_m, of_balls); });
    of_balls = once_per_face(std::move(of_balls), x, within_m == 0);
    pairs.insert(pairs.end(), of_balls.begin(), of_balls.end());
}

void Contact::find_planes(const Side& side, std::span<const double> x, double within_m, Pairs& pairs) const {
    for (const Plane& plane : planes_) {
        for (std::size_t i = 0; i < side.surface.points.size(); ++i) {
            if (!side.surface.acts(i)) continue;
            const int point = side.surface.points[i];
            Pair pair;
            pair.kind = PairKind::point_plane;
            pair.nodes = {point, plane.node, plane.node, plane.node};
            pair.obstacle = plane.obstacle;
            pair.normal = plane.normal;
            pair.reach_m = reach(pair.nodes, distance(pair, stencil_at(pair.nodes, rest_)));
            pair.area_m2 = side.areas.points[i];
            const double within = within_m > 0 ? within_m : pair.reach_m;
            if (distance(pair, stencil_at(pair.nodes, x)) < within) pairs.push_back(pair);
        }
    }
}

void Contact::find_balls(const Side& side, std::span<const double> x, double within_m, Pairs& pairs) const {
    const double most = within_m > 0 ? within_m : settings_.distance_m;
    for (const Ball& ball : balls_) {
        visit_near(side.surface, ball.node, ball.radius_m, x, {}, most, [&](std::size_t t, std::array<int, 4> nodes) {
            Pair pair;
            pair.kind = PairKind::sphere_triangle;
            pair.nodes = nodes;
            pair.obstacle = ball.obstacle;
            pair.radius_m = ball.radius_m;
            pair.robot_first = false;
            pair.flat_face = side.surface.flat_face.empty() ? -1 : side.surface.flat_face[t];
            const double now = distance(pair, stencil_at(nodes, x));
            if (!(now < most)) return;
            // Of a flat face the nearest triangle counts, with the reach of the whole face: once_per_face().
            pair.reach_m = reach(pair.nodes, distance(pair, stencil_at(nodes, rest_)));
            pair.area_m2 = std::min(side.areas.triangles[t], cap_area(ball.radius_m, settings_.distance_m));
            if (pair.flat_face >= 0 || within_m > 0 || now < pair.reach_m) pairs.push_back(pair);
        });
    }
}

double Contact::largest_exact_step(std::span<const double> x, std::span<const double> dx) const {
    double step = 1;
    visit_moving_sides([&](const Side& side) { shorten_to_planes(side, x, dx, step); });
    visit_moving_sides([&](const Side& side) { shorten_to_balls(side, x, dx, step); });
    return step;
}

void Contact::shorten_to_planes(const Side& side, std::span<const double> x, std::span<const double> dx,
                                double& step) const {
    for (const Plane& plane : planes_) {
        for (const int point : side.surface.points) {
            const double now = dot(plane.normal, node_at(x, point) - node_at(x, plane.node));
            const double closing = dot(plane.normal, node_at(dx, plane.node) - node_at(dx, point));
            if (now - closing < kept_share * now)
                step = std::min(step, (1 - kept_share) * std::max(now, 0.0) / closing);
        }
    }
}

void Contact::shorten_to_balls(const Side& side, std::span<const double> x, std::span<const double> dx,
                               double& step) const {
    const double margin = kept_share * settings_.distance_m;
    for (const Ball& ball : balls_) {
        visit_near(side.surface, ball.node, ball.radius_m, x, dx, margin, [&](std::size_t, std::array<int, 4> nodes) {
            step = std::min(step, contact::largest_step(Features::point_triangle, stencil_at(nodes, x),
                                                        stencil_at(nodes, dx), kept_share, step, ball.radius_m));
        });
    }
}

std::optional<Contact::Touched> Contact::touched_by_exact(std::span<const double> x) const {
    std::optional<Touched> touched;
    visit_moving_sides([&](const Side& side) { note_touched(side, x, touched); });
    return touched;
}

void Contact::note_touched(const Side& side, std::span<const double> x, std::optional<Touched>& touched) const {
    for (const Plane& plane : planes_) {
        for (const int point : side.surface.points) {
            if (dot(plane.normal, node_at(x, point) - node_at(x, plane.node)) < -touching_m_)
                touched = {plane.obstacle, part_of(point)};
        }
    }
    for (const Ball& ball : balls_) {
        visit_near(side.surface, ball.node, ball.radius_m, x, {}, touching_m_,
                   [&](std::size_t, std::array<int, 4> nodes) {
                       const Stencil at = stencil_at(nodes, x);
                       const double between = norm(separation(nearest_point_triangle(at), at));
                       if (between - ball.radius_m <= touching_m_) touched = {ball.obstacle, part_of(nodes[1])};
                   });
    }
}

}  // namespace pliant::sim::contact

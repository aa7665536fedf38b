#include "presentation/draw/obstacle.hpp"

#include <cmath>
#include <numbers>
#include <span>

#include "geometry/shapes/sphere_surface.hpp"
#include "simulation/run/describe.hpp"

namespace pliant::report {
namespace {

constexpr double sphere_share = 1e-3;  // largest deviation of a drawn sphere over its radius
constexpr double disc_share = 0.75;    // radius of a plane's disc over the diagonal of the robot's motion

Box3 motion_box(const sim::Trajectory& result) {
    Box3 box;
    for (const sim::Step& step : result.steps) {
        for (const Vec3& p : step.positions) box.add(p);
    }
    return box;
}

Obstacle drawn(const sim::contact::Obstacle& body, const Box3& motion) {
    if (const auto* surface = std::get_if<mesh::TriMesh>(&body.shape)) return {body.name, *surface, false, {}};
    if (const auto* sphere = std::get_if<sim::contact::Sphere>(&body.shape))
        return {body.name,
                mesh::sphere_surface({sphere->center, sphere->radius_m}, sphere_share * sphere->radius_m),
                false,
                {}};
    const auto& half = std::get<sim::contact::HalfSpace>(body.shape);
    const Vec3 center = motion.center();
    const Vec3 foot = center - dot(center - half.point, half.normal) * half.normal;
    return {body.name, disc(foot, half.normal, disc_share * motion.diagonal()), true, {}};
}

Obstacle object_of(const sim::Model& model, const sim::Trajectory& result, std::size_t k) {
    const sim::FreeObject& object = model.description().objects[k];
    const auto at = [&](std::span<const Vec3> nodes) {
        return sim::object_state(model, k, {&nodes.data()->x, 3 * nodes.size()});
    };
    Obstacle drawn{object.name, object.surface, false, {}};
    drawn.pivot_m = at(model.mesh().points).position_m;
    for (const sim::Step& step : result.steps) {
        const sim::ObjectState state = at(step.positions);
        drawn.offset_m.push_back(state.position_m - drawn.pivot_m);
        drawn.rotation.push_back(state.rotation);
    }
    return drawn;
}

}  // namespace

mesh::TriMesh disc(const Vec3& center, const Vec3& normal, double radius_m) {
    constexpr int corners = 96;
    const Vec3 other = std::abs(normal.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 a = unit(cross(normal, other)), b = cross(normal, a);
    mesh::TriMesh mesh;
    mesh.points.push_back(center);
    for (const double radius : {0.5 * radius_m, radius_m}) {
        for (int i = 0; i < corners; ++i) {
            const double angle = 2 * std::numbers::pi * i / corners;
            mesh.points.push_back(center + radius * (std::cos(angle) * a + std::sin(angle) * b));
        }
    }
    for (int i = 0; i < corners; ++i) {
        const int inner = 1 + i, next = 1 + (i + 1) % corners;
        mesh.triangles.push_back({0, inner, next});
        mesh.triangles.push_back({inner, inner + corners, next});
        mesh.triangles.push_back({next, inner + corners, next + corners});
    }
    return mesh;
}

std::vector<Vec3> Obstacle::points_at(std::size_t step) const {
    std::vector<Vec3> points = surface.points;
    for (Vec3& p : points) {
        if (!rotation.empty()) {
            const auto& q = rotation[step];
            const Vec3 axis{q[1], q[2], q[3]}, arm = p - pivot_m, side = 2.0 * cross(axis, arm);
            p = pivot_m + arm + q[0] * side + cross(axis, side);
        }
        p += offset_m[step];
    }
    return points;
}

std::vector<Obstacle> obstacles_of(const sim::Model& model, const sim::Trajectory& result) {
    std::vector<Obstacle> obstacles;
    if (!model.description().contact) return obstacles;
    const Box3 motion = motion_box(result);
    for (const sim::Obstacle& obstacle : model.description().contact->obstacles) {
        obstacles.push_back(drawn(obstacle.body, motion));
        for (const sim::Step& step : result.steps)
            obstacles.back().offset_m.push_back(obstacle.share.at(step.time) * obstacle.move_m);
    }
    for (std::size_t k = 0; k < model.objects().size(); ++k) obstacles.push_back(object_of(model, result, k));
    return obstacles;
}

}  // namespace pliant::report

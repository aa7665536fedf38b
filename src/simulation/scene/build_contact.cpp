#include "simulation/scene/build_contact.hpp"

#include "geometry/files/surface_file.hpp"
#include "geometry/mesher/mesher.hpp"
#include "robot/description/regions.hpp"

namespace pliant::robot {
namespace {

constexpr double distance_share = 1e-3;  // of the robot's size
constexpr double slip_share = 1e-2;      // of the distance
constexpr double stiffness_share = 0.1;  // of the softest Young's modulus
constexpr double chord_share = 0.1;      // of the distance: how far a round obstacle may leave its surface

Result<mesh::TriMesh> obstacle_surface(const Robot& robot, const ObstacleSpec& spec, double distance_m) {
    Result<mesh::TriMesh> surface;
    if (const auto* solid = std::get_if<mesh::Solid>(&spec.shape)) {
        surface = mesh::tessellate(*solid, chord_share * distance_m / robot.unit_m);
    } else {
        const auto& given = std::get<SurfaceFile>(spec.shape);
        Result<mesh::SurfaceFile> file = mesh::read_surface(given.path);
        if (!file) return tl::unexpected(file.error());
        surface = mesh::placed(std::move(file->mesh), given.placement);
    }
    if (!surface) return surface;
    return mesh::scaled(std::move(*surface), robot.unit_m);
}

}  // namespace

Result<std::optional<sim::ContactRules>> build_contact(const Robot& robot, const mesh::TetMesh& bodies) {
    const ContactSpec spec = robot.contact.value_or(ContactSpec{});
    if (!spec.self && robot.obstacles.empty()) return std::nullopt;
    Box3 box;
    for (const Vec3& p : bodies.points) box.add(p);
    sim::ContactRules rules;
    rules.surface = sim::contact::robot_surface(bodies);
    rules.settings.self = spec.self;
    rules.self_when_met = !robot.contact;
    rules.settings.distance_m = spec.distance > 0 ? spec.distance * robot.unit_m : distance_share * box.diagonal();
    rules.settings.slip_m = spec.slip > 0 ? spec.slip * robot.unit_m : slip_share * rules.settings.distance_m;
    rules.settings.stiffness_Pa = spec.stiffness_Pa.value_or(stiffness_share * softest_Pa(robot));
    rules.settings.friction = spec.friction;
    for (const ObstacleSpec& obstacle : robot.obstacles) {
        sim::contact::Obstacle body{obstacle.name, {}, obstacle.friction};
        if (const auto* plane = std::get_if<PlaneSelector>(&obstacle.shape)) {
            body.shape = sim::contact::HalfSpace{robot.unit_m * plane->point, plane->normal / norm(plane->normal)};
        } else {
            Result<mesh::TriMesh> surface = obstacle_surface(robot, obstacle, rules.settings.distance_m);
            if (!surface)
                return input_error_at(robot.file.string(), obstacle.line, "obstacle \"{}\": {}", obstacle.name,
                                      surface.error().message);
            body.shape = std::move(*surface);
        }
        rules.obstacles.push_back({std::move(body), robot.unit_m * obstacle.move, obstacle.share});
    }
    return std::optional(std::move(rules));
}

}  // namespace pliant::robot

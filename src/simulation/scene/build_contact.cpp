#include "simulation/scene/build_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "base/core/boxes.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/mass_properties.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/shapes/single_shape.hpp"
#include "robot/description/regions.hpp"

namespace pliant::robot {
namespace {

constexpr double distance_share = 1e-3;  // of the size of the robot or of the largest object
constexpr double long_share = 0.025;     // the same: a longer distance changes forces noticeably
constexpr double slip_share = 1e-2;      // of the distance
constexpr double stiffness_share = 0.1;  // of the softest Young's modulus
constexpr double chord_share = 0.1;      // of the distance: largest deviation of a round obstacle's triangles from its
                                         // surface
constexpr double rolling_share = 0.05;   // the same for an object, which loses energy at each edge as it rolls

Result<mesh::TriMesh> placed_file(const SurfaceFile& given) {
    Result<mesh::SurfaceFile> file = mesh::read_surface(given.path);
    if (!file) return tl::unexpected(file.error());
    return mesh::placed(std::move(file->mesh), given.placement);
}

/// A drawn shape or a file, in length units, before it is placed; triangles deviate from round surfaces by `chord_m`
/// at most.
template <class Shape>
Result<mesh::TriMesh> shape_surface(const Robot& robot, const Shape& shape, double chord_m) {
    if (const auto* solid = std::get_if<mesh::Solid>(&shape)) return mesh::tessellate(*solid, chord_m / robot.unit_m);
    return placed_file(std::get<SurfaceFile>(shape));
}

Result<mesh::TriMesh> obstacle_surface(const Robot& robot, const ObstacleSpec& spec, double distance_m) {
    Result<mesh::TriMesh> surface = shape_surface(robot, spec.shape, chord_share * distance_m);
    if (!surface) return surface;
    return mesh::scaled(std::move(*surface), robot.unit_m);
}

std::optional<mesh::SphereSolid> drawn_sphere(const ObstacleSpec& spec) {
    const auto* solid = std::get_if<mesh::Solid>(&spec.shape);
    return solid != nullptr ? mesh::single_sphere(*solid) : std::nullopt;
}

/// The diagonal of an object's bounding box, before it is turned, length units; 0 if its file cannot be read.
double drawn_size(const ObjectSpec& spec) {
    const double scale = spec.placement.scale;
    if (const auto* solid = std::get_if<mesh::Solid>(&spec.shape)) return scale * mesh::bounds(*solid).diagonal();
    const Result<mesh::TriMesh> surface = placed_file(std::get<SurfaceFile>(spec.shape));
    return surface ? scale * mesh::bounds(*surface).diagonal() : 0;
}

/// That of the robot or of the largest object.
double largest_size_m(const Robot& robot, const mesh::TetMesh& bodies) {
    double size = bounds_of(bodies.points).diagonal();
    for (const ObjectSpec& object : robot.objects) size = std::max(size, robot.unit_m * drawn_size(object));
    return size;
}

/// The surface at its initial position, metres, counter-clockwise seen from outside.
Result<mesh::TriMesh> object_surface(const Robot& robot, const ObjectSpec& spec, double distance_m) {
    Result<mesh::TriMesh> surface = shape_surface(robot, spec.shape, rolling_share * distance_m / spec.placement.scale);
    if (!surface) return surface;
    mesh::TriMesh whole = mesh::scaled(mesh::placed(std::move(*surface), spec.placement), robot.unit_m);
    std::map<std::pair<int, int>, int> turns;  // for each edge, uses in one direction minus uses in the other
    for (const auto& t : whole.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = t[k], b = t[(k + 1) % 3];
            turns[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    if (std::ranges::any_of(turns, [](const auto& turn) { return turn.second != 0; }))
        return input_error("its surface is not closed, so that it has no inside to carry its mass");
    if (mesh::signed_volume(whole) < 0) {
        for (auto& t : whole.triangles) std::swap(t[1], t[2]);
    }
    return whole;
}

/// Lengths between surfaces cannot be longer than the robot: a wrong unit, or a slip of the pen.
Status check_lengths(const Robot& robot, const ContactSpec& spec, double size_m) {
    struct Given {
        const char* key;
        double length, usual_share;
    };
    for (const Given& given : {Given{"contact.distance", spec.distance, distance_share},
                               Given{"contact.slip", spec.slip, slip_share * distance_share}}) {
        if (!(given.length * robot.unit_m > size_m)) continue;
        return tl::unexpected(error_of(
            Cause::input,
            {{robot.file.string(), spec.line, given.key,
              fmt::format("{:.3g} mm is not possible: it is longer than the robot, {:.3g} mm; usual is {:.2g} mm",
                          1e3 * robot.unit_m * given.length, 1e3 * size_m, 1e3 * given.usual_share * size_m)}}));
    }
    return {};
}

}  // namespace

Result<std::optional<sim::ContactRules>> build_contact(const Robot& robot, const mesh::TetMesh& bodies) {
    const ContactSpec spec = robot.contact.value_or(ContactSpec{});
    if (!spec.self && robot.obstacles.empty() && robot.objects.empty()) return std::nullopt;
    const double size_m = largest_size_m(robot, bodies);
    if (Status status = check_lengths(robot, spec, size_m); !status) return tl::unexpected(status.error());
    sim::ContactRules rules;
    rules.surface = sim::contact::robot_surface(bodies);
    rules.settings.self = spec.self;
    rules.self_when_met = !robot.contact;
    rules.settings.distance_m = spec.distance > 0 ? spec.distance * robot.unit_m : distance_share * size_m;
    rules.settings.slip_m = spec.slip > 0 ? spec.slip * robot.unit_m : slip_share * rules.settings.distance_m;
    rules.settings.stiffness_Pa = spec.stiffness_Pa.value_or(stiffness_share * softest_Pa(robot));
    rules.settings.friction = spec.friction;
    for (const ObstacleSpec& obstacle : robot.obstacles) {
        sim::contact::Obstacle body;
        body.name = obstacle.name;
        body.friction = obstacle.friction;
        body.line = obstacle.line;
        body.start_line = obstacle.start_line > 0 ? obstacle.start_line : obstacle.line;
        if (const auto* plane = std::get_if<PlaneSelector>(&obstacle.shape)) {
            body.shape = sim::contact::HalfSpace{robot.unit_m * plane->point, plane->normal / norm(plane->normal)};
        } else if (const auto sphere = drawn_sphere(obstacle)) {
            body.shape = sim::contact::Sphere{robot.unit_m * sphere->center, robot.unit_m * sphere->radius};
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

std::vector<std::string> notes_on_contact(const Robot& robot, const mesh::TetMesh& bodies,
                                          const sim::ContactRules& rules) {
    std::vector<std::string> notes;
    const sim::contact::Settings& s = rules.settings;
    const double share = s.distance_m / largest_size_m(robot, bodies);
    if (share > long_share)
        notes.push_back(
            fmt::format("contact.distance, {:.3g} mm, is {:.2g} % of the robot's size: surfaces that press on each "
                        "other rest up to a fifth of it from where they are drawn, which changes the forces; a "
                        "thousandth of the size is usual",
                        1e3 * s.distance_m, 100 * share));
    if (s.slip_m > s.distance_m)
        notes.push_back(
            fmt::format("contact.slip, {:.3g} mm, is longer than contact.distance, {:.3g} mm: what slides less is not "
                        "held by the whole friction; a hundredth of the distance is usual",
                        1e3 * s.slip_m, 1e3 * s.distance_m));
    return notes;
}

Status add_objects(const Robot& robot, sim::Description& description) {
    for (const ObjectSpec& spec : robot.objects) {
        const auto problem = [&](const std::string& text) {
            return input_error_at(robot.file.string(), spec.line, "object \"{}\": {}", spec.name, text);
        };
        Result<mesh::TriMesh> surface = object_surface(robot, spec, description.contact->settings.distance_m);
        if (!surface) return problem(surface.error().message);
        const mesh::MassProperties body = mesh::mass_properties(*surface);
        if (!(body.volume > 0)) return problem("it has no volume");
        sim::FreeObject object;
        object.name = spec.name;
        object.line = spec.line;
        object.mass_kg = spec.mass_kg > 0 ? spec.mass_kg : spec.density_kg_m3 * body.volume;
        object.velocity_m_s = spec.velocity_m_s;
        object.angular_velocity_rad_s = spec.angular_velocity_rad_s;
        object.friction = spec.friction;
        object.surface = std::move(*surface);
        std::vector<Vec3>& points = description.mesh.points;
        const std::array<Vec3, 4> corners = mesh::equal_mass_points(body);
        for (std::size_t a = 0; a < corners.size(); ++a) {
            object.nodes[a] = static_cast<int>(points.size());
            points.push_back(corners[a]);
        }
        description.objects.push_back(std::move(object));
    }
    return {};
}

}  // namespace pliant::robot

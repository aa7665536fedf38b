// Creates a Contact and validates its input.
#include <algorithm>
#include <cmath>

#include "simulation/contact/contact.hpp"
#include "simulation/contact/contact_search.hpp"
#include "simulation/contact/obstacle_inset.hpp"

namespace pliant::sim::contact {

namespace {

// The clearance is computed for features this far apart, in mean edges: a larger distance costs more, because each
// point has all triangles around it as candidates; a smaller one makes the result valid for fewer states.
constexpr double seen_edges = 0.5;
constexpr double seen_distances = 2;

Status check_settings(const Settings& s) {
    if (!(s.distance_m > 0) || !std::isfinite(s.distance_m))
        return input_error("contact: the distance must be a positive length");
    if (!(s.stiffness_Pa > 0) || !std::isfinite(s.stiffness_Pa))
        return input_error("contact: the stiffness must be a positive pressure");
    if (!(s.friction >= 0) || !std::isfinite(s.friction))
        return input_error("contact: the coefficient of friction must be zero or more");
    if (!(s.slip_m > 0) || !std::isfinite(s.slip_m))
        return input_error("contact: the slip that counts as none must be a positive length");
    return {};
}

Status check_triangles(std::span<const std::array<int, 3>> triangles, std::size_t nodes, const std::string& whose) {
    for (const auto& t : triangles)
        for (const int node : t)
            if (node < 0 || static_cast<std::size_t>(node) >= nodes)
                return input_error("{}: a triangle names point {}, but there are {}", whose, node, nodes);
    return {};
}

Status check_obstacle(const Obstacle& obstacle) {
    if (!(obstacle.friction >= 0) || !std::isfinite(obstacle.friction))
        return input_error("obstacle \"{}\": the coefficient of friction must be zero or more", obstacle.name);
    if (!is_finite(obstacle.start_m))
        return input_error("obstacle \"{}\": its place at the start is not a number", obstacle.name);
    if (const auto* plane = std::get_if<HalfSpace>(&obstacle.shape)) {
        if (!is_finite(plane->point) || !is_finite(plane->normal) || !(norm(plane->normal) > 0))
            return input_error("obstacle \"{}\": the normal must be a direction other than zero", obstacle.name);
        return {};
    }
    if (const auto* sphere = std::get_if<Sphere>(&obstacle.shape)) {
        if (!is_finite(sphere->center) || !(sphere->radius_m > 0) || !std::isfinite(sphere->radius_m))
            return input_error("obstacle \"{}\": a sphere needs a centre, and a radius above zero", obstacle.name);
        return {};
    }
    const auto& surface = std::get<mesh::TriMesh>(obstacle.shape);
    if (surface.triangles.empty()) return input_error("obstacle \"{}\": it has no triangles", obstacle.name);
    for (const Vec3& p : surface.points)
        if (!is_finite(p)) return input_error("obstacle \"{}\": a coordinate is not a number", obstacle.name);
    return check_triangles(surface.triangles, surface.points.size(), "obstacle \"" + obstacle.name + "\"");
}

template <class Nodes>
BoxTree tree_of(const std::vector<Nodes>& features, std::span<const double> rest) {
    std::vector<Bounds> boxes(features.size());
    for (std::size_t f = 0; f < features.size(); ++f) {
        if constexpr (std::is_same_v<Nodes, int>) {
            boxes[f].add(node_at(rest, features[f]));
        } else {
            for (const int node : features[f]) boxes[f].add(node_at(rest, node));
        }
    }
    return BoxTree(boxes);
}

/// 0 without edges.
double mean_edge(const Surface& surface, std::span<const double> rest) {
    double sum = 0;
    for (const auto& e : surface.edges) sum += norm(node_at(rest, e[0]) - node_at(rest, e[1]));
    return sum / std::max(1.0, static_cast<double>(surface.edges.size()));
}

double diagonal(std::span<const double> rest) {
    Box3 box;
    for (std::size_t i = 0; i < rest.size() / 3; ++i) box.add(node_at(rest, static_cast<int>(i)));
    return box.diagonal();
}

}  // namespace

Contact::Side Contact::make_side(Surface surface, std::span<const double> rest) {
    Side side;
    side.areas = surface_areas(surface, rest);
    side.points = tree_of(surface.points, rest);
    side.edges = tree_of(surface.edges, rest);
    side.triangles = tree_of(surface.triangles, rest);
    side.regions = std::make_shared<const Regions>(surface, rest);
    side.surface = std::move(surface);
    return side;
}

Result<Contact> Contact::create(Surface robot, std::vector<Obstacle> obstacles, const Settings& settings,
                                std::span<const double> rest, std::vector<RigidPart> rigid,
                                std::vector<Joined> joined) {
    if (auto status = check_settings(settings); !status) return tl::unexpected(status.error());
    if (auto status = check_triangles(robot.triangles, rest.size() / 3, "contact surface"); !status)
        return tl::unexpected(status.error());
    for (const Obstacle& obstacle : obstacles)
        if (auto status = check_obstacle(obstacle); !status) return tl::unexpected(status.error());

    Contact contact;
    contact.settings_ = settings;
    contact.rest_.assign(rest.begin(), rest.end());
    contact.robot_nodes_ = static_cast<int>(rest.size() / 3);
    contact.obstacle_of_node_.assign(rest.size() / 3, -1);
    contact.obstacles_ = std::move(obstacles);
    contact.number_parts(std::move(rigid));
    contact.joined_ = std::move(joined);
    contact.touching_m_ = 1e-9 * diagonal(rest);
    contact.belonging_ = Belonging(robot, rest, contact.touching_m_);
    contact.seen_m_ = std::max(seen_edges * mean_edge(robot, rest), seen_distances * settings.distance_m);
    contact.make_sides(robot);
    contact.add_obstacles();
    contact.number_pieces(robot);
    if (auto status = contact.check_beginning(); !status) return tl::unexpected(status.error());
    contact.draw_in_obstacles();
    contact.measure_gaps();
    contact.memory_ = std::make_shared<Memory>();  // what has been noted of the obstacles was of those not drawn in
    return contact;
}

void Contact::make_sides(const Surface& robot) {
    std::vector<std::vector<std::array<int, 3>>> triangles(1 + rigid_.size());
    for (const auto& t : robot.triangles) triangles[static_cast<std::size_t>(part_of(t[0]))].push_back(t);
    robot_ = make_side(rigid_.empty() ? robot : make_surface(triangles[0]), rest_);
    for (std::size_t k = 1; k < triangles.size(); ++k) {
        parts_.push_back(make_side(make_rigid_surface(triangles[k], rest_), rest_));
        note_flat_faces(parts_.back().surface);
    }
}

void Contact::note_flat_faces(const Surface& surface) {
    for (std::size_t t = 0; t < surface.flat_face.size(); ++t)
        if (surface.flat_face[t] >= 0) flat_faces_[surface.flat_face[t]].push_back(surface.triangles[t]);
}

void Contact::number_parts(std::vector<RigidPart> rigid) {
    rigid_ = std::move(rigid);
    if (rigid_.empty()) return;
    part_of_node_.assign(static_cast<std::size_t>(robot_nodes_), 0);
    for (std::size_t k = 0; k < rigid_.size(); ++k)
        std::fill(part_of_node_.begin() + rigid_[k].first, part_of_node_.begin() + rigid_[k].end,
                  static_cast<int>(k) + 1);
}

Status Contact::check_beginning() const {
    Status status = check_obstacles(rest_, When::rest);
    if (status && !rigid_.empty()) status = check_parts_at_rest();
    if (status) status = check_nothing_is_nested(rest_, When::rest);
    const auto is_moved = [](const Obstacle& obstacle) { return obstacle.start_m != Vec3{}; };
    if (!status || std::ranges::none_of(obstacles_, is_moved)) return status;
    std::vector<double> start = rest_;
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
        for (int node = first_node_[k]; node < first_node_[k + 1]; ++node) {
            const Vec3 p = node_at(rest_, node) + obstacles_[k].start_m;
            std::copy_n(&p.x, 3, start.begin() + 3 * static_cast<std::ptrdiff_t>(node));
        }
    }
    status = check_obstacles(start, When::start);
    return status ? check_nothing_is_nested(start, When::start) : status;
}

void Contact::draw_in_obstacles() {
    const double depth = resting_share * settings_.distance_m;
    drawn_in_m_.assign(obstacles_.size(), 0);
    const auto place = [&](int node, const Vec3& p) {
        std::copy_n(&p.x, 3, rest_.begin() + 3 * static_cast<std::ptrdiff_t>(node));
    };
    for (const Plane& plane : planes_) {
        drawn_in_m_[plane.obstacle] = depth;
        place(plane.node, node_at(rest_, plane.node) - depth * plane.normal);
    }
    for (Ball& ball : balls_) {
        // One that is thinner than that acts at the distance of the barrier, as small meshes do.
        if (!(ball.radius_m > depth)) continue;
        drawn_in_m_[ball.obstacle] = depth;
        ball.radius_m -= depth;
    }
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
        const auto* surface = std::get_if<mesh::TriMesh>(&obstacles_[k].shape);
        const auto points = surface != nullptr ? inset(*surface, depth) : std::nullopt;
        if (!points) continue;
        drawn_in_m_[k] = depth;
        for (std::size_t p = 0; p < points->size(); ++p) place(first_node_[k] + static_cast<int>(p), (*points)[p]);
    }
}

void Contact::add_obstacles() {
    std::vector<std::array<int, 3>> triangles;
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
        const int first = node_count();
        first_node_.push_back(first);
        std::vector<Vec3> points;
        if (const auto* plane = std::get_if<HalfSpace>(&obstacles_[k].shape)) {
            planes_.push_back({first, static_cast<int>(k), plane->normal / norm(plane->normal)});
            points = {plane->point};
        } else if (const auto* sphere = std::get_if<Sphere>(&obstacles_[k].shape)) {
            balls_.push_back({first, static_cast<int>(k), sphere->radius_m});
            points = {sphere->center};
        } else {
            const auto& surface = std::get<mesh::TriMesh>(obstacles_[k].shape);
            for (const auto& t : surface.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
            points = surface.points;
        }
        for (const Vec3& p : points) rest_.insert(rest_.end(), {p.x, p.y, p.z});
        obstacle_of_node_.insert(obstacle_of_node_.end(), points.size(), static_cast<int>(k));
        if (!part_of_node_.empty()) part_of_node_.insert(part_of_node_.end(), points.size(), 0);
    }
    first_node_.push_back(node_count());
    others_ = make_side(make_rigid_surface(triangles, rest_), rest_);
    note_flat_faces(others_.surface);
}

}  // namespace pliant::sim::contact

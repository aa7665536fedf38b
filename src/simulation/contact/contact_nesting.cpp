// Refuses solids that begin inside one another. Surfaces that do not cross are either apart or nested, so one point of
// each connected piece decides.
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/core/boxes.hpp"
#include "base/core/disjoint_sets.hpp"
#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/repair/surface_check.hpp"
#include "simulation/contact/contact.hpp"

namespace pliant::sim::contact {
namespace {

/// A point of each connected piece of a surface.
std::vector<Vec3> point_of_each_piece(const mesh::TriMesh& surface) {
    DisjointSets pieces(surface.points.size());
    for (const auto& [a, b, c] : surface.triangles) {
        pieces.join(a, b);
        pieces.join(b, c);
    }
    std::vector<Vec3> points;
    std::vector<char> seen(surface.points.size(), 0);
    for (const auto& t : surface.triangles) {
        const int piece = pieces.find(t[0]);
        if (seen[piece] == 0) points.push_back(surface.points[t[0]]);
        seen[piece] = 1;
    }
    return points;
}

/// Something with a surface at rest. Pieces and tree are computed when they are first needed: mostly never.
class Solid {
public:
    /// `line`: of the file that draws it, or moves it to its start; 0 for the robot.
    Solid(std::string name, int line, int part, mesh::TriMesh surface)
        : name_(std::move(name)), line_(line), part_(part), surface_(std::move(surface)) {
        for (const auto& t : surface_.triangles)
            for (const int p : t) box_.add(surface_.points[p]);
    }

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] int line() const { return line_; }
    [[nodiscard]] int part() const { return part_; }
    [[nodiscard]] bool is_obstacle() const { return part_ < 0; }

    /// Whether a piece of `other` lies inside.
    [[nodiscard]] bool holds(Solid& other) {
        if (!boxes_meet(box_, other.box_)) return false;
        if (!other.pieces_) other.pieces_ = point_of_each_piece(other.surface_);
        return std::any_of(other.pieces_->begin(), other.pieces_->end(), [&](const Vec3& p) {
            if (!box_.contains(p)) return false;
            if (!tree_) tree_.emplace(surface_);
            return tree_->winding_number(p) > 0.5;
        });
    }

private:
    std::string name_;
    int line_;
    int part_;  ///< as Contact::part_of(); -1: an obstacle
    mesh::TriMesh surface_;
    Box3 box_;
    std::optional<std::vector<Vec3>> pieces_;
    std::optional<mesh::TriangleTree> tree_;
};

/// A tetrahedron in a sphere stands for it: what the sphere holds was found to touch it, so the sphere can only be
/// held.
mesh::TriMesh inscribed(const Vec3& center, double radius_m) {
    const double s = radius_m / std::sqrt(3);
    mesh::TriMesh surface{{{s, s, s}, {-s, s, -s}, {s, -s, -s}, {-s, -s, s}},
                          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    for (Vec3& p : surface.points) p += center;
    return surface;
}

}  // namespace

Status Contact::check_nothing_is_nested(std::span<const double> x, When when) const {
    if (obstacles_.empty() && parts_.empty()) return {};  // the robot alone: nothing to compare it with
    std::vector<Solid> solids;
    int part = 0;
    visit_moving_sides([&](const Side& side) {
        mesh::TriMesh surface;
        surface.triangles = side.surface.triangles;
        for (int i = 0; i < robot_nodes_; ++i) surface.points.push_back(node_at(x, i));
        solids.emplace_back(part_name(part), part == 0 ? 0 : rigid_[static_cast<std::size_t>(part) - 1].line, part,
                            std::move(surface));
        ++part;
    });
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
        const Obstacle& obstacle = obstacles_[k];
        mesh::TriMesh surface;
        if (const auto* sphere = std::get_if<Sphere>(&obstacle.shape)) {
            surface = inscribed(node_at(x, first_node_[k]), sphere->radius_m);
        } else if (const auto* drawn = std::get_if<mesh::TriMesh>(&obstacle.shape)) {
            if (!mesh::check_closed(*drawn)) continue;
            surface = *drawn;
            for (std::size_t p = 0; p < surface.points.size(); ++p)
                surface.points[p] = node_at(x, first_node_[k] + static_cast<int>(p));
        } else {
            continue;
        }
        solids.emplace_back("obstacle \"" + obstacle.name + "\"",
                            when == When::start ? obstacle.start_line : obstacle.line, -1, std::move(surface));
    }
    for (Solid& outer : solids) {
        for (Solid& inner : solids) {
            const bool of_interest = &outer != &inner && !(outer.is_obstacle() && inner.is_obstacle()) &&
                                     !parts_are_joined(outer.part(), inner.part());
            if (of_interest && outer.holds(inner))
                return input_error_at("", outer.is_obstacle() || inner.line() == 0 ? outer.line() : inner.line(),
                                      "{} begins inside {}, which is solid{}: move it out, or cut a hollow for it",
                                      inner.name(), outer.name(),
                                      when == When::start ? ", where the key at time 0 moves the obstacle" : "");
        }
    }
    return {};
}

bool Contact::parts_are_joined(int a, int b) const {
    return std::any_of(joined_.begin(), joined_.end(), [&](const Joined& joined) {
        return (joined.first == a - 1 && joined.second == b - 1) || (joined.first == b - 1 && joined.second == a - 1);
    });
}

}  // namespace pliant::sim::contact

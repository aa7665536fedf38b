// Contact of a robot with itself and with obstacles: a potential that grows without bound as surfaces approach, and the
// largest step along which they do not pass through each other.
//
//     const auto contact = Contact::create(robot_surface(mesh), obstacles, settings, rest);
//     x += contact->largest_step(x, dx) * dx;                          // never passes through
//     const Pairs pairs = contact->find(x);
//     contact->add_gradient(pairs, x, gradient);
//     contact->visit_hessian(pairs, x, true, add_block);
//     const Friction friction = contact->freeze(pairs, x, step_start); // again after every step, until it settles
//
// Li, Ferguson, Schneider et al. 2020, "Incremental Potential Contact". Positions x are (3 nodes) metres: the robot's
// nodes, then those of the obstacles in their order, which the caller updates when an obstacle moves. All functions
// give the same bits on any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/core/box_tree.hpp"
#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "simulation/contact/belonging.hpp"
#include "simulation/contact/ccd.hpp"
#include "simulation/contact/friction.hpp"
#include "simulation/contact/regions.hpp"
#include "simulation/contact/surface.hpp"

namespace pliant::sim::contact {

/// All points x with (x − point) · normal < 0. Has one node, at `point`; the normal is constant.
struct HalfSpace {
    Vec3 point, normal;
};

/// All points within `radius_m` of the centre. Has one node, the centre.
struct Sphere {
    Vec3 center;
    double radius_m = 0;
};

struct Obstacle {
    std::string name;
    /// Metres, at its rest place; a mesh has one node per point.
    std::variant<mesh::TriMesh, HalfSpace, Sphere> shape;
    double friction = 0;           ///< coefficient μ against the robot
    Vec3 start_m{};                ///< how far it has moved from there at the start
    int line = 0, start_line = 0;  ///< of the file that draws it and moves it to its start, for errors; 0: unknown
};

struct Settings {
    double distance_m = 0;    ///< forces act below this distance; of the order of an element or less, for speed
    double stiffness_Pa = 0;  ///< pressure is about four times this at half the distance; Young's modulus / 10 is usual
    double friction = 0;      ///< coefficient μ of the robot against itself
    double slip_m = 1e-5;     ///< slip that counts as sticking, m
    bool self = true;         ///< whether the robot can touch itself
};

/// A rigid object: nodes of the robot's surface from `first` up to `end`. It touches everything but itself.
struct RigidPart {
    std::string name;
    int first = 0, end = 0;
    double friction = 0;  ///< coefficient; between two with a coefficient, the larger counts
    int line = 0;         ///< of the file that draws it, for errors; 0: unknown
};

/// Two parts that are joined, and do not touch each other near the joint: rigid parts, or -1 for the rest of the robot.
struct Joined {
    int first = -1, second = -1;
    Vec3 center;          ///< at rest
    double radius_m = 0;  ///< pairs with both features inside at rest are excluded; infinite for rigid parts: all pairs
                          ///< are
};

/// Contact forces on the robot, for results.
struct Forces {
    std::vector<Vec3> on_robot_N;     ///< (obstacles) normal and friction forces of each on the robot, without objects
    std::vector<Vec3> on_rigid_N;     ///< (rigid parts) from everything that touches it
    double self_N = 0;                ///< sum of the magnitudes of the self-contact normal forces
    std::vector<double> pressure_Pa;  ///< (robot nodes) normal force over the area of the node; 0 inside
    double smallest_distance_m = 0;   ///< as of smallest_distance()
};

/// Whose coefficient of friction applies to a pair: an obstacle's, a rigid part's or, with neither, the robot's against
/// itself.
struct FrictionOwner {
    double coefficient = 0;
    int obstacle = -1, rigid = -1;
};

/// An edge that intersects a triangle.
struct Crossing {
    std::array<int, 2> edge;
    std::array<int, 3> triangle;
    int obstacle;  ///< -1: the robot with itself
    Vec3 point_m;  ///< where they meet
};

/// Immutable, except for a cache of what was near at the last states, which saves time and does not change a bit. A
/// pair acts below its reach, min(distance_m, half its distance at rest), so that the rest state carries no force; of
/// pieces that are not connected half the gap between them at rest counts, wherever they slide on each other. For
/// obstacles the reach is min(distance_m, its distance at rest), and all but open ones are inset by
/// resting_share of distance_m (obstacle_inset.hpp), so that what presses on them rests where they are drawn. Excluded
/// are features that share a node or belong together at rest (belonging.hpp: bonded bodies, slivers), and pairs of
/// obstacles.
class Contact {
public:
    /// `rest`: (3 robot nodes). `rigid`: parts of the robot's surface, ascending. `joined`: parts between which contact
    /// is excluded. Errors: obstacles or rigid parts that touch or cross what they may touch, at rest or where
    /// obstacles are at the start (standing on a plane is allowed), invalid numbers. They name lines, but no file.
    [[nodiscard]] static Result<Contact> create(Surface robot, std::vector<Obstacle> obstacles,
                                                const Settings& settings, std::span<const double> rest,
                                                std::vector<RigidPart> rigid = {}, std::vector<Joined> joined = {});

    /// Rest positions of all nodes, (3 nodes); obstacles inset, as they act.
    [[nodiscard]] const std::vector<double>& rest() const { return rest_; }
    [[nodiscard]] int node_count() const { return static_cast<int>(rest_.size() / 3); }
    [[nodiscard]] int robot_node_count() const { return robot_nodes_; }
    [[nodiscard]] const std::vector<Obstacle>& obstacles() const { return obstacles_; }
    /// Nodes of obstacle k: from first_node(k) up to first_node(k + 1).
    [[nodiscard]] int first_node(std::size_t k) const { return first_node_[k]; }
    [[nodiscard]] const Settings& settings() const { return settings_; }

    /// The pairs that are closer than their reach, in an order that depends on x alone.
    [[nodiscard]] Pairs find(std::span<const double> x) const;

    /// All pairs that are closer than `within_m`, also those beyond their reach, on which nothing acts at x.
    [[nodiscard]] Pairs find_near(std::span<const double> x, double within_m) const;

    /// Energy, J; infinite if a pair touches.
    [[nodiscard]] double energy(const Pairs& pairs, std::span<const double> x) const;
    /// Adds the gradient of the energy, minus the contact forces, N, to `gradient` (3 nodes).
    void add_gradient(const Pairs& pairs, std::span<const double> x, std::span<double> gradient) const;
    /// Visits the 3 × 3 blocks of every pair, N/m, one pair after the other; `project`: each pair without negative
    /// eigenvalues.
    void visit_hessian(const Pairs& pairs, std::span<const double> x, bool project, const BlockVisitor& visit) const;

    /// The largest step in [0, 1] up to which no pair comes closer than a tenth of its present distance, by
    /// conservative CCD; features that stay more than a tenth of distance_m apart throughout are ignored. 0 if a pair
    /// already touches. `dx`: (3 nodes).
    [[nodiscard]] double largest_step(std::span<const double> x, std::span<const double> dx) const;

    /// True if largest_step() is 1; quicker, as the search ends with the first pair that comes too close.
    [[nodiscard]] bool is_free(std::span<const double> x, std::span<const double> dx) const;

    /// True if largest_step() is below 1. Much quicker where nothing comes near in a sequence of small steps: it
    /// records the distances between all surfaces, and the next steps are compared with these.
    [[nodiscard]] bool meets(std::span<const double> x, std::span<const double> dx) const;

    /// Friction with the normal forces and tangents of the pairs at `frozen`, for slip from `step_start`. `before`:
    /// friction of the step that ended there, whose slip is carried over where surfaces stick; null: there was none.
    [[nodiscard]] Friction freeze(const Pairs& pairs, std::span<const double> frozen,
                                  std::span<const double> step_start, const Friction* before = nullptr) const;

    /// What touches what in these pairs, each once, ascending: 0 is the robot, k + 1 rigid part k, -k - 1 obstacle k.
    [[nodiscard]] std::vector<std::array<int, 2>> partners(const Pairs& pairs) const;
    /// The flat faces of obstacles on which objects press: both as in partners(), and the face as in Surface. A block
    /// that slides on a floor into a wall of the same obstacle meets a second one.
    [[nodiscard]] std::vector<std::array<std::int64_t, 3>> faces_met(const Pairs& pairs) const;

    /// Between two with a coefficient the larger applies; if equal, the obstacle's. `nodes` of a pair, and its obstacle
    /// or -1.
    [[nodiscard]] FrictionOwner friction_owner(std::span<const int> nodes, int obstacle) const;

    /// Sum of the magnitudes of the robot's normal forces on itself, N; adds its gradient, N/m, to `gradient` (3
    /// nodes).
    double add_self_force(const Pairs& pairs, std::span<const double> x, std::span<double> gradient) const;
    [[nodiscard]] Forces forces(const Pairs& pairs, std::span<const double> x, const Friction* friction) const;
    /// Smallest distance of the pairs; infinity if there are none. Measured from obstacles as drawn: negative if the
    /// robot is pressed hard on one.
    [[nodiscard]] double smallest_distance(const Pairs& pairs, std::span<const double> x) const;

    /// The first intersection of surfaces at x, if any: of the robot with itself, whatever the settings say, or with an
    /// obstacle. For states that were not reached through largest_step. Features that belong together do not count.
    [[nodiscard]] std::optional<Crossing> crossing(std::span<const double> x) const;
    /// Where the robot intersects itself at rest, if anywhere.
    [[nodiscard]] std::optional<Crossing> crossing_at_rest() const;

private:
    /// The robot's surface, that of one rigid part, or the meshes of all obstacles.
    struct Side {
        Surface surface;
        SurfaceAreas areas;
        BoxTree points, edges, triangles;
        std::shared_ptr<const Regions> regions;
    };
    struct Plane {
        int node, obstacle;
        Vec3 normal;
    };
    struct Ball {
        int node, obstacle;
        double radius_m;  ///< as it acts: drawn in
    };
    class Search;  ///< one sweep over the features whose boxes overlap: contact_search.hpp
    class Nearby;  ///< the result of such a sweep, valid while nothing moves far
    struct Memory;

    Contact();
    /// The features that are near at x and along dx, if the last states suggest that caching them pays off; else null.
    [[nodiscard]] std::shared_ptr<const Nearby> nearby(std::span<const double> x, std::span<const double> dx) const;
    /// True only if the cache proves that nothing is within its reach at x, nor comes too close along dx.
    [[nodiscard]] bool is_clear(std::span<const double> x, std::span<const double> dx) const;
    /// Records the distances between all surfaces at x, if nothing is within its reach and the last states suggest that
    /// this pays off: queries for nearby steps are then answered quickly.
    void note_clearance(std::span<const double> x) const;
    void wait_for_clearance() const;
    [[nodiscard]] static Side make_side(Surface surface, std::span<const double> rest);
    void add_obstacles();
    void draw_in_obstacles();
    [[nodiscard]] int obstacle_of(std::span<const int> nodes) const;  ///< of a pair's four nodes
    [[nodiscard]] std::array<int, 2> owners(const Pair& pair) const;  ///< as in partners()
    /// 0: the robot or an obstacle, else 1 + the rigid part.
    [[nodiscard]] int part_of(int node) const { return part_of_node_.empty() ? 0 : part_of_node_[node]; }
    /// The robot, the obstacles, then the rigid parts.
    [[nodiscard]] const Side& side(std::size_t k) const { return k == 0 ? robot_ : k == 1 ? others_ : parts_[k - 2]; }
    [[nodiscard]] std::size_t side_of(int node) const {
        if (obstacle_of_node_[node] >= 0) return 1;
        const int part = part_of(node);
        return part == 0 ? 0 : static_cast<std::size_t>(part) + 1;
    }
    /// Visits all sides except the obstacles.
    template <class Visit>
    void visit_moving_sides(const Visit& visit) const {
        visit(robot_);
        for (const Side& part : parts_) visit(part);
    }
    /// True if two features belong together, or are on parts that are joined there. `apart_m`: at rest.
    [[nodiscard]] bool left_out(std::span<const int> first, std::span<const int> second, double apart_m) const;
    [[nodiscard]] bool are_joined(std::span<const int> first, std::span<const int> second) const;
    /// The sides, by index, that may touch; {0, 0}, self-contact, last.
    [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> meetings(bool self) const;
    void make_sides(const Surface& robot);
    void number_parts(std::vector<RigidPart> rigid);
    [[nodiscard]] Status check_parts_at_rest() const;
    /// Whether the obstacles are where they are drawn, or where they are at the start.
    enum class When { rest, start };
    /// Errors as of create(). Precondition: the obstacles are not drawn in yet.
    [[nodiscard]] Status check_beginning() const;
    /// Error: an obstacle touches or crosses the robot or an object.
    [[nodiscard]] Status check_obstacles(std::span<const double> x, When when) const;
    /// Precondition: no surfaces cross at x. Error: the robot, an object or a closed obstacle lies inside another.
    [[nodiscard]] Status check_nothing_is_nested(std::span<const double> x, When when) const;
    /// `a`, `b`: as part_of(), or -1 for obstacles.
    [[nodiscard]] bool parts_are_joined(int a, int b) const;
    /// Of a pair with these nodes that is `apart_m` apart at rest.
    [[nodiscard]] double reach(std::span<const int, 4> nodes, double apart_m) const;
    /// The connected piece of the robot's surface that a node is on, or the obstacle that it belongs to.
    [[nodiscard]] int piece_of(int node) const { return piece_of_node_[node]; }
    void number_pieces(const Surface& robot);
    void measure_gaps();
    /// Of a point and the triangles of a flat face the nearest pair alone, the first of several. The face has one
    /// reach, that of its distance at rest. `within_reach`: only pairs on which forces act.
    [[nodiscard]] Pairs once_per_face(Pairs pairs, std::span<const double> x, bool within_reach) const;
    /// Distance at rest of a point from a flat face.
    [[nodiscard]] double rest_distance(int point, std::int64_t flat_face) const;
    void note_flat_faces(const Surface& surface);
    /// An obstacle and what touches it at rest.
    struct Touched {
        int obstacle, part;  ///< part_of()
    };
    [[nodiscard]] std::optional<Touched> obstacle_touched(std::span<const double> x) const;
    /// What may be wrong with an obstacle that touches the robot where it is drawn, and what would be right.
    [[nodiscard]] std::string advice_on(const Touched& touched) const;
    [[nodiscard]] std::string part_name(int part) const;
    [[nodiscard]] std::optional<Crossing> first_crossing(std::span<const double> x, bool self, bool at_rest) const;
    [[nodiscard]] bool edge_and_triangle_belong_together(std::span<const int, 5> nodes) const;
    [[nodiscard]] Pair make_pair(bool edges, std::span<const int> nodes, double reach_m, double area_m2,
                                 std::int64_t flat_face) const;
    [[nodiscard]] Pairs search_pairs(std::span<const double> x) const;
    /// Obstacles without triangles: contact_exact.cpp. `within_m`: 0 stands for the reach of each pair.
    void find_exact(std::span<const double> x, double within_m, Pairs& pairs) const;
    void find_planes(const Side& side, std::span<const double> x, double within_m, Pairs& pairs) const;
    void find_balls(const Side& side, std::span<const double> x, double within_m, Pairs& pairs) const;
    [[nodiscard]] double largest_exact_step(std::span<const double> x, std::span<const double> dx) const;
    void shorten_to_planes(const Side& side, std::span<const double> x, std::span<const double> dx, double& step) const;
    void shorten_to_balls(const Side& side, std::span<const double> x, std::span<const double> dx, double& step) const;
    /// Of the parts that planes and balls touch or hold at x, the last.
    [[nodiscard]] std::optional<Touched> touched_by_exact(std::span<const double> x) const;
    void note_touched(const Side& side, std::span<const double> x, std::optional<Touched>& touched) const;
    /// largest_step(), or where that is below `enough`, any other value below it.
    [[nodiscard]] double free_step(std::span<const double> x, std::span<const double> dx, double enough) const;

    Settings settings_;
    std::vector<Obstacle> obstacles_;
    std::vector<double> drawn_in_m_;              ///< (obstacles)
    std::vector<int> piece_of_node_;              ///< (nodes)
    std::map<std::array<int, 2>, double> gap_m_;  ///< of two pieces at rest, the smaller number first, if near
    std::vector<int> first_node_;                 ///< (obstacles + 1)
    std::vector<int> obstacle_of_node_;           ///< (nodes), -1 for the robot's
    std::vector<RigidPart> rigid_;
    std::vector<Joined> joined_;
    std::vector<int> part_of_node_;  ///< (nodes) as part_of(); empty without rigid parts
    std::vector<double> rest_;
    int robot_nodes_ = 0;
    double seen_m_ = 0;      ///< search distance if the result is to be reused for several states
    double touching_m_ = 0;  ///< distances up to this are zero to rounding
    Belonging belonging_;
    Side robot_, others_;
    std::vector<Side> parts_;                                             ///< (rigid parts)
    std::map<std::int64_t, std::vector<std::array<int, 3>>> flat_faces_;  ///< their triangles
    std::vector<Plane> planes_;
    std::vector<Ball> balls_;
    std::shared_ptr<Memory> memory_;
};

}  // namespace pliant::sim::contact

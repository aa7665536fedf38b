// A pair of features that are near each other, and the potential that keeps them apart.
//
//     E = κ a d̂ m(c) b(D)       κ stiffness, Pa; a area the pair represents, m²; d̂ reach, m; m, b: barrier.hpp
//
// Li, Ferguson, Schneider et al. 2020, equations 6, 8 and 23. There κ carries all the units; here the areas make the
// pressure at a given share of the reach, about 4 κ at half of it, independent of mesh and reach.
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/contact/distance.hpp"

namespace pliant::sim::contact {

enum class PairKind { point_triangle, edge_edge, point_plane, sphere_triangle };

struct Pair {
    PairKind kind = PairKind::point_triangle;
    std::array<int, 4> nodes{};   ///< as in Stencil; point_plane: the point, the half-space's node, twice more the
                                  ///< latter; sphere_triangle: the centre, then the corners
    int obstacle = -1;            ///< -1: the robot with itself
    double reach_m = 0;           ///< d̂: farther apart there is no force
    double area_m2 = 0;           ///< a
    double parallel_m4 = 0;       ///< edge_edge: squared cross product below which the mollifier acts
    Vec3 normal;                  ///< point_plane: unit vector out of the half-space
    double radius_m = 0;          ///< sphere_triangle
    bool robot_first = true;      ///< the robot's nodes come first (point_triangle against an obstacle may be either)
    std::int64_t flat_face = -1;  ///< of the triangle, if there is one: its flat face, as in Surface

    /// Number of distinct `nodes`.
    [[nodiscard]] int node_count() const { return kind == PairKind::point_plane ? 2 : 4; }
    /// Number of them, from the front, that belong to the first feature.
    [[nodiscard]] int first_count() const { return kind == PairKind::edge_edge ? 2 : 1; }
};
using Pairs = std::vector<Pair>;

/// Nearest points of any kind of pair. For point_plane the weights are those of the two nodes.
[[nodiscard]] Nearest nearest(const Pair& pair, const Stencil& x);
/// The vector between them; for point_plane along the normal, for sphere_triangle from the surface of the sphere.
/// Precondition: a sphere's centre is on no triangle.
[[nodiscard]] Vec3 separation(const Pair& pair, const Nearest& n, const Stencil& x);
/// Distance in metres; negative for a point inside a half-space and for a triangle that reaches into a sphere.
[[nodiscard]] double distance(const Pair& pair, const Stencil& x);

/// E in J, and its derivatives. Infinite where the features touch.
[[nodiscard]] double potential(const Pair& pair, double stiffness_Pa, const Stencil& x);
[[nodiscard]] Vector12 potential_gradient(const Pair& pair, double stiffness_Pa, const Stencil& x);
[[nodiscard]] Matrix12 potential_hessian(const Pair& pair, double stiffness_Pa, const Stencil& x);

/// The size of the force between the two features, N: |∂E/∂d| with the mollifier held.
[[nodiscard]] double normal_force(const Pair& pair, double stiffness_Pa, const Stencil& x);
[[nodiscard]] Vector12 normal_force_gradient(const Pair& pair, double stiffness_Pa, const Stencil& x);

/// The nearest symmetric matrix without negative eigenvalues; only the first 3 `nodes` rows and columns count.
[[nodiscard]] Matrix12 project_to_positive(const Matrix12& H, int nodes);

}  // namespace pliant::sim::contact

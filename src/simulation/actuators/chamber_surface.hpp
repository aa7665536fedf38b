// The wall of a chamber: its volume, and the derivatives of the volume with respect to the nodes. Pressure patches on
// the outer surface are walls too, but open ones.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/core/vec3.hpp"
#include "base/linalg/small.hpp"
#include "base/linalg/sparse.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// With shape functions N_i of the 3- or 6-node faces, over all faces
///   volume          V = 1/3 sum_q w_q (x - c) . n,    n = x_u x x_v
///   gradient        dV/dx_i = sum_q w_q N_i n                          (the force of unit pressure on node i)
///   second gradient d2V/dx_i dx_j = sum_q w_q N_i (N_j,v [x_u] - N_j,u [x_v]),   [a] b = a x b, made symmetric.
/// The faces look away from the air (out of the chamber). The rule is exact for both kinds of faces. For a closed wall
/// gradient and second gradient are those of V; for an open one the gradient is still the follower force, V is that of
/// the cone to a fixed point c, and they agree where the rim is held.
class ChamberSurface {
public:
    /// `rest` (3n): node positions at rest. Precondition: the wall passed Model::create.
    ChamberSurface(const Wall& wall, std::span<const double> rest);

    [[nodiscard]] double volume(std::span<const double> x) const;
    /// forces (3n) += factor * dV/dx.
    void add_gradient(std::span<const double> x, double factor, std::span<double> forces) const;
    /// The same without the mouths: the force on the robot. It differs only at nodes that the support of a mouth holds,
    /// along its normal; so does its derivative, which the following functions add.
    void add_force(std::span<const double> x, double factor, std::span<double> forces) const;
    /// values += factor * second gradient, for a pattern over free nodes (block 3) that holds cliques(). With
    /// `project`, each face adds the nearest positive semi-definite matrix instead.
    void add_hessian(std::span<const double> x, double factor, const std::vector<int>& free_index,
                     const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const;
    /// result (3n) += factor * (the skew part that symmetrising the second gradient drops) * v; zero for closed walls
    /// without mouths.
    void apply_skew(std::span<const double> x, double factor, std::span<const double> v,
                    std::span<double> result) const;
    /// The same part as a matrix: values += its blocks at and below the diagonal; those above are minus their
    /// transposes.
    void add_skew(std::span<const double> x, double factor, const std::vector<int>& index,
                  const linalg::SymmetricPattern& pattern, std::span<double> values) const;
    void append_cliques(const std::vector<int>& free_index, linalg::Lists& cliques) const;
    [[nodiscard]] bool has_mouths() const { return wall_.mouth_faces > 0; }

private:
    [[nodiscard]] std::vector<Vec3> points_at(std::span<const double> x) const;
    void add_gradient_of(std::span<const WallFace> faces, std::span<const double> x, double factor,
                         std::span<double> forces) const;
    void spread(std::span<const Vec3> on_points, std::span<double> on_nodes) const;
    /// Distributes the block of two wall points to the nodes that carry them.
    void add_pair(int first, int second, const linalg::Matrix3& block, const std::vector<int>& free_index,
                  const linalg::SymmetricPattern& pattern, std::span<double> values) const;

    Wall wall_;
    Vec3 centre_;
};

/// Points on edges that are not used once in each direction, ascending: the rim of an open wall.
[[nodiscard]] std::vector<int> rim_points(const Wall& wall);
[[nodiscard]] inline bool is_closed(const Wall& wall) {
    return rim_points(wall).empty();
}

}  // namespace pliant::sim

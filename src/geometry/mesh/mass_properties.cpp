#include "geometry/mesh/mass_properties.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pliant::mesh {

MassProperties mass_properties(const TriMesh& surface) {
    // Tetrahedra from a central point, to keep rounding errors small.
    const Vec3 apex = bounds(surface).center();
    MassProperties body;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    for (const auto& t : surface.triangles) {
        Eigen::Matrix3d arms;
        for (int k = 0; k < 3; ++k) {
            const Vec3 arm = surface.points[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])] - apex;
            arms.col(k) << arm.x, arm.y, arm.z;
        }
        const double volume = arms.determinant() / 6;
        const Eigen::Vector3d sum = arms.rowwise().sum();
        body.volume += volume;
        first += volume / 4 * sum;
        body.second_moment += volume / 20 * (sum * sum.transpose() + arms * arms.transpose());
    }
    const Eigen::Vector3d centre = first / body.volume;
    body.second_moment -= body.volume * centre * centre.transpose();
    body.centre = apex + Vec3{centre[0], centre[1], centre[2]};
    return body;
}

std::array<Vec3, 4> equal_mass_points(const MassProperties& body) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(body.second_moment / body.volume);
    const Eigen::Vector3d gyration = principal.eigenvalues().cwiseMax(0).cwiseSqrt();
    Eigen::Matrix3d axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    static constexpr std::array<std::array<int, 3>, 4> corners{{{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}};
    std::array<Vec3, 4> points;
    for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::Vector3d signs(corners[k][0], corners[k][1], corners[k][2]);
        const Eigen::Vector3d arm = axes * gyration.cwiseProduct(signs);
        points[k] = body.centre + Vec3{arm[0], arm[1], arm[2]};
    }
    return points;
}

}  // namespace pliant::mesh

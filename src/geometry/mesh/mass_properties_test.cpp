#include "geometry/mesh/mass_properties.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

/// A box of sides a, b, c from `low`.
TriMesh box(const Vec3& low, const Vec3& size) {
    TriMesh m;
    for (int k = 0; k < 8; ++k)
        m.points.push_back(low + Vec3{k & 1 ? size.x : 0, k & 2 ? size.y : 0, k & 4 ? size.z : 0});
    m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return m;
}

}  // namespace

TEST_CASE("volume, centre and second moments of a box, wherever it is") {
    for (const Vec3& low : {Vec3{0, 0, 0}, Vec3{300, -20, 7}}) {
        const MassProperties body = mass_properties(box(low, {2, 3, 4}));
        CHECK(body.volume == near(24, {.relative = 1e-12}));
        CHECK(norm(body.centre - (low + Vec3{1, 1.5, 2})) < 1e-12 * 300);
        const Eigen::Matrix3d wanted = 24.0 / 12 * Eigen::Vector3d(4, 9, 16).asDiagonal().toDenseMatrix();
        CHECK((body.second_moment - wanted).norm() < 1e-11 * wanted.norm());
    }
}

TEST_CASE("four points with a quarter of the mass each have the body's centre and second moments") {
    const MassProperties body = mass_properties(box({5, -1, 2}, {2, 3, 4}));
    Vec3 mean;
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (const Vec3& p : equal_mass_points(body)) {
        mean += 0.25 * p;
        const Vec3 arm = p - body.centre;
        const Eigen::Vector3d v(arm.x, arm.y, arm.z);
        moment += body.volume / 4 * v * v.transpose();
    }
    CHECK(norm(mean - body.centre) < 1e-14 * 10);
    CHECK((moment - body.second_moment).norm() < 1e-12 * moment.norm());
}

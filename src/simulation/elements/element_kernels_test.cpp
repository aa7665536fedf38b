// The SIMD kernels against the laws evaluated point by point, and rotating motions.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/core/near.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/material/response.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/solver/curvature.hpp"

using namespace pliant;
using namespace pliant::sim;
using linalg::Matrix3;

namespace {

/// 3 x 1 x 1 cells: 18 tets of three laws, so that no batch is full.
Description mixed(int order) {
    Description d;
    d.mesh = reference::kuhn_box({0.03, 0.01, 0.01}, 3, 1, 1, [](Vec3 c) { return static_cast<int>(c.x / 0.01); });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", material::neo_hookean(2e5, 0.45), 1000},
                   {"B", material::MooneyRivlin{3e4, 2e4, 1e6}, 1000},
                   {"C", material::Yeoh{3e4, -2e3, 4e2, 1e6}, 1000}};
    d.material_of_region = {0, 1, 2};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    return d;
}

std::vector<double> distorted(const mesh::TetMesh& mesh) {
    std::vector<double> x;
    for (const Vec3& p : mesh.points) x.insert(x.end(), {p.x, p.y, p.z});
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 8e-4 * std::sin(7.3 * static_cast<double>(i));
    return x;
}

double energy_one_by_one(const Elements& elements, std::span<const double> x) {
    double sum = 0;
    for (std::size_t t = 0; t < elements.tet_count(); ++t) {
        for (int q = 0; q < elements.points_per_tet(); ++q)
            sum += elements.point_volume(t, q) *
                   *material::energy(elements.law(t), elements.deformation_gradient(t, q, x));
    }
    return sum;
}

}  // namespace

TEST_CASE("the energy of eight tets at once agrees with the laws, forces and stiffness with its derivatives") {
    for (const int order : {1, 2}) {
        const auto model = Model::create(mixed(order));
        REQUIRE(model);
        const Elements& elements = model->elements();
        std::vector<double> x = distorted(model->mesh());
        std::vector<double> forces(x.size(), 0.0);
        const Elements::Evaluation e = elements.evaluate(x, forces);
        CHECK(e.min_J > 0.3);
        CHECK(e.min_J < 0.95);
        CHECK(e.energy_J == near(energy_one_by_one(elements, x), {.relative = 1e-12}));

        std::vector<double> direction(x.size());
        for (std::size_t i = 0; i < x.size(); ++i) direction[i] = std::cos(12.9898 * static_cast<double>(i));
        const double h = 1e-7;
        std::vector<double> ahead = x, behind = x, forces_ahead(x.size(), 0.0), forces_behind(x.size(), 0.0);
        for (std::size_t i = 0; i < x.size(); ++i) {
            ahead[i] += h * direction[i];
            behind[i] -= h * direction[i];
        }
        const double rise =
            elements.evaluate(ahead, forces_ahead).energy_J - elements.evaluate(behind, forces_behind).energy_J;
        double slope = 0;
        for (std::size_t i = 0; i < x.size(); ++i) slope += forces[i] * direction[i];
        CHECK(rise / (2 * h) == near(slope, {.relative = 1e-6}));

        std::vector<int> all_free(model->mesh().points.size());
        for (std::size_t i = 0; i < all_free.size(); ++i) all_free[i] = static_cast<int>(i);
        const auto pattern = linalg::make_pattern(model->node_count(), 3, elements.cliques(all_free));
        std::vector<double> stiffness(pattern.entries(), 0.0);
        elements.add_tangent(x, elements.block_sums(all_free, pattern), stiffness, false);
        std::vector<double> product(x.size(), 0.0);
        linalg::add_product(pattern, stiffness, direction, 1, product);
        double largest = 0, wrong = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double expected = (forces_ahead[i] - forces_behind[i]) / (2 * h);
            largest = std::max(largest, std::fabs(expected));
            wrong = std::max(wrong, std::fabs(expected - product[i]));
        }
        CHECK(wrong < 1e-6 * largest);
    }
}

TEST_CASE("the projected stiffness of eight tets at once agrees with the laws, projected point by point") {
    for (const int order : {1, 2}) {
        const auto model = Model::create(mixed(order));
        REQUIRE(model);
        const Elements& elements = model->elements();
        const std::vector<double> x = distorted(model->mesh());
        const auto bilinear = [&](const std::vector<double>& v, const std::vector<double>& w, bool project) {
            double sum = 0;
            for (std::size_t t = 0; t < elements.tet_count(); ++t) {
                for (int q = 0; q < elements.points_per_tet(); ++q) {
                    linalg::Matrix9 H = material::tangent(elements.law(t), elements.deformation_gradient(t, q, x));
                    if (project) H = linalg::with_positive_eigenvalues(H);
                    const Matrix3 dv = elements.deformation_gradient(t, q, v);
                    const Matrix3 dw = elements.deformation_gradient(t, q, w);
                    sum += elements.point_volume(t, q) * dv.reshaped().dot(H * dw.reshaped());
                }
            }
            return sum;
        };
        std::vector<int> all_free(model->mesh().points.size());
        for (std::size_t i = 0; i < all_free.size(); ++i) all_free[i] = static_cast<int>(i);
        const auto pattern = linalg::make_pattern(model->node_count(), 3, elements.cliques(all_free));
        std::vector<double> stiffness(pattern.entries(), 0.0);
        elements.add_tangent(x, elements.block_sums(all_free, pattern), stiffness, true);
        for (int k = 0; k < 6; ++k) {
            std::vector<double> v(x.size()), w(x.size()), product(x.size(), 0.0);
            for (std::size_t i = 0; i < x.size(); ++i) {
                v[i] = std::cos((12.9898 + k) * static_cast<double>(i));
                w[i] = k % 2 == 0 ? v[i] : std::sin((3.7 + k) * static_cast<double>(i));
            }
            linalg::add_product(pattern, stiffness, w, 1, product);
            double found = 0;
            for (std::size_t i = 0; i < x.size(); ++i) found += v[i] * product[i];
            const double size = bilinear(v, v, true);
            CHECK(std::fabs(found - bilinear(v, w, true)) < 1e-9 * size);
            // Otherwise nothing was negative, and the projection is not tested.
            if (k % 2 == 0) CHECK(bilinear(v, v, false) < 0.999 * size);
        }
    }
}

TEST_CASE("an inverted or NaN tet is detected in every SIMD lane") {
    const auto model = Model::create(mixed(1));
    REQUIRE(model);
    const std::vector<double> good = distorted(model->mesh());
    for (std::size_t tet = 0; tet < model->mesh().tet_count(); ++tet) {
        const auto nodes = model->mesh().tet(tet);
        std::vector<double> x = good;
        for (std::size_t k = 0; k < 3; ++k) {
            double opposite = 0;
            for (std::size_t a = 1; a < 4; ++a) opposite += good[3 * static_cast<std::size_t>(nodes[a]) + k] / 3;
            double& own = x[3 * static_cast<std::size_t>(nodes[0]) + k];
            own = opposite - 0.5 * (own - opposite);
        }
        CHECK_FALSE(model->elements().evaluate(x, {}).min_J > 0);
        x = good;
        x[3 * static_cast<std::size_t>(nodes[0])] = std::nan("");
        CHECK_FALSE(model->elements().evaluate(x, {}).min_J > 0);
    }
}

TEST_CASE("a linearised rigid rotation becomes the exact rotation") {
    for (const int order : {1, 2}) {
        Description d = mixed(order);
        d.supports = {{"point", {0}, {}}};
        const auto model = Model::create(std::move(d));
        REQUIRE(model);
        const Equilibrium system(*model);
        const FactoredLaplacian laplacian(system);
        const State rest = system.rest();
        const Eigen::Vector3d center = rest.x.head<3>();
        const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
        for (const double angle : {0.01, 0.3, 1.5}) {
            const Matrix3 turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
            Eigen::VectorXd straight = rest.x, turned = rest.x;
            for (int n = 0; n < model->node_count(); ++n) {
                const Eigen::Vector3d arm = rest.x.segment<3>(3 * n) - center;
                straight.segment<3>(3 * n) += angle * axis.cross(arm);
                turned.segment<3>(3 * n) = center + turn * arm;
            }
            const Eigen::VectorXd found = laplacian.rotate(system, {rest.x.data(), straight.data()});
            CHECK((found - turned).norm() < 1e-8 * rest.x.norm());

            // And on again, from where it came.
            const Eigen::VectorXd further =
                laplacian.rotate(system, {turned.data(), turned.data(), {rest.x.data()}, {0.5}});
            Eigen::VectorXd expected = rest.x;
            const Matrix3 half_again = Eigen::AngleAxisd(1.5 * angle, axis).toRotationMatrix();
            for (int n = 0; n < model->node_count(); ++n)
                expected.segment<3>(3 * n) = center + half_again * (rest.x.segment<3>(3 * n) - center);
            // The logarithm's series is cut: exact for small turns, a guess for large ones.
            if (angle < 1) CHECK((further - expected).norm() < 5e-4 * rest.x.norm());
        }
    }
}

TEST_CASE("a motion is extrapolated from the rotations between previous states") {
    Description d = mixed(1);
    d.supports = {{"point", {0}, {}}};
    const auto model = Model::create(std::move(d));
    REQUIRE(model);
    const Equilibrium system(*model);
    const FactoredLaplacian laplacian(system);
    const Eigen::VectorXd rest = system.rest().x;
    const auto turned = [&](double angle) {
        const Matrix3 Q = Eigen::AngleAxisd(angle, Eigen::Vector3d(2, 1, -1).normalized()).toRotationMatrix();
        Eigen::VectorXd x = rest;
        for (int n = 0; n < model->node_count(); ++n)
            x.segment<3>(3 * n) = rest.head<3>() + Q * (rest.segment<3>(3 * n) - rest.head<3>());
        return x;
    };
    // Angles t + t^2 + t^3 at t = 0, 0.1, 0.2, 0.3: by finite differences the rotation from 0.3 to 0.4 is three times
    // the last one, less three times the one before, plus the first.
    const auto angle = [](double t) { return t + t * t + t * t * t; };
    const Eigen::VectorXd a = turned(angle(0)), b = turned(angle(0.1)), c = turned(angle(0.2)),
                          now = turned(angle(0.3));
    const Eigen::VectorXd found = laplacian.rotate(
        system, {.now = now.data(), .end = now.data(), .past = {c.data(), b.data(), a.data()}, .weights = {3, -3, 1}});
    CHECK((found - turned(angle(0.4))).norm() < 1e-5 * rest.norm());
    // With only two previous rotations the error is the third difference.
    const Eigen::VectorXd less = laplacian.rotate(
        system, {.now = now.data(), .end = now.data(), .past = {c.data(), b.data()}, .weights = {2, -1}});
    CHECK((less - turned(angle(0.4) - 0.006)).norm() < 1e-5 * rest.norm());
}

// The SIMD kernels of shape-blend against the law evaluated point by point.
#include "simulation/elements/blend_kernels.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <numeric>

#include "base/core/near.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/material/response.hpp"
#include "simulation/peers/reference_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using linalg::Matrix3;
using linalg::Matrix9;

namespace {

/// 3 x 1 x 1 cells: 18 tets of two blends and a rigid one, so that no batch is full.
Model model_of_blends(int order) {
    Description d;
    d.mesh = reference::kuhn_box({0.03, 0.01, 0.01}, 3, 1, 1, [](Vec3 c) { return static_cast<int>(c.x / 0.01); });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"soft", material::shape_blend(2e5, 0.45), 1000},
                   {"firm", material::shape_blend(1e6, 0.2), 1000},
                   {"rigid", material::ShapeBlend{3e5, 1}, 1000}};
    d.material_of_region = {0, 1, 2};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    auto model = Model::create(std::move(d));
    REQUIRE(model);
    return std::move(*model);
}

/// Strongly rotated, stretched along x by `stretch`, and perturbed.
std::vector<double> turned_and_stretched(const mesh::TetMesh& mesh, double stretch) {
    std::vector<double> x;
    for (const Vec3& p : mesh.points) x.insert(x.end(), {-p.y, stretch * p.x, p.z});
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 2e-4 * std::sin(7.3 * static_cast<double>(i));
    return x;
}

std::vector<double> some_motion(std::size_t size, double pace) {
    std::vector<double> v;
    for (std::size_t i = 0; i < size; ++i) v.push_back(std::cos(pace * static_cast<double>(i)));
    return v;
}

}  // namespace

TEST_CASE("the forces of eight shape-blend tets at once agree with the law, at any stretch") {
    for (const int order : {1, 2}) {
        const Model model = model_of_blends(order);
        const Elements& elements = model.elements();
        for (const double stretch : {1.0, 0.3, 6.0, 60.0}) {
            const std::vector<double> x = turned_and_stretched(model.mesh(), stretch);
            std::vector<double> forces(x.size(), 0.0), expected(x.size(), 0.0);
            const Elements::Evaluation e = elements.evaluate(x, forces);
            double energy = 0;
            for (std::size_t t = 0; t < elements.tet_count(); ++t) {
                for (int q = 0; q < elements.points_per_tet(); ++q) {
                    const Matrix3 F = elements.deformation_gradient(t, q, x);
                    const double volume = elements.point_volume(t, q);
                    energy += volume * material::energy(elements.law(t), F).value_or(0);
                    const Matrix3 P = volume * material::stress(elements.law(t), F);
                    for (int a = 0; a < static_cast<int>(elements.nodes_per_tet()); ++a) {
                        const Vec3 g = elements.shape_gradient(t, q, a);
                        const Eigen::Vector3d f = P * Eigen::Vector3d(g.x, g.y, g.z);
                        for (int i = 0; i < 3; ++i)
                            expected[static_cast<std::size_t>(3 * elements.node_of(t, a) + i)] += f[i];
                    }
                }
            }
            const auto n = static_cast<Eigen::Index>(x.size());
            const Eigen::Map<const Eigen::VectorXd> found(forces.data(), n), wanted(expected.data(), n);
            CHECK((found - wanted).norm() < 1e-11 * wanted.norm());
            CHECK(e.energy_J / energy == near(1, {.relative = 1e-11}));
        }
    }
}

TEST_CASE("the stiffness of eight shape-blend tets at once is the symmetric part of the law's") {
    for (const int order : {1, 2}) {
        const Model model = model_of_blends(order);
        const Elements& elements = model.elements();
        std::vector<int> free(static_cast<std::size_t>(model.node_count()));
        std::iota(free.begin(), free.end(), 0);
        const auto pattern = linalg::make_pattern(model.node_count(), 3, elements.cliques(free));
        for (const double stretch : {1.0, 1.7}) {
            const std::vector<double> x = turned_and_stretched(model.mesh(), stretch);
            std::vector<double> stiffness(pattern.entries(), 0.0), product(x.size(), 0.0);
            elements.add_tangent(x, elements.block_sums(free, pattern), stiffness, false);
            const std::vector<double> v = some_motion(x.size(), 3.1), w = some_motion(x.size(), 1.7);
            linalg::add_product(pattern, stiffness, w, 1, product);
            double sum = 0, size = 0;
            for (std::size_t t = 0; t < elements.tet_count(); ++t) {
                for (int q = 0; q < elements.points_per_tet(); ++q) {
                    const Matrix9 H = material::tangent(elements.law(t), elements.deformation_gradient(t, q, x));
                    const Matrix3 dv = elements.deformation_gradient(t, q, v),
                                  dw = elements.deformation_gradient(t, q, w);
                    const double term = dv.reshaped().dot(0.5 * (H + H.transpose()) * dw.reshaped());
                    sum += elements.point_volume(t, q) * term;
                    size += elements.point_volume(t, q) * std::fabs(term);
                }
            }
            double found = 0;
            for (std::size_t i = 0; i < v.size(); ++i) found += v[i] * product[i];
            CHECK(std::fabs(found - sum) < 1e-11 * size);
        }
    }
}

TEST_CASE("an inverted or NaN tet of shape-blend is detected") {
    const Model model = model_of_blends(1);
    for (const double bad : {-0.5, std::nan("")}) {
        std::vector<double> x;
        for (const Vec3& p : model.mesh().points) x.insert(x.end(), {p.x, p.y, p.z});
        x[3 * static_cast<std::size_t>(model.mesh().tet(5)[2])] = bad;
        CHECK_FALSE(model.elements().evaluate(x, {}).min_J > 0);
    }
}

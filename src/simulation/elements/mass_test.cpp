// The mass matrix of tets and point masses.
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "base/core/near.hpp"
#include "base/linalg/simd_targets.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/peers/reference_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

constexpr double density = 1100, lump_kg = 0.02;

/// A bar of 3 x 1 x 1 cells, 18 tets, with a point mass between two of its nodes.
Description weighted_bar(int order) {
    Description d;
    d.mesh = reference::kuhn_box({0.03, 0.01, 0.01}, 3, 1, 1, [](Vec3) { return 0; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", material::neo_hookean(2e5, 0.45), density}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    PointMass mass;
    mass.point.nodes = {4, 9};
    mass.point.weights = {0.75, 0.25};
    mass.mass_kg = lump_kg;
    d.masses = {mass};
    return d;
}

std::vector<double> waves(std::size_t size) {
    std::vector<double> u(size);
    for (std::size_t i = 0; i < size; ++i) u[i] = std::sin(1 + 3.7 * static_cast<double>(i));
    return u;
}

}  // namespace

TEST_CASE("the assembled mass matrix is that of the products, and moves the whole mass") {
    for (const int order : {1, 2}) {
        const auto model = Model::create(weighted_bar(order));
        REQUIRE(model);
        const Elements& elements = model->elements();
        std::vector<int> index(model->mesh().points.size());
        std::iota(index.begin(), index.end(), 0);
        const auto pattern = linalg::make_pattern(model->node_count(), 3, elements.cliques(index));
        const double factor = 2.5;
        std::vector<double> values(pattern.entries(), 0.0);
        elements.add_mass(elements.block_sums(index, pattern), index, pattern, values, factor);

        const std::vector<double> u = waves(3 * index.size());
        std::vector<double> assembled(u.size(), 0.0);
        linalg::add_product(pattern, values, u, 1 / factor, assembled);
        linalg::on_each_simd_target([&](const char* target) {
            CAPTURE(target);
            std::vector<double> product(u.size(), 0.0);
            elements.apply_mass(u, product);
            for (std::size_t i = 0; i < u.size(); ++i)
                CHECK(product[i] == near(assembled[i], {.relative = 1e-12, .absolute = 1e-15}));
        });

        std::vector<double> along(u.size(), 0.0), momentum(u.size(), 0.0);
        for (std::size_t i = 1; i < along.size(); i += 3) along[i] = 1;
        linalg::add_product(pattern, values, along, 1 / factor, momentum);
        CHECK(std::accumulate(momentum.begin(), momentum.end(), 0.0) ==
              near(density * 0.03 * 0.01 * 0.01 + lump_kg, {.relative = 1e-12}));
    }
}

TEST_CASE("the mass of held nodes is left out of a matrix over the free ones") {
    const auto model = Model::create(weighted_bar(1));
    REQUIRE(model);
    const Elements& elements = model->elements();
    const std::vector<int>& index = model->free_index();
    const auto pattern = linalg::make_pattern(model->free_count(), 3, elements.cliques(index));
    std::vector<double> values(pattern.entries(), 0.0);
    elements.add_mass(elements.block_sums(index, pattern), index, pattern, values, 1);

    std::vector<double> all = waves(3 * index.size()), free(3 * static_cast<std::size_t>(model->free_count()));
    for (std::size_t node = 0; node < index.size(); ++node) {
        for (std::size_t i = 0; i < 3; ++i) {
            double& u = all[3 * node + i];
            if (index[node] < 0)
                u = 0;
            else
                free[3 * static_cast<std::size_t>(index[node]) + i] = u;
        }
    }
    std::vector<double> product(all.size(), 0.0), of_free(free.size(), 0.0);
    elements.apply_mass(all, product);
    linalg::add_product(pattern, values, free, 1, of_free);
    for (std::size_t node = 0; node < index.size(); ++node) {
        for (std::size_t i = 0; index[node] >= 0 && i < 3; ++i)
            CHECK(of_free[3 * static_cast<std::size_t>(index[node]) + i] ==
                  near(product[3 * node + i], {.relative = 1e-12, .absolute = 1e-15}));
    }
}

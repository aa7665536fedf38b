// Rigid plates: derivatives, and a plate that stays flat where the body alone would not.
#include "simulation/elements/plate.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

#include "base/core/near.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

std::vector<double> some_positions(std::size_t nodes) {
    std::vector<double> x(3 * nodes);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(1.7 * static_cast<double>(i * i) + 0.3);
    return x;
}

}  // namespace

TEST_CASE("a rigidly moved plate has no energy; gradient and Hessian agree with finite differences") {
    const std::size_t count = 7;
    const std::vector<double> rest = some_positions(count);
    std::vector<int> nodes(count);
    std::iota(nodes.begin(), nodes.end(), 0);
    const Plate plate(nodes, 3.0, rest);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    std::vector<double> x(rest.size());
    for (std::size_t i = 0; i < count; ++i) {
        Eigen::Map<Eigen::Vector3d>(x.data() + 3 * i) =
            turn * Eigen::Map<const Eigen::Vector3d>(rest.data() + 3 * i) + Eigen::Vector3d(4, 5, 6);
    }
    CHECK(plate.energy(x) < 1e-25);

    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 0.1 * std::cos(5.1 * static_cast<double>(i));
    std::vector<int> free_index = nodes;
    linalg::Lists cliques;
    plate.append_clique(free_index, cliques);
    const auto pattern = linalg::make_pattern(static_cast<int>(count), 3, cliques);
    std::vector<double> hessian(pattern.entries(), 0.0);
    plate.add_hessian(x, free_index, pattern, hessian, false);
    std::vector<double> gradient(x.size(), 0.0);
    plate.add_gradient(x, gradient);
    const double h = 1e-6;
    for (int column = 0; column < pattern.size(); ++column) {
        std::vector<double> ahead = x;
        std::vector<double> behind = x;
        ahead[static_cast<std::size_t>(column)] += h;
        behind[static_cast<std::size_t>(column)] -= h;
        CHECK((plate.energy(ahead) - plate.energy(behind)) / (2 * h) ==
              near(gradient[static_cast<std::size_t>(column)], {.relative = 1e-6}));
        std::vector<double> up(x.size(), 0.0);
        std::vector<double> down(x.size(), 0.0);
        plate.add_gradient(ahead, up);
        plate.add_gradient(behind, down);
        std::vector<double> direction(x.size(), 0.0);
        direction[static_cast<std::size_t>(column)] = 1;
        std::vector<double> product(x.size(), 0.0);
        linalg::add_product(pattern, hessian, direction, 1, product);
        for (std::size_t row = 0; row < x.size(); ++row)
            CHECK(std::fabs((up[row] - down[row]) / (2 * h) - product[row]) < 1e-6);
    }
}

TEST_CASE("the projected Hessian of a plate has no negative eigenvalues, and is the exact one where that has none") {
    for (const bool flat : {false, true}) {
        for (const double stretch : {0.7, 1.0, 1.3}) {
            CAPTURE(flat);
            CAPTURE(stretch);
            const std::size_t count = 6;
            std::vector<double> rest = some_positions(count);
            for (std::size_t i = 0; flat && i < count; ++i) rest[3 * i + 2] = 0;
            std::vector<int> nodes(count);
            std::iota(nodes.begin(), nodes.end(), 0);
            const Plate plate(nodes, 3.0, rest);
            std::vector<double> x = rest;
            for (double& value : x) value *= stretch;
            linalg::Lists cliques;
            plate.append_clique(nodes, cliques);
            const auto pattern = linalg::make_pattern(static_cast<int>(count), 3, cliques);
            const auto hessian = [&](bool project) {
                std::vector<double> values(pattern.entries(), 0.0);
                plate.add_hessian(x, nodes, pattern, values, project);
                Eigen::MatrixXd dense(pattern.size(), pattern.size());
                for (int column = 0; column < pattern.size(); ++column) {
                    std::vector<double> unit(x.size(), 0.0), product(x.size(), 0.0);
                    unit[static_cast<std::size_t>(column)] = 1;
                    linalg::add_product(pattern, values, unit, 1, product);
                    dense.col(column) = Eigen::Map<const Eigen::VectorXd>(product.data(), pattern.size());
                }
                return dense;
            };
            const Eigen::MatrixXd exact = hessian(false), projected = hessian(true);
            const auto lowest = [](const Eigen::MatrixXd& matrix) {
                return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues()[0];
            };
            CHECK(lowest(projected) > -1e-12);
            if (stretch < 1)
                CHECK(lowest(exact) < -0.1);
            else
                CHECK((exact - projected).norm() < 1e-9);
        }
    }
}

TEST_CASE("a bar squeezed between a clamp and a plate: the plate's face keeps its shape") {
    constexpr double side = 0.01;
    for (const int order : {1, 2}) {
        Description d;
        d.mesh = reference::kuhn_box({3 * side, side, side}, 6, 2, 2, [](Vec3) { return 0; });
        if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
        d.materials = {{"A", material::neo_hookean(1e6, 0.45), 1000}};
        d.material_of_region = {0};
        d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
        const auto face = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 3 * side - 1e-9; });
        // The whole force on one corner: without a plate it would be pulled out.
        const auto corner = reference::nodes_where(d.mesh, [](Vec3 p) {
            return norm(p - Vec3{3 * side, 0, 0}) < 1e-9;
        });
        d.loads = {{"pull", corner, {1.0}, {20, 0, 0}}};
        d.plates = {{"end", face}};
        auto model = Model::create(d);
        REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
        Progress silent;
        const Trajectory result = run(*model, {.steps = 3, .tolerance = 1e-6}, silent);
        REQUIRE_MESSAGE(result.converged, result.message);
        const auto& now = result.steps.back().positions;
        double largest = 0;
        for (const int a : face) {
            for (const int b : face) {
                const double rest = norm(d.mesh.points[a] - d.mesh.points[b]);
                largest = std::max(largest, std::fabs(norm(now[a] - now[b]) - rest));
            }
        }
        CHECK(largest < 2e-3 * side);
        CHECK(norm(now[face[0]] - d.mesh.points[face[0]]) > 0.05 * side);
    }
}

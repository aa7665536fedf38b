// A torque on nodes that move as one: its forces, and their change.
#include "simulation/actuators/torque.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <vector>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::sim;

TEST_CASE("the forces of a torque sum to zero and rotate with the body, and the tangent agrees with differences") {
    std::vector<double> x = {0, 0, 0, 1, 0.1, 0, 0.2, 1.3, 0.1, 0.4, 0.3, 0.9, -0.5, 0.2, 0.4};
    const Eigen::Index size = static_cast<Eigen::Index>(x.size());
    const linalg::Vector3 torque(0.3, -0.7, 1.1);
    const TorqueForces forces({0, 1, 2, 3, 4});
    const auto on = [&] {
        std::vector<double> f(x.size(), 0.0);
        forces.subtract_from(x, torque, f);
        return f;
    };
    const std::vector<double> here = on();
    linalg::Vector3 sum = linalg::Vector3::Zero(), moment = linalg::Vector3::Zero();
    for (std::size_t k = 0; k < x.size(); k += 3) {
        const linalg::Vector3 f(here[k], here[k + 1], here[k + 2]), p(x[k], x[k + 1], x[k + 2]);
        sum -= f;
        moment -= p.cross(f);
    }
    CHECK(sum.norm() < 1e-12);
    CHECK((moment - torque).norm() < 1e-12);

    const std::vector<int> index = {0, 1, 2, 3, 4};
    linalg::Lists cliques;
    forces.append_clique(index, cliques);
    const linalg::SymmetricPattern pattern = linalg::make_pattern(5, 3, cliques);
    std::vector<double> symmetric(pattern.entries(), 0.0), skew(pattern.entries(), 0.0);
    forces.add_tangent(x, torque, TorqueForces::Part::symmetric, index, pattern, symmetric);
    forces.add_tangent(x, torque, TorqueForces::Part::skew, index, pattern, skew);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
    for (int j = 0; j < 5; ++j) {
        for (int k = pattern.node_start[static_cast<std::size_t>(j)];
             k < pattern.node_start[static_cast<std::size_t>(j) + 1]; ++k) {
            const int i = pattern.node_row[static_cast<std::size_t>(k)];
            for (int c = 0; c < 3; ++c) {
                for (int r = 0; r < 3; ++r) {
                    const std::size_t at = static_cast<std::size_t>(9 * k + 3 * c + r);
                    if (i == j && r < c) continue;
                    K(3 * i + r, 3 * j + c) = symmetric[at] + skew[at];
                    if (i != j || r != c) K(3 * j + c, 3 * i + r) = symmetric[at] - skew[at];
                }
            }
        }
    }
    for (Eigen::Index k = 0; k < size; ++k) {
        const double step = 1e-6, before = x[static_cast<std::size_t>(k)];
        x[static_cast<std::size_t>(k)] = before + step;
        const std::vector<double> up = on();
        x[static_cast<std::size_t>(k)] = before - step;
        const std::vector<double> down = on();
        x[static_cast<std::size_t>(k)] = before;
        for (Eigen::Index i = 0; i < size; ++i)
            CHECK((up[static_cast<std::size_t>(i)] - down[static_cast<std::size_t>(i)]) / (2 * step) ==
                  near(K(i, k), {.absolute = 1e-7}));
    }
}

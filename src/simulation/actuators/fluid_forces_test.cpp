// Fluid forces against differences of their energies, and their tangents against differences of the forces.
#include "simulation/actuators/fluid_forces.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "base/linalg/vectors.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// A lopsided tetrahedron, part of it above z = 0.
const std::vector<double> corners = {0, 0, -0.5, 1, 0.1, -0.4, 0.2, 1.1, -0.3, 0.3, 0.2, 0.7};
const std::vector<std::array<int, 3>> faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

using Matrix = Eigen::Matrix<double, 12, 12>;

template <class Force, class Visit>
void compare(std::vector<double> x, const Force& force, const Visit& visit) {
    Matrix H = Matrix::Zero();
    visit(x, [&](int i, int j, const linalg::Matrix3& block) { H.block<3, 3>(3 * i, 3 * j) += block; });
    CHECK((H - H.transpose()).norm() < 1e-9 * H.norm());
    const double step = 1e-6;
    for (std::size_t k = 0; k < x.size(); ++k) {
        std::vector<double> up(12, 0.0), down(12, 0.0);
        const double here = x[k];
        x[k] = here + step;
        force(x, up);
        x[k] = here - step;
        force(x, down);
        x[k] = here;
        for (std::size_t i = 0; i < 12; ++i)
            CHECK((up[i] - down[i]) / (2 * step) ==
                  near(H(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)), {.absolute = 1e-6 * H.norm()}));
    }
}

}  // namespace

TEST_CASE("a hole in the skin feels no pressure, and the rest that of its own depth") {
    const FluidForces::Gravity gravity{{0, 0, -9.81}};
    Fluid fluid{1000, 0, 0, {}, {}, {}};
    fluid.level_m = 2;
    const auto sum_of = [&](const FluidForces& forces) {
        std::vector<double> on(12, 0.0);
        forces.add_buoyancy(corners, gravity, on);
        linalg::Vector3 sum = linalg::Vector3::Zero();
        for (std::size_t k = 0; k < 4; ++k) sum += linalg::Vector3(on[3 * k], on[3 * k + 1], on[3 * k + 2]);
        return sum;
    };
    const linalg::Vector3 closed = sum_of(FluidForces(fluid, faces));
    for (std::size_t hole = 0; hole < faces.size(); ++hole) {
        std::vector<std::array<int, 3>> rest = faces;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(hole));
        const auto at = [&](int i) { return linalg::view(std::span<const double>(corners), faces[hole][i]); };
        const linalg::Vector3 area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0));
        const double depth = 2 - (at(0) + at(1) + at(2)).z() / 3;
        CHECK((sum_of(FluidForces(fluid, rest)) - closed + 1000 * 9.81 * depth * area).norm() < 1e-9 * closed.norm());
    }
}

TEST_CASE("buoyancy is the derivative of the displaced water's energy") {
    const FluidForces::Gravity gravity{{0.5, -1, -9}};
    for (const bool level : {false, true}) {
        Fluid fluid{1000, 0, 0, {}, {}, {}};
        if (level) fluid.level_m = 0.05;
        const FluidForces forces(fluid, faces);
        std::vector<double> x = corners, on(12, 0.0);
        forces.add_buoyancy(x, gravity, on);
        for (std::size_t k = 0; k < 12; ++k) {
            const double step = 1e-6, here = x[k];
            x[k] = here + step;
            const double up = forces.buoyancy_energy(x, gravity);
            x[k] = here - step;
            const double down = forces.buoyancy_energy(x, gravity);
            x[k] = here;
            CHECK(on[k] == near((up - down) / (2 * step), {.absolute = 1e-3}));
        }
        compare(
            x, [&](const std::vector<double>& at, std::vector<double>& f) { forces.add_buoyancy(at, gravity, f); },
            [&](const std::vector<double>& at, const FluidForces::Blocks& visit) {
                forces.visit_buoyancy(at, gravity, false, visit);
            });
        if (level) continue;
        // Fully submerged: the weight of the displaced volume, upwards.
        linalg::Vector3 sum = linalg::Vector3::Zero();
        for (std::size_t k = 0; k < 4; ++k) sum += linalg::Vector3(on[3 * k], on[3 * k + 1], on[3 * k + 2]);
        Eigen::Matrix3d arms;
        for (int k = 0; k < 3; ++k) {
            for (int c = 0; c < 3; ++c)
                arms(c, k) = corners[static_cast<std::size_t>(3 * k + 3 + c)] - corners[static_cast<std::size_t>(c)];
        }
        const double volume = arms(0, 0) * (arms(1, 1) * arms(2, 2) - arms(2, 1) * arms(1, 2)) -
                              arms(0, 1) * (arms(1, 0) * arms(2, 2) - arms(2, 0) * arms(1, 2)) +
                              arms(0, 2) * (arms(1, 0) * arms(2, 1) - arms(2, 0) * arms(1, 1));
        CHECK((sum - 1000 * volume / 6 * gravity.full_m_s2).norm() < 1e-9 * sum.norm());
    }
}

TEST_CASE("drag is the gradient of its potential, and dissipates energy") {
    Fluid fluid{1000, 0.7, 0.2, {}, {}, {}};
    fluid.current_m_s = {0.1, -0.2, 0.05};
    const FluidForces forces(fluid, faces);
    const double rate = 40;
    std::vector<double> x = corners;
    for (std::size_t k = 0; k < 12; ++k) x[k] += 0.01 * std::sin(3.0 * static_cast<double>(k));
    const auto velocity = [&](const std::vector<double>& at) {
        std::vector<double> v(12);
        for (std::size_t k = 0; k < 12; ++k) v[k] = rate * (at[k] - corners[k]);
        return v;
    };
    compare(
        x,
        [&](const std::vector<double>& at, std::vector<double>& f) {
            const std::vector<double> v = velocity(at);
            forces.add_drag({corners, v, rate, {}}, f);
        },
        [&](const std::vector<double>& at, const FluidForces::Blocks& visit) {
            const std::vector<double> v = velocity(at);
            forces.visit_drag({corners, v, rate, {}}, visit);
        });
    std::vector<double> on(12, 0.0);
    const std::vector<double> v = velocity(x);
    forces.add_drag({corners, v, rate, {}}, on);
    const auto energy = [&](std::vector<double> at, std::size_t k, double by) {
        at[k] += by;
        const std::vector<double> w = velocity(at);
        return forces.drag_energy({corners, w, rate, {}});
    };
    double power = 0;  // against the current: that of the force on what moves beside it
    for (std::size_t k = 0; k < 12; ++k) {
        CHECK(on[k] == near((energy(x, k, 1e-7) - energy(x, k, -1e-7)) / 2e-7, {.absolute = 1e-4}));
        power += on[k] * (v[k] - fluid.current_m_s[k % 3]);
    }
    CHECK(power > 0);  // `on` is the resistance, minus the force on the body
}

TEST_CASE("where the level is, and so what the drag acts on, does not depend on the share of gravity") {
    Fluid fluid{1000, 0.7, 0.2, {}, {}, {}};
    fluid.level_m = 0.05;
    const FluidForces forces(fluid, faces);
    std::vector<double> v(12, 0.0);
    for (std::size_t k = 0; k < 4; ++k) v[3 * k] = 1;
    const linalg::Vector3 full(0, 0, -9.81);
    const auto drag = [&](double share) { return forces.drag_energy({corners, v, 40, {full, share}}); };
    CHECK(drag(1) > 0);
    for (const double share : {0.0, 0.5, -1.0}) {
        CAPTURE(share);
        CHECK(drag(share) == drag(1));
        CHECK(forces.buoyancy_energy(corners, {full, share}) ==
              near(share * forces.buoyancy_energy(corners, {full, 1}), {.absolute = 1e-12}));
    }
}

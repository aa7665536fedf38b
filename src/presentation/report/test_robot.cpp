#include "presentation/report/test_robot.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace pliant::report::test {
namespace {

constexpr std::array<int, 3> cells = {20, 4, 3};
constexpr Vec3 size_m = {0.1, 0.02, 0.015};

/// Six tets per cell around the diagonal, so that neighbouring cells fit (Kuhn's subdivision).
mesh::TetMesh bar() {
    mesh::TetMesh mesh;
    const auto index = [](int i, int j, int k) { return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i; };
    for (int k = 0; k <= cells[2]; ++k) {
        for (int j = 0; j <= cells[1]; ++j) {
            for (int i = 0; i <= cells[0]; ++i) {
                mesh.points.push_back({size_m.x * i / cells[0], size_m.y * j / cells[1], size_m.z * k / cells[2]});
            }
        }
    }
    static constexpr std::array<std::array<int, 3>, 6> orders = {
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    for (int cell = 0; cell < cells[0] * cells[1] * cells[2]; ++cell) {
        const std::array<int, 3> at = {cell % cells[0], cell / cells[0] % cells[1], cell / (cells[0] * cells[1])};
        for (std::size_t o = 0; o < 6; ++o) {
            std::array<int, 3> corner = at;
            std::array<int, 4> tet = {index(corner[0], corner[1], corner[2])};
            for (std::size_t s = 0; s < 3; ++s) {
                ++corner[static_cast<std::size_t>(orders[o][s])];
                tet[s + 1] = index(corner[0], corner[1], corner[2]);
            }
            if (o >= 3) std::swap(tet[1], tet[2]);  // odd permutations invert the tet
            mesh.nodes.insert(mesh.nodes.end(), tet.begin(), tet.end());
            mesh.region.push_back(at[0] < cells[0] * 3 / 5 ? 0 : 1);
        }
    }
    mesh.region_names = {"grip", "tip"};
    return mesh;
}

/// The bar's axis at half height becomes an arc of `angle` radians in the xz-plane.
Vec3 bent(const Vec3& p, double angle) {
    if (angle == 0) return p;
    const double radius = size_m.x / angle, phi = p.x / radius, r = radius - (p.z - size_m.z / 2);
    return {r * std::sin(phi), p.y, size_m.z / 2 + radius - r * std::cos(phi)};
}

sim::Step step_at(int index, int steps) {
    sim::Step step;
    step.index = index;
    step.time = static_cast<double>(index) / steps;
    step.solver = index == 0 ? sim::Solver::automatic : sim::Solver::newton;
    step.iterations = index == 0 ? 0 : 5 + index % 3;
    step.residual = index == 0 ? 0 : 3.5e-5 / index;
    step.wall_s = index == 0 ? 0 : 0.012;
    step.min_J = 1 - 0.02 * step.time;
    return step;
}

}  // namespace

Simulation Robot::simulation() const {
    const auto fields = [this](std::span<const Vec3> positions) {
        sim::Fields out;
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            const auto n = mesh.tet(t);
            Vec3 rest, now;
            for (std::size_t i = 0; i < 4; ++i) {
                rest += 0.25 * mesh.points[static_cast<std::size_t>(n[i])];
                now += 0.25 * positions[static_cast<std::size_t>(n[i])];
            }
            const double strain = std::abs(rest.z - size_m.z / 2) * norm(now - rest) / 0.01;
            out.J.push_back(1);
            out.von_mises_Pa.push_back(12e6 * strain);
            out.max_stretch.push_back(1 + strain);
            out.energy_density_Pa.push_back(6e6 * strain * strain);
        }
        return out;
    };
    return {"bent bar",
            mesh,
            {{"ninjaflex", "neo-Hookean, E 12 MPa, Poisson ratio 0.45", "semi-flex", 1040, {}},
             {"cheetah", "neo-Hookean, E 45 MPa, Poisson ratio 0.45", "flex", 1100, {}}},
            {0, 1},
            result,
            fields,
            cable_points,
            {},
            {},
            1e-4,
            123.5,
            {{"steps", "10"}, {"solver", "newton"}}};
}

Robot bent_bar(int steps, int order) {
    Robot robot;
    robot.mesh = order == 2 ? mesh::to_quadratic(bar()) : bar();
    robot.result.solver = "newton";
    robot.result.setup_s = 0.25;
    robot.result.solve_s = 0.5;
    const double full = std::numbers::pi / 2, height = 0.0125;
    for (int i = 0; i <= steps; ++i) {
        sim::Step step = step_at(i, steps);
        const double angle = full * step.time;
        std::vector<Vec3> positions;
        for (const Vec3& p : robot.mesh.points) positions.push_back(bent(p, angle));
        step.positions = std::move(positions);
        std::vector<Vec3> cable = {{-0.02, 0.01, height}};
        for (int k = 0; k <= 8; ++k) cable.push_back(bent({size_m.x * k / 8, 0.01, height}, angle));
        double length = 0;
        for (std::size_t k = 0; k + 1 < cable.size(); ++k) length += norm(cable[k + 1] - cable[k]);
        step.cables = {{"flexor", length / 0.12, length, 71 * step.time}};
        step.supports = {{"base", {-71 * step.time, 0, 0.5}}};
        step.markers = {{"tip", bent({0.1, 0.01, 0.0075}, angle)}, {"middle", bent({0.05, 0.01, 0.0075}, angle)}};
        robot.cable_points.push_back({cable});
        for (int k = 0; k <= step.iterations && i > 0; ++k)
            robot.result.iterations.push_back({.step = i,
                                               .time = step.time,
                                               .solver = step.solver,
                                               .iteration = k,
                                               .residual = std::pow(10, -k),
                                               .alpha = k == 0 ? 0.0 : 1.0});
        robot.result.steps.push_back(std::move(step));
    }
    return robot;
}

}  // namespace pliant::report::test

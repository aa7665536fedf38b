// Gradients with respect to rest positions, guide points and single tets, and changes along any direction, against
// slightly different robots that are converged anew.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "base/core/near.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/actuators/loads.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/gradient/test_reconverged.hpp"
#include "simulation/gradient/variation.hpp"
#include "simulation/material/law_parameters.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

constexpr double time_of_all = 0.5;

Description moved_rest(Description d, const Eigen::VectorXd& motion, double step) {
    for (std::size_t n = 0; n < d.mesh.points.size(); ++n) {
        for (std::size_t c = 0; c < 3; ++c) d.mesh.points[n][c] += step * motion[static_cast<Eigen::Index>(3 * n + c)];
    }
    for (Load& load : d.loads)
        if (!load.faces.empty()) load.shares = surface_shares(d.mesh, load.faces).shares;
    return d;
}

/// A converged robot with all that can be measured on it.
struct SettledRobot {
    Case c;
    Linearisation at;
    std::vector<Measure> measures;
    std::vector<Slope> slopes;
    explicit SettledRobot(const Description& d)
        : c(d),
          at(c.at(settled_from(c.system, c.system.controls(time_of_all), c.system.rest()),
                  c.system.controls(time_of_all))),
          measures(all_measures(d)) {
        for (const Measure& m : measures) slopes.push_back(slope(at, m));
    }
    [[nodiscard]] Eigen::VectorXd sizes() const { return sizes_of(at, slopes); }
    [[nodiscard]] Eigen::VectorXd values_of_robot(const Description& other) const {
        const Case made(other);
        return values_of(made.system, made.system.controls(time_of_all), at.state(), measures);
    }
    /// One derivative of each measure.
    [[nodiscard]] Eigen::VectorXd told(const By& by, const std::function<double(const Variation&)>& of) {
        Eigen::VectorXd all(static_cast<Eigen::Index>(slopes.size()));
        for (std::size_t k = 0; k < slopes.size(); ++k) {
            const auto variation = gradient(at, slopes[k], by);
            REQUIRE_MESSAGE(variation, variation.error().message);
            all[static_cast<Eigen::Index>(k)] = of(*variation);
        }
        return all;
    }
};

/// Cable, chamber and springs on a hollow block under gravity, with all targets relative to rest.
Description shaped(int order, const CableTarget& cable, const ChamberTarget& chamber) {
    Description d = block(order, material::neo_hookean(1e6, 0.4));
    d.cables = {flexor(d.mesh, cable)};
    d.chambers[0].target = chamber;
    d.springs = {{"free", {d.cables[0].points[0], d.cables[0].points[2]}, 30}};
    std::vector<mesh::Face> top;
    for (const mesh::Face& face : mesh::boundary_faces(d.mesh)) {
        const auto is_up = [&](int node) { return d.mesh.points[static_cast<std::size_t>(node)].z > edge - 1e-9; };
        if (std::all_of(face.nodes.begin(), face.nodes.begin() + 3, is_up)) top.push_back(face);
    }
    const SurfaceShares shares = surface_shares(d.mesh, top);
    d.loads = {{"on top", shares.nodes, shares.shares, {0.1, 0.2, -0.3}, ramp(0, 1), top}};
    d.gravity_m_s2 = {0, 3, -9.81};
    d.supports[0].turn = {0.1, {1, 2, 0}, {0, 0, edge}};
    d.markers = {{"tip", d.cables[0].points.back()}};
    return d;
}

using CableKind = CableTarget::Kind;
using ChamberKind = ChamberTarget::Kind;

}  // namespace

TEST_CASE("gradients by rest positions, for targets as ratio, change and value") {
    const std::vector<std::pair<CableTarget, ChamberTarget>> wanted = {
        {{CableKind::length_ratio, 0.95}, {ChamberKind::gas_ratio, 1.3}},
        {{CableKind::shortening_m, 0.1 * edge}, {ChamberKind::volume_ratio, 1.2}},
        {{CableKind::tension_N, 0.8}, {ChamberKind::volume_change_m3, 2e-8}},
    };
    double worst = 0;
    for (const int order : {1, 2}) {
        for (const auto& [cable, chamber] : wanted) {
            if (order == 2 && cable.kind != CableKind::length_ratio) continue;
            const Description d = shaped(order, cable, chamber);
            SettledRobot robot(d);
            Noise noise(4);
            const Eigen::VectorXd motion = noise.vector(robot.at.state().x.size());
            const By by{.inputs = false, .parameters = false, .rest = true};
            const double error = gradient_error(
                robot.told(by, [&](const Variation& v) { return v.rest.dot(motion); }), robot.sizes(), 0.1 * edge,
                [&](double change) { return robot.values_of_robot(moved_rest(d, motion, change)); });
            CHECK(error < 1e-6);
            worst = std::max(worst, error);
        }
    }
    MESSAGE("rest positions: ", worst);
}

TEST_CASE("gradients by rest positions of a robot with gap elements") {
    Description d = plain();
    d.materials.push_back({"gap", gap_law(1e6), 0});
    d.cables = {flexor(d.mesh, {CableKind::length_ratio, 0.99})};
    d.mesh.region_names = {"solid", "gap"};
    d.material_of_region = {0, 1};
    for (std::size_t t = 0; t < 5; ++t) d.mesh.region[t + 20] = 1;
    d.growths = {{1, {0.8, 0.6, 0}, 0, 1e5, edge, {1.5 * edge, 0.5 * edge, 0.9 * edge}}};
    d.markers = {{"tip", d.cables[0].points.back()}};
    SettledRobot robot(d);
    Noise noise(4);
    const Eigen::VectorXd motion = noise.vector(robot.at.state().x.size());
    CHECK(gradient_error(robot.told({.inputs = false, .parameters = false, .rest = true},
                                    [&](const Variation& v) { return v.rest.dot(motion); }),
                         robot.sizes(), 0.1 * edge,
                         [&](double change) { return robot.values_of_robot(moved_rest(d, motion, change)); }) < 1e-6);
}

TEST_CASE("gradients by guide points: in a tet, spread over a patch, fixed in space; both orders") {
    double worst = 0;
    for (const int order : {1, 2}) {
        Description d = shaped(order, {CableKind::length_ratio, 0.95}, {ChamberKind::gas_ratio, 1.2});
        d.springs.clear();
        const std::array<Vec3, 3> points = {Vec3{-0.2 * edge, 0.5 * edge, 1.1 * edge},
                                            {1.45 * edge, 0.62 * edge, 0.93 * edge},
                                            {2.8 * edge, 0.45 * edge, 0.92 * edge}};
        // With quadratic tets the patch would have more nodes than an attachment takes, and would change them as it
        // moves.
        const double radius = order == 1 ? 0.5 * edge : 0;
        const auto cable_of = [&](const std::array<Vec3, 3>& at) {
            const Attacher attacher(d.mesh);
            Cable cable = d.cables[0];
            cable.points = {{{}, {}, at[0]}, *attacher.carried_by_tet(at[1], 0), *attacher.spread(at[2], radius, 0)};
            return cable;
        };
        d.cables = {cable_of(points)};
        const Attacher attacher(d.mesh);
        By by{.inputs = false, .parameters = false};
        by.guides = {
            {0, 0, {}}, {0, 1, *attacher.slope(points[1], 0, 0)}, {0, 2, *attacher.slope(points[2], radius, 0)}};
        SettledRobot robot(d);
        for (Eigen::Index k = 0; k < 9; ++k) {
            CAPTURE(k);
            const double error =
                gradient_error(robot.told(by, [&](const Variation& v) { return v.guides[k]; }), robot.sizes(),
                               0.05 * edge, [&](double change) {
                                   Description other = d;
                                   std::array<Vec3, 3> moved = points;
                                   moved[static_cast<std::size_t>(k / 3)][static_cast<std::size_t>(k % 3)] += change;
                                   other.cables = {cable_of(moved)};
                                   return robot.values_of_robot(other);
                               });
            CHECK(error < 1e-6);
            worst = std::max(worst, error);
        }
    }
    MESSAGE("guide points: ", worst);
}

/// A block whose cable has drawn its own end onto a point in space that it continues from, and a spring likewise.
Description met_ends(const std::array<Vec3, 3>& cable, const std::array<Vec3, 3>& spring) {
    Description d = plain();
    const Attacher attacher(d.mesh);
    const auto path = [&](const std::array<Vec3, 3>& at) {
        return std::vector<Attachment>{
            *attacher.carried_by_tet(at[0], 0), {{}, {}, at[1]}, *attacher.carried_by_tet(at[2], 0)};
    };
    d.cables = {{"c", path(cable), {CableKind::tension_N, 4}}};
    d.springs = {{"s", path(spring), 400, 0.2 * edge}};
    d.markers = {{"tip", *attacher.carried_by_tet({2.6 * edge, 0.42 * edge, 0.83 * edge}, 0)}};
    return d;
}

TEST_CASE("gradients by rest positions and guide points where segment ends of a cable and a spring meet") {
    const std::array<Vec3, 3> cable = {Vec3{2.9 * edge, 0.5 * edge, 0.98 * edge},
                                       {2.88 * edge, 0.5 * edge, 1.0 * edge},
                                       {1.45 * edge, 0.62 * edge, 0.93 * edge}};
    const std::array<Vec3, 3> spring = {Vec3{2.3 * edge, 0.1 * edge, 0.02 * edge},
                                        {2.28 * edge, 0.12 * edge, 0.03 * edge},
                                        {1.2 * edge, 0.13 * edge, 0.07 * edge}};
    const Description d = met_ends(cable, spring);
    SettledRobot robot(d);
    const auto x = linalg::view(robot.at.state().x);
    const Eigen::VectorXd rest = robot.c.system.rest().x;
    REQUIRE(robot.c.system.actuators()[0].cable().closed_segment(x) == 0);
    REQUIRE(CablePath(d.springs[0].points, linalg::view(rest)).closed_segment(x) == 0);
    Noise noise(4);
    const Eigen::VectorXd motion = noise.vector(robot.at.state().x.size());
    CHECK(gradient_error(robot.told({.inputs = false, .parameters = false, .rest = true},
                                    [&](const Variation& v) { return v.rest.dot(motion); }),
                         robot.sizes(), 0.01 * edge,
                         [&](double change) { return robot.values_of_robot(moved_rest(d, motion, change)); }) < 1e-6);
    const Attacher attacher(d.mesh);
    By by{.inputs = false, .parameters = false};
    by.guides = {{0, 0, *attacher.slope(cable[0], 0, 0)}, {0, 1, {}}, {0, 2, *attacher.slope(cable[2], 0, 0)}};
    for (Eigen::Index k = 0; k < 9; ++k) {
        CAPTURE(k);
        CHECK(gradient_error(robot.told(by, [&](const Variation& v) { return v.guides[k]; }), robot.sizes(),
                             0.01 * edge, [&](double change) {
                                 std::array<Vec3, 3> moved = cable;
                                 moved[static_cast<std::size_t>(k / 3)][static_cast<std::size_t>(k % 3)] += change;
                                 return robot.values_of_robot(met_ends(moved, spring));
                             }) < 1e-6);
    }
}

TEST_CASE("gradients tet by tet: law constants, Young's modulus, density; their sum is the material's") {
    double worst = 0;
    for (const int order : {1, 2}) {
        const Description d = shaped(order, {CableKind::length_ratio, 0.95}, {ChamberKind::gas_ratio, 1.2});
        SettledRobot robot(d);
        const auto numbers = material::parameters(d.materials[0].law);
        for (const Eigen::Index tet : {3, 70}) {
            const auto of_one = [&](const Material& changed) {
                Description other = d;
                other.materials.push_back(changed);
                other.material_of_tet.assign(d.mesh.tet_count(), 0);
                other.material_of_tet[static_cast<std::size_t>(tet)] = 1;
                return robot.values_of_robot(other);
            };
            const By by{.inputs = false, .parameters = false, .tets = true};
            for (std::size_t k = 0; k < numbers.size(); ++k) {
                const Eigen::VectorXd direction = Eigen::Map<const Eigen::VectorXd>(
                    numbers[k].direction.data(), static_cast<Eigen::Index>(numbers[k].direction.size()));
                const double error = gradient_error(
                    robot.told(by, [&](const Variation& v) { return direction.dot(v.tets.constants.col(tet)); }),
                    1e-2 * robot.sizes(), numbers[k].name == "poisson_ratio" ? 0.1 : numbers[k].value,
                    [&](double change) {
                        Material other = d.materials[0];
                        other.law = material::with_parameter(other.law, k, numbers[k].value + change);
                        return of_one(other);
                    });
                INFO(numbers[k].name);
                CHECK(error < 1e-5);
                worst = std::max(worst, error);
            }
            CHECK(gradient_error(robot.told(by, [&](const Variation& v) { return v.tets.density[tet]; }),
                                 1e-2 * robot.sizes(), 1000, [&](double change) {
                                     Material other = d.materials[0];
                                     other.density_kg_m3 += change;
                                     return of_one(other);
                                 }) < 1e-5);
        }
        const auto whole = gradient(robot.at, robot.slopes[0], {.tets = true});
        REQUIRE(whole);
        const std::vector<Parameter> all = parameters(robot.at);
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            double sum = 0;
            for (std::size_t c = 0; c < numbers[k].direction.size(); ++c)
                sum += numbers[k].direction[c] * whole->tets.constants.row(static_cast<Eigen::Index>(c)).sum();
            REQUIRE(all[k].kind == Parameter::Kind::law);
            CHECK(sum == near(whole->parameters[static_cast<Eigen::Index>(k)], {.relative = 1e-9}));
        }
    }
    MESSAGE("tet by tet: ", worst);
}

TEST_CASE("directional changes agree with the gradients: the Jacobian and its transpose") {
    Description d = shaped(1, {CableKind::length_ratio, 0.95}, {ChamberKind::gas_ratio, 1.2});
    d.materials.push_back({"B", material::Ogden{2, {1.5e5, -0.3e5}, {1.3, -2.0}, 18e5}, 1100});
    d.material_of_tet.assign(d.mesh.tet_count(), 0);
    for (std::size_t t = 0; t < d.mesh.tet_count(); t += 2) d.material_of_tet[t] = 1;
    d.pressures = {patch(d.mesh, -1)};
    SettledRobot robot(d);
    Noise noise(8);
    std::vector<Variation> rows;
    for (const Slope& of : robot.slopes) {
        auto row = gradient(robot.at, of, {.tets = true, .rest = true});
        REQUIRE(row);
        rows.push_back(std::move(*row));
    }
    const auto scaled = [&](const Eigen::VectorXd& values) {
        return Eigen::VectorXd(values.cwiseAbs().cwiseProduct(noise.vector(values.size())));
    };
    Variation with;
    Eigen::VectorXd numbers(rows[0].parameters.size());
    const std::vector<Parameter> all = parameters(robot.at), wanted = inputs(robot.at);
    for (std::size_t k = 0; k < all.size(); ++k) numbers[static_cast<Eigen::Index>(k)] = size_of(all[k]);
    with.parameters = scaled(numbers);
    Eigen::VectorXd values(rows[0].inputs.size());
    for (std::size_t k = 0; k < wanted.size(); ++k) values[static_cast<Eigen::Index>(k)] = wanted[k].value;
    with.inputs = scaled(values);
    with.tets.constants = Eigen::MatrixXd::Zero(rows[0].tets.constants.rows(), rows[0].tets.constants.cols());
    for (Eigen::Index t = 0; t < with.tets.constants.cols(); ++t)
        with.tets.constants.col(t) = 1e5 * noise.vector(with.tets.constants.rows());
    with.tets.density = 300 * noise.vector(with.tets.constants.cols());
    with.rest = 0.01 * edge * noise.vector(rows[0].rest.size());
    const auto found = changes(robot.at, robot.slopes, with);
    REQUIRE(found);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        CAPTURE(k);
        const Variation& row = rows[k];
        const double told = row.inputs.dot(with.inputs) + row.parameters.dot(with.parameters) +
                            row.tets.constants.cwiseProduct(with.tets.constants).sum() +
                            row.tets.density.dot(with.tets.density) + row.rest.dot(with.rest);
        const double size = row.inputs.cwiseAbs().dot(with.inputs.cwiseAbs()) +
                            row.parameters.cwiseAbs().dot(with.parameters.cwiseAbs()) +
                            row.rest.cwiseAbs().dot(with.rest.cwiseAbs());
        CHECK((*found)[static_cast<Eigen::Index>(k)] == near(told, {.relative = 1e-9, .absolute = 1e-10 * size}));
    }
}

// A robot of weighted tets: everything that acts on nodes acts as before, and weights count.
#include "simulation/reduced/sampled_robot.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/test_problems.hpp"
#include "simulation/stepper/stepper.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::reduced;

namespace {

/// A hollow block with something of everything.
Description crowded(int order) {
    Description d = sim::testing::hollow_block(order);
    const Attacher attacher(d.mesh);
    const auto at = [&](double x, double y, double z) { return *attacher.carried_by_tet({x, y, z}, 1e-6); };
    const auto end = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 0.03 - 1e-9; });
    d.cables = {{"flexor",
                 {at(0, 0.005, 0.0095), at(0.015, 0.005, 0.0095), at(0.03, 0.005, 0.0095)},
                 {CableTarget::Kind::tension_N, 0.3}}};
    d.chambers[0].target = {ChamberTarget::Kind::pressure_Pa, 2e3};
    d.springs = {{"band", {at(0, 0.005, 0.0005), at(0.03, 0.005, 0.0005)}, 50, 0.02}};
    d.plates = {{"plate", end}};
    d.loads = {{"hanging", end, std::vector<double>(end.size(), 1.0 / static_cast<double>(end.size())), {0, 0, -0.1}}};
    d.torques = {{"twist", end, {1e-4, 0, 0}}};
    d.masses = {{"weight", at(0.02, 0.005, 0.0095), 0.002}};
    d.gravity_m_s2 = {0, 0, -9.81};
    return d;
}

std::vector<Weight> all_tets(const Description& d, double weight) {
    std::vector<Weight> tets;
    for (std::size_t t = 0; t < d.mesh.tet_count(); ++t) tets.push_back({t, weight});
    return tets;
}

Vec3 moved(const Vec3& p) {
    return p + Vec3{2e-3 * p.z, 1e-2 * p.x, -p.x * p.x};
}

/// Out-of-balance forces at these node positions, at the end of the program.
Eigen::VectorXd forces_of(const Description& d, const std::vector<Vec3>& positions) {
    const auto model = Model::create(d);
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    const Equilibrium system(*model);
    State state = system.rest();
    for (std::size_t k = 0; k < positions.size(); ++k)
        state.x.segment<3>(3 * static_cast<Eigen::Index>(k)) = linalg::vector(positions[k]);
    const Evaluation evaluation = system.evaluate(state, system.controls(1));
    REQUIRE(evaluation.possible());
    return evaluation.out_of_balance;
}

std::vector<Vec3> moved(const std::vector<Vec3>& points) {
    std::vector<Vec3> positions;
    for (const Vec3& p : points) positions.push_back(moved(p));
    return positions;
}

/// The same of the sampled robot, whose nodes move with those of the whole one; shared out to these.
Eigen::VectorXd forces_of(const SampledRobot& sampled, const std::vector<Vec3>& whole) {
    std::vector<Vec3> positions;
    for (const Attachment& node : sampled.nodes) {
        Vec3 mean;
        for (std::size_t i = 0; i < node.nodes.size(); ++i)
            mean += node.weights[i] * whole[static_cast<std::size_t>(node.nodes[i])];
        positions.push_back(mean);
    }
    const Eigen::VectorXd forces = forces_of(sampled.description, positions);
    Eigen::VectorXd shared = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(whole.size()));
    for (std::size_t k = 0; k < sampled.nodes.size(); ++k) {
        const Attachment& node = sampled.nodes[k];
        for (std::size_t i = 0; i < node.nodes.size(); ++i)
            shared.segment<3>(3 * node.nodes[i]) +=
                node.weights[i] * forces.segment<3>(3 * static_cast<Eigen::Index>(k));
    }
    return shared;
}

}  // namespace

TEST_CASE("sampled robot: with every tet once, the forces are those of the whole robot") {
    for (const int order : {1, 2}) {
        const Description d = crowded(order);
        const SampledRobot sampled = sampled_robot(d, all_tets(d, 1));
        const std::vector<Vec3> positions = moved(d.mesh.points);
        const Eigen::VectorXd whole = forces_of(d, positions), part = forces_of(sampled, positions);
        CHECK((whole - part).cwiseAbs().maxCoeff() < 1e-9 * whole.cwiseAbs().maxCoeff());
    }
}

TEST_CASE("sampled robot: twice the weight is twice the force and twice the mass") {
    Description d = sim::testing::hollow_block(1);
    d.gravity_m_s2 = {0, 0, -9.81};
    d.chambers.clear();
    const std::vector<Vec3> positions = moved(d.mesh.points);
    const Eigen::VectorXd once = forces_of(sampled_robot(d, all_tets(d, 1)), positions);
    const Eigen::VectorXd twice = forces_of(sampled_robot(d, all_tets(d, 2)), positions);
    CHECK((twice - 2 * once).cwiseAbs().maxCoeff() < 1e-12 * twice.cwiseAbs().maxCoeff());
}

TEST_CASE("sampled robot: few tets keep the nodes of everything else") {
    const Description d = crowded(1);
    const SampledRobot sampled = sampled_robot(d, {{3, 2.5}, {17, 1.5}});
    CHECK(sampled.description.mesh.tet_count() == 2);
    CHECK(sampled.description.tet_weights == std::vector{2.5, 1.5});
    CHECK(sampled.nodes.size() < d.mesh.points.size());
    for (const Cable& cable : sampled.description.cables)
        for (const Attachment& point : cable.points) CHECK(point.nodes.size() == 1);
    CHECK(sampled.description.loads[0].nodes.size() == 1);
    const auto whole = Model::create(d), part = Model::create(sampled.description);
    REQUIRE(whole);
    REQUIRE(part);
    const Equilibrium a(*whole), b(*part);
    for (std::size_t k = 0; k < a.actuators().size(); ++k)
        CHECK(a.actuators()[k].rest_measure() == near(b.actuators()[k].rest_measure(), {.relative = 1e-12}));
}

TEST_CASE("weights of tets are checked") {
    Description d = sim::testing::hollow_block(1);
    d.tet_weights = {1, 2};
    CHECK(!Model::create(d));
    d.tet_weights.assign(d.mesh.tet_count(), 1);
    CHECK(Model::create(d));
    d.tet_weights[5] = 0;
    CHECK(!Model::create(d));
}

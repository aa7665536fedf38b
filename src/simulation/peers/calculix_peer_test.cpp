// Pliant against CalculiX in the same run: same mesh, same law, same loads, another code.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "base/core/near.hpp"
#include "simulation/peers/calculix.hpp"
#include "simulation/peers/calculix_deck.hpp"
#include "simulation/peers/comparison_problems.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

// ccx prints seven digits. Displacements are shares of the largest one.
constexpr double same_displacement = 1e-5;
constexpr double same_force = 1e-5;
// CalculiX has no stiffness of following pressures and so converges slowly; and on curved faces it integrates them with
// three points, we with the six that the integral needs: two schemes, which meet on finer meshes.
constexpr double same_flat_chamber = 2e-4;
constexpr double same_curved_chamber = 1e-3;
constexpr double same_pressure = 1e-4;

Trajectory ours(const Description& d, int steps) {
    const auto model = Model::create(d);
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    Progress silent;
    Trajectory result = run(*model, {.steps = steps, .tolerance = 1e-7}, silent);
    REQUIRE_MESSAGE(result.converged, result.message);
    return result;
}

/// Its iteration sometimes stalls just above its own limit, depending on the last digits of a load; then it is run
/// again with smaller increments.
calculix::Solution theirs(const Description& d, calculix::Effort effort = {}) {
    auto solution = calculix::solve(d, effort);
    for (int again = 0; again < 3 && !solution; ++again) {
        effort.first_increment *= 0.6;
        solution = calculix::solve(d, effort);
    }
    REQUIRE_MESSAGE(solution, (solution ? "" : solution.error().message));
    return *solution;
}

/// Largest distance between the two codes' nodes, as a share of the largest displacement.
double mismatch(const Description& d, const Step& step, const calculix::Solution& peer) {
    double apart = 0;
    double largest = 0;
    for (std::size_t n = 0; n < d.mesh.points.size(); ++n) {
        const Vec3 u = step.positions[n] - d.mesh.points[n];
        apart = std::max(apart, norm(u - peer.displacement_m[n]));
        largest = std::max(largest, norm(u));
    }
    REQUIRE(largest > 0);
    MESSAGE("nodes apart by at most " << apart / largest << " of the largest displacement");
    return apart / largest;
}

/// Every node and the force at the grip.
void check_bar(int order, const material::Law& hard, const material::Law& soft, double strain) {
    CAPTURE(order);
    CAPTURE(material::name(soft));
    const Description d = comparison::bar(order, hard, soft, strain);
    const Step last = ours(d, 5).steps.back();
    const calculix::Solution peer = theirs(d);
    CHECK(mismatch(d, last, peer) < same_displacement);
    CHECK(last.supports[1].force_N.x == near(calculix::support_force(peer, d.supports[1]).x, {.relative = same_force}));
    CHECK(last.supports[1].force_N.x > 0);
}

void check_beam(int order, double nu) {
    CAPTURE(order);
    CAPTURE(nu);
    const Description d = comparison::beam(order, material::neo_hookean(12e6, nu), 20);
    const Step last = ours(d, 5).steps.back();
    const calculix::Solution peer = theirs(d);
    CHECK(mismatch(d, last, peer) < same_displacement);
    CHECK(comparison::tip_displacement(d, last).z > 0.01);
}

/// Ours by length; CalculiX with the tension that we found; then ours again at the length that CalculiX found, where
/// the tension must be the one that it was given.
void check_finger(int order, double nu) {
    CAPTURE(order);
    CAPTURE(nu);
    const material::Law law = material::neo_hookean(5e6, nu);
    Description d = comparison::cable_finger(order, law, {CableTarget::Kind::length_ratio, 0.9});
    const Step by_length = ours(d, 5).steps.back();
    const double tension = by_length.cables[0].tension_N;
    d.cables[0].target = {CableTarget::Kind::tension_N, tension};
    const calculix::Solution peer = theirs(d);
    CHECK(mismatch(d, by_length, peer) < same_displacement);

    const double ratio = comparison::cable_length(d, comparison::moved(d.mesh, peer.displacement_m)) /
                         comparison::cable_length(d, d.mesh.points);
    CHECK(ratio == near(0.9, {.relative = same_displacement}));
    d.cables[0].target = {CableTarget::Kind::length_ratio, ratio};
    const double again = ours(d, 5).steps.back().cables[0].tension_N;
    MESSAGE("tension " << again << " N, CalculiX " << tension << " N");
    CHECK(again == near(tension, {.relative = same_force}));
}

/// CalculiX and ours by pressure; then ours by the volume that CalculiX found, where the pressure must be the same.
void check_chamber(int order, double nu) {
    CAPTURE(order);
    CAPTURE(nu);
    const double pressure = 60e3;
    Description d =
        comparison::air_block(order, material::neo_hookean(1e6, nu), {ChamberTarget::Kind::pressure_Pa, pressure});
    const Step by_pressure = ours(d, 5).steps.back();
    const calculix::Solution peer = theirs(d);
    const double allowed = order == 2 ? same_curved_chamber : same_flat_chamber;
    CHECK(mismatch(d, by_pressure, peer) < allowed);
    const double volume = comparison::chamber_volume(d, comparison::moved(d.mesh, peer.displacement_m));
    CHECK(by_pressure.chambers[0].volume_m3 == near(volume, {.relative = allowed}));

    const double ratio = volume / comparison::chamber_volume(d, d.mesh.points);
    CHECK(ratio > 1.1);
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, ratio};
    const double found = ours(d, 5).steps.back().chambers[0].pressure_Pa;
    MESSAGE("volume ratio " << ratio << ", pressure " << found << " Pa, CalculiX " << pressure << " Pa");
    CHECK(found == near(pressure, {.relative = same_pressure}));
}

const std::array<double, 3> poisson_ratios = {0.3, 0.45, 0.49};

}  // namespace

TEST_CASE("two-material bar, neo-Hookean: agrees with CalculiX") {
    for (const int order : {1, 2}) {
        for (const double nu : poisson_ratios)
            check_bar(order, material::neo_hookean(45e6, nu), material::neo_hookean(12e6, nu), 0.3);
    }
}

TEST_CASE("two-material bar, every other law that CalculiX has: agrees with CalculiX") {
    const double K = material::bulk_modulus(4e6, 0.45);
    const material::MooneyRivlin mooney{1.2e6, 0.8e6, K};
    const material::Yeoh yeoh{2e6, -0.3e6, 0.5e6, K};
    const material::Ogden ogden{2, {3e6, 1e6}, {1.8, -2.5}, K};
    const material::Law rubbers[] = {mooney, yeoh, ogden, material::st_venant_kirchhoff(12e6, 0.45)};
    for (const int order : {1, 2}) {
        for (const material::Law& law : rubbers) check_bar(order, material::neo_hookean(45e6, 0.45), law, 0.3);
    }
}

TEST_CASE("bent beam: agrees with CalculiX") {
    for (const int order : {1, 2}) {
        for (const double nu : poisson_ratios) check_beam(order, nu);
    }
}

TEST_CASE("cable finger, linear tets: agrees with CalculiX") {
    for (const double nu : poisson_ratios) check_finger(1, nu);
}

TEST_CASE("cable finger, quadratic tets: agrees with CalculiX") {
    for (const double nu : poisson_ratios) check_finger(2, nu);
}

TEST_CASE("inflated chamber: agrees with CalculiX") {
    for (const int order : {1, 2}) {
        for (const double nu : poisson_ratios) check_chamber(order, nu);
    }
}

TEST_CASE("a cable through points inside tets, gravity and a rotated grip: agree with CalculiX") {
    for (const int order : {1, 2}) {
        CAPTURE(order);
        Description d = comparison::bar(order, material::neo_hookean(5e6, 0.45), material::neo_hookean(2e6, 0.4), 0);
        d.supports[1].turn = {0.4, {1, 0.2, 0}, d.mesh.points.back()};
        d.gravity_m_s2 = {0, 0, -30};
        for (Material& m : d.materials) m.density_kg_m3 = 1100;
        const std::vector<int> few(d.mesh.nodes.begin() + 40, d.mesh.nodes.begin() + 44);
        const std::vector<int> more(d.mesh.nodes.end() - 44, d.mesh.nodes.end() - 40);
        const std::vector<double> weights = {0.1, 0.2, 0.3, 0.4};
        d.cables.push_back({"flexor",
                            {{{}, {}, {-0.05, 0.0, 0.02}}, {few, weights, {}}, {more, weights, {}}},
                            {CableTarget::Kind::tension_N, 4}});
        const Step last = ours(d, 5).steps.back();
        const calculix::Solution peer = theirs(d);
        CHECK(mismatch(d, last, peer) < same_displacement);
    }
}

TEST_CASE("exporting names what CalculiX lacks, and what to set instead") {
    Description d =
        comparison::cable_finger(1, material::neo_hookean(5e6, 0.45), {CableTarget::Kind::length_ratio, 0.9});
    const auto refused = calculix::deck(d);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("target={tension=") != std::string::npos);
    d.cables[0].target = {CableTarget::Kind::tension_N, 3};
    d.mesh.region_names = {"left half"};
    d.supports[0].turn.angle_rad = 2;
    CHECK(calculix::deck(d).error().message.find("60 degrees") != std::string::npos);
    d.supports[0].turn.angle_rad = 0;
    Description other = d;
    other.moves_in_time = true;
    CHECK(calculix::deck(other).error().message.find("leave time_step out") != std::string::npos);
    other = d;
    other.masses.push_back({"weight", d.cables[0].points.back(), 0.02});
    CHECK(calculix::deck(other).error().message.find("leave [[mass]] out") != std::string::npos);
    const auto deck = calculix::deck(d);
    REQUIRE(deck);
    CHECK(deck->find("** region R1 \"left half\"\n") != std::string::npos);
    CHECK(deck->find("*SOLID SECTION,ELSET=R1,MATERIAL=M1") != std::string::npos);
}

TEST_CASE("a deck holds the state at the end of the program, however long it is") {
    Description d = comparison::cable_finger(1, material::neo_hookean(5e6, 0.45), {CableTarget::Kind::tension_N, 3});
    d.cables[0].target.keys = Curve{{0, 1, 4}, {0, 3, 2}};
    const auto tension_at = [&](double end) {
        const auto deck = calculix::deck(d, end);
        REQUIRE(deck);
        return deck->find(fmt::format("{:#.10g},{:#.10g},", end == 4 ? 2e6 : 3e6, -1e5)) != std::string::npos;
    };
    CHECK(tension_at(1));
    CHECK(tension_at(4));
}

TEST_CASE("a deck has no cable whose offset takes away all of its tension: it is slack, and does not push") {
    Description d = comparison::cable_finger(1, material::neo_hookean(5e6, 0.45), {CableTarget::Kind::tension_N, 3});
    const auto has_cable = [&](double offset_N) {
        d.cables[0].target.offset = offset_N;
        const auto deck = calculix::deck(d);
        REQUIRE(deck);
        return deck->find("SPRING") != std::string::npos || deck->find("*TEMPERATURE") != std::string::npos;
    };
    CHECK(has_cable(-2));
    CHECK_FALSE(has_cable(-3));
    CHECK_FALSE(has_cable(-4));
}

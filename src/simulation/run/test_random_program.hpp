// Random robots on small meshes with random programs, for tests; their description in one line; and simplification of a
// failing one until nothing more can be left out.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "geometry/mesh/mass_properties.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::sim::test {

inline constexpr double side = 0.01;

/// Random numbers that are the same on every system.
class Dice {
public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double between(double low, double high) {
        // Not std::uniform_real_distribution, whose numbers differ between standard libraries.
        return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
    }
    int up_to(int most) { return static_cast<int>(between(0, most + 1 - 1e-9)); }
    bool chance(double share) { return between(0, 1) < share; }

private:
    std::mt19937 engine_;
};

inline material::Law random_law(Dice& dice) {
    const double E = std::pow(10, dice.between(4, 8));
    const double nu = dice.chance(0.2) ? 0.499 : dice.between(0, 0.49);
    const double mu = E / (2 * (1 + nu));
    const double K = material::bulk_modulus(mu, nu);
    switch (dice.up_to(6)) {
        case 0:
            return material::MooneyRivlin{0.4 * mu, 0.1 * mu, K};
        case 1:
            return material::Yeoh{0.5 * mu, dice.between(-0.01, 0.05) * mu, 0.01 * mu, K};
        case 2:
            return material::Ogden{1, {mu}, {dice.between(1.5, 5)}, K};
        case 3:
            return material::corotated(E, nu);
        case 4:
            return material::st_venant_kirchhoff(E, nu);
        case 5:
            return material::shape_blend(E, nu);
        default:
            return material::neo_hookean(E, nu);
    }
}

/// A block of 3 x 1 x 1 cm of one or two materials, half of them with an empty box in the middle.
inline Description random_block(Dice& dice) {
    const bool hollow = dice.chance(0.5);
    const double split = dice.between(0, 3 * side);
    const auto region = [&](Vec3 c) {
        const bool inside = c.x > 0.5 * side && c.x < 2.5 * side && std::fabs(c.y - side / 2) < side / 4 &&
                            std::fabs(c.z - side / 2) < side / 4;
        return hollow && inside ? 2 : (c.x < split ? 0 : 1);
    };
    mesh::TetMesh whole = reference::kuhn_box({3 * side, side, side}, 6, 4, 4, region);
    whole.region_names = {"A", "B", "air"};
    if (dice.chance(0.25)) whole = mesh::to_quadratic(whole);
    mesh::Extract solid = mesh::extract_regions(whole, {true, true, false});
    Description d;
    d.mesh = std::move(solid.mesh);
    d.materials = {{"A", random_law(dice), 1000}, {"B", random_law(dice), 1000}};
    d.material_of_region = {0, 1};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    if (hollow) {
        ChamberTarget target;
        target.kind = static_cast<ChamberTarget::Kind>(dice.up_to(3));
        using Kind = ChamberTarget::Kind;
        target.value = dice.between(0.1, 6);
        if (target.kind == Kind::volume_change_m3) target.value = dice.between(-0.9, 5) * 2 * side * side * side / 4;
        if (target.kind == Kind::pressure_Pa) target.value = dice.between(-1, 1) * std::pow(10, dice.between(2, 7));
        d.chambers = {{"air", wall_of_faces(whole, mesh::region_faces(whole, 2), solid.node), target}};
    }
    return d;
}

inline Cable random_cable(Dice& dice, const mesh::TetMesh& mesh, int number) {
    Cable cable{fmt::format("cable {}", number), {}, {}};
    cable.target.kind = static_cast<CableTarget::Kind>(dice.up_to(2));
    cable.target.value = dice.between(0.1, 1);
    if (cable.target.kind == CableTarget::Kind::shortening_m) cable.target.value = dice.between(0, 0.9) * 2 * side;
    if (cable.target.kind == CableTarget::Kind::tension_N) cable.target.value = std::pow(10, dice.between(-2, 3));
    if (dice.chance(0.3)) cable.friction = dice.between(0, 0.5);
    if (dice.chance(0.5)) cable.points.push_back({{}, {}, {-0.001, dice.between(0, side), dice.between(0, side)}});
    const int points = 2 + dice.up_to(3);
    for (int k = 0; k < points; ++k) {
        const int node = dice.up_to(static_cast<int>(mesh.points.size()) - 1);
        cable.points.push_back({{node}, {1.0}, {}});
    }
    return cable;
}

inline Description random_robot(Dice& dice) {
    Description d = random_block(dice);
    const int cables = dice.up_to(d.chambers.empty() ? 3 : 1);
    for (int k = 0; k < cables; ++k) d.cables.push_back(random_cable(dice, d.mesh, k));
    if (dice.chance(0.3)) d.gravity_m_s2 = {0, 0, -dice.between(0, 1000)};
    if (dice.chance(0.2)) {
        d.supports.push_back({"grip",
                              reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 3 * side - 1e-9; }),
                              {dice.between(-2, 2) * side, dice.between(-2, 2) * side, 0}});
    }
    if (dice.chance(0.3)) {
        ContactRules rules;
        rules.surface = contact::robot_surface(d.mesh);
        rules.settings = {0.05 * side, 1e4, dice.between(0, 0.5), 1e-5, true};
        if (dice.chance(0.7)) {
            const contact::HalfSpace table{{0, 0, -0.1 * side}, {0, 0, 1}};
            rules.obstacles.push_back({{"table", table, 0.3}, {0, 0, dice.between(0, 1) * side}});
        }
        d.contact = std::move(rules);
    }
    return d;
}

struct RandomProgram {
    Description robot;
    Program program;
};

inline RandomProgram random_program(unsigned seed) {
    Dice dice(seed);
    RandomProgram made{random_robot(dice), {}};
    made.program.steps = 1 + dice.up_to(4);
    made.program.iteration_limit = 60;
    made.program.solver = static_cast<Solver>(dice.chance(0.8) ? 0 : dice.up_to(4));
    if (dice.chance(0.2)) made.program.dynamics = Dynamics{{dice.between(0, 10), dice.between(0, 0.01)}};
    return made;
}

/// A rigid box from `low`, of the density of water.
inline void add_box(Description& d, const std::string& name, const Vec3& low, const Vec3& size) {
    FreeObject box;
    box.name = name;
    for (int k = 0; k < 8; ++k)
        box.surface.points.push_back(low + Vec3{k & 1 ? size.x : 0, k & 2 ? size.y : 0, k & 4 ? size.z : 0});
    box.surface.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                             {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    const mesh::MassProperties body = mesh::mass_properties(box.surface);
    box.mass_kg = 1000 * body.volume;
    const auto points = mesh::equal_mass_points(body);
    for (std::size_t a = 0; a < 4; ++a) {
        box.nodes[a] = static_cast<int>(d.mesh.points.size());
        d.mesh.points.push_back(points[a]);
    }
    d.objects.push_back(std::move(box));
}

/// A soft block, free or clamped, over a ground, with boxes above and beside it, all with initial velocities in time
/// or, for some, at equilibrium.
inline RandomProgram random_free_program(unsigned seed) {
    Dice dice(seed);
    RandomProgram made;
    Description& d = made.robot;
    d.mesh = reference::kuhn_box({2 * side, side, side}, 4, 2, 2, [](Vec3) { return 0; });
    if (dice.chance(0.2)) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", random_law(dice), 1000}, {"B", random_law(dice), 1000}};
    d.material_of_region = {0};
    if (dice.chance(0.4))
        d.supports = {{"clamp",
                       reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }),
                       {0, 0, dice.between(-0.5, 1) * side}}};
    d.may_be_free = true;
    d.gravity_m_s2 = {dice.between(-5, 5), 0, -dice.between(0, 20)};
    ContactRules rules;
    rules.surface = contact::robot_surface(d.mesh);
    rules.settings = {0.03 * side, 1e4, dice.between(0, 0.5), 1e-5, dice.chance(0.7)};
    const double gap = dice.chance(0.5) ? 0 : dice.between(0.01, 0.5) * side;
    rules.obstacles.push_back({{"ground", contact::HalfSpace{{0, 0, -gap}, {0, 0, 1}}, dice.between(0, 1)},
                               {0, 0, dice.between(0, 0.5) * side}});
    d.contact = std::move(rules);
    const auto speed = [&](double most) { return dice.between(-most, most); };
    const int boxes = dice.up_to(3);
    for (int k = 0; k < boxes; ++k) {
        const Vec3 size{dice.between(0.3, 1) * side, dice.between(0.3, 1) * side, dice.between(0.3, 1) * side};
        add_box(d, fmt::format("box {}", k), {(0.1 + k) * side, dice.between(0, 0.2) * side, (1.05 + 0.2 * k) * side},
                size);
        FreeObject& box = d.objects.back();
        box.friction = dice.chance(0.5) ? dice.between(0, 1) : 0;
        box.velocity_m_s = {speed(1), speed(1), speed(1)};
        box.angular_velocity_rad_s = {speed(30), speed(30), speed(30)};
    }
    made.program.steps = 3 + dice.up_to(9);
    made.program.iteration_limit = 60;
    if (dice.chance(0.8)) {
        made.program.dynamics = Dynamics{{dice.between(0, 2), dice.chance(0.5) ? dice.between(0, 0.01) : 0}};
        made.program.duration = made.program.steps * std::pow(10, dice.between(-3.3, -1.7));
    }
    return made;
}

/// One line that describes the random program.
inline std::string described(const RandomProgram& p) {
    const Description& d = p.robot;
    std::string text = fmt::format("{} nodes of order {}, {} and {}", d.mesh.points.size(), d.mesh.order,
                                   material::name(d.materials[0].law), material::name(d.materials[1].law));
    for (const Cable& c : d.cables) {
        text += fmt::format("; a cable of {} points, friction {:.3g}, kind {} to {:.3g}", c.points.size(), c.friction,
                            static_cast<int>(c.target.kind), c.target.value);
    }
    for (const Chamber& c : d.chambers)
        text += fmt::format("; a chamber, kind {} to {:.3g}", static_cast<int>(c.target.kind), c.target.value);
    if (d.gravity_m_s2.z != 0) text += fmt::format("; gravity {:.3g} m/s^2", d.gravity_m_s2.z);
    if (d.supports.size() > 1)
        text += fmt::format("; a grip moved by ({:.3g}, {:.3g}) m", d.supports[1].move_m.x, d.supports[1].move_m.y);
    if (d.contact) text += fmt::format("; contact with {} obstacles", d.contact->obstacles.size());
    if (!d.objects.empty()) text += fmt::format("; {} objects", d.objects.size());
    if (d.supports.empty()) text += "; held by nothing";
    if (p.program.dynamics) text += "; in motion";
    return text + fmt::format("; {} steps, solver {}", p.program.steps, static_cast<int>(p.program.solver));
}

/// Leaves one thing out of a program; false if it is not there.
using Simplification = std::function<bool(RandomProgram&)>;

/// Everything that may be left out of `p`. The mesh is kept, because cables, chambers and supports refer to its nodes.
inline std::vector<Simplification> simplifications(const RandomProgram& p) {
    std::vector<Simplification> all;
    const auto taken_away = [](auto& from) { return from ? (from.reset(), true) : false; };
    for (std::size_t k = 0; k < p.robot.cables.size(); ++k) {
        all.emplace_back([k](RandomProgram& q) {
            q.robot.cables.erase(q.robot.cables.begin() + static_cast<std::ptrdiff_t>(k));
            return true;
        });
        all.emplace_back([k](RandomProgram& q) { return std::exchange(q.robot.cables[k].friction, 0.0) != 0; });
        all.emplace_back([k](RandomProgram& q) {
            auto& points = q.robot.cables[k].points;
            return points.size() > 2 ? (points.erase(points.begin() + 1), true) : false;
        });
    }
    all.emplace_back(
        [](RandomProgram& q) { return q.robot.chambers.empty() ? false : (q.robot.chambers.clear(), true); });
    all.emplace_back([](RandomProgram& q) {  // the last one only: others refer to the nodes after those of earlier ones
        return q.robot.objects.empty() ? false : (q.robot.objects.pop_back(), true);
    });
    all.emplace_back([=](RandomProgram& q) { return q.robot.objects.empty() && taken_away(q.robot.contact); });
    all.emplace_back([](RandomProgram& q) {
        return q.robot.contact && !q.robot.contact->obstacles.empty() ? (q.robot.contact->obstacles.clear(), true)
                                                                      : false;
    });
    all.emplace_back(
        [](RandomProgram& q) { return q.robot.supports.size() > 1 ? (q.robot.supports.pop_back(), true) : false; });
    all.emplace_back([](RandomProgram& q) { return norm(std::exchange(q.robot.gravity_m_s2, Vec3{})) > 0; });
    all.emplace_back([=](RandomProgram& q) { return taken_away(q.program.dynamics); });
    all.emplace_back(
        [](RandomProgram& q) { return std::exchange(q.program.solver, Solver::automatic) != Solver::automatic; });
    all.emplace_back([](RandomProgram& q) {
        const int half = q.program.steps / 2;
        return half > 0 ? (q.program.steps = half, true) : false;
    });
    for (std::size_t m = 0; m < p.robot.materials.size(); ++m) {
        all.emplace_back([m](RandomProgram& q) {
            const material::Law simple = material::neo_hookean(1e6, 0.3);
            material::Law& law = q.robot.materials[m].law;
            return material::name(law) == material::name(simple) ? false : (law = simple, true);
        });
    }
    return all;
}

/// The simplest program that still fails: things are left out one by one as long as it fails.
inline RandomProgram shrunk(RandomProgram failing, const std::function<bool(const RandomProgram&)>& fails) {
    for (bool simpler = true; simpler;) {
        simpler = false;
        for (const Simplification& leave_out : simplifications(failing)) {
            RandomProgram candidate = failing;
            if (!leave_out(candidate) || !fails(candidate)) continue;
            failing = std::move(candidate);
            simpler = true;
            break;
        }
    }
    return failing;
}

}  // namespace pliant::sim::test

// Lists of the inputs and parameters of a linearisation.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/linearisation/parameters.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::sim {
namespace {

using Kind = Parameter::Kind;

constexpr std::array axes = {"x", "y", "z"};

using linalg::view;

Parameter drive_of(const Linearisation& at, std::size_t a) {
    const Description& d = at.system().model().description();
    const Drive& drive = at.controls().drives[a];
    const std::size_t chambers = d.cables.size(), pressures = chambers + d.chambers.size();
    if (a < chambers) {
        const std::string& name = d.cables[a].name;
        if (drive.kind == Drive::Kind::multiplier)
            return {Kind::tension, a, fmt::format("cable \"{}\": tension", name), "N", drive.value};
        return {Kind::length, a, fmt::format("cable \"{}\": length", name), "m", drive.value / weighted_share(at, a)};
    }
    if (a >= pressures)
        return {Kind::pressure, a, fmt::format("load \"{}\": pressure", d.pressures[a - pressures].name), "Pa",
                -drive.value};
    const std::string& name = d.chambers[a - chambers].name;
    switch (drive.kind) {
        case Drive::Kind::measure:
            return {Kind::volume, a, fmt::format("chamber \"{}\": volume", name), "m^3", drive.value};
        case Drive::Kind::multiplier:
            return {Kind::pressure, a, fmt::format("chamber \"{}\": pressure", name), "Pa", -drive.value};
        case Drive::Kind::gas:
            break;
    }
    return {Kind::gas, a, fmt::format("chamber \"{}\": gas", name), "J", drive.value};
}

void add_materials(const Description& d, std::vector<Parameter>& all) {
    for (std::size_t m = 0; m < d.materials.size(); ++m) {
        const std::string owner = fmt::format("material \"{}\"", d.materials[m].name);
        const auto numbers = material::parameters(d.materials[m].law);
        for (std::size_t k = 0; k < numbers.size(); ++k)
            all.push_back(
                {Kind::law, m, fmt::format("{}: {}", owner, numbers[k].name), numbers[k].unit, numbers[k].value, k});
        all.push_back({Kind::density, m, owner + ": density", "kg/m^3", d.materials[m].density_kg_m3});
    }
}

void add_vector(Kind kind, std::size_t index, const std::string& owner, const std::string& unit, const Vec3& value,
                std::vector<Parameter>& all) {
    for (std::size_t c = 0; c < 3; ++c)
        all.push_back({kind, index, fmt::format("{}, {}", owner, axes[c]), unit, value[c], c});
}

void add_actuators(const Linearisation& at, std::vector<Parameter>& all) {
    const Description& d = at.system().model().description();
    for (std::size_t c = 0; c < d.cables.size(); ++c) {
        if (d.cables[c].friction > 0)
            all.push_back({Kind::cable_friction, c, fmt::format("cable \"{}\": friction", d.cables[c].name), "",
                           d.cables[c].friction});
    }
    for (std::size_t s = 0; s < d.springs.size(); ++s) {
        const std::string owner = fmt::format("spring \"{}\"", d.springs[s].name);
        const double stiffness = d.springs[s].stiffness_N_m;
        all.push_back({Kind::spring_stiffness, s, owner + ": stiffness", "N/m", stiffness});
        all.push_back(
            {Kind::spring_free_length, s, owner + ": free length", "m", at.system().springs()[s].free_length()});
    }
    for (std::size_t k = 0; k < d.growths.size(); ++k) {
        const auto a = static_cast<std::size_t>(d.growths[k].actuator);
        const GapElements* gaps = at.system().actuators()[a].gaps();
        if (gaps != nullptr && gaps->has(k))
            all.push_back({Kind::gap_weight, k, fmt::format("gap {} of cable \"{}\": weight", k, d.cables[a].name),
                           "Pa", d.growths[k].weight_Pa});
    }
    for (const Drive& drive : at.controls().drives) {
        if (drive.kind != Drive::Kind::gas) continue;
        all.push_back({Kind::ambient_pressure, 0, "ambient pressure", "Pa", d.ambient_pressure_Pa});
        break;
    }
}

void add_contact(const Description& d, std::vector<Parameter>& all) {
    if (!d.contact) return;
    all.push_back({Kind::contact_stiffness, 0, "contact: stiffness", "Pa", d.contact->settings.stiffness_Pa});
    if (d.contact->settings.friction > 0)
        all.push_back({Kind::self_friction, 0, "contact: friction", "", d.contact->settings.friction});
    for (std::size_t k = 0; k < d.contact->obstacles.size(); ++k) {
        const contact::Obstacle& body = d.contact->obstacles[k].body;
        if (body.friction > 0)
            all.push_back(
                {Kind::obstacle_friction, k, fmt::format("obstacle \"{}\": friction", body.name), "", body.friction});
    }
}

void add_joints(const Description& d, bool in_time, std::vector<Parameter>& all) {
    for (std::size_t j = 0; j < d.joints.size(); ++j) {
        const Joint& joint = d.joints[j];
        const std::string owner = fmt::format("joint \"{}\"", joint.name);
        const std::string unit = joint.kind == Joint::Kind::hinge ? "N m" : "N";
        const std::string of = joint.kind == Joint::Kind::hinge ? "rad" : "m";
        if (joint.law.stiffness > 0)
            all.push_back({Kind::joint_stiffness, j, owner + ": stiffness", unit + "/" + of, joint.law.stiffness});
        if (joint.law.damping > 0 && in_time)
            all.push_back({Kind::joint_damping, j, owner + ": damping", unit + " s/" + of, joint.law.damping});
    }
}

void add_masses(const Description& d, std::vector<Parameter>& all) {
    for (std::size_t k = 0; k < d.objects.size(); ++k) {
        const std::string owner = fmt::format("object \"{}\"", d.objects[k].name);
        all.push_back({Kind::object_mass, k, owner + ": mass", "kg", d.objects[k].mass_kg});
        if (d.objects[k].friction > 0)
            all.push_back({Kind::object_friction, k, owner + ": friction", "", d.objects[k].friction});
    }
    for (std::size_t k = 0; k < d.masses.size(); k += points_of_mass(d, k).size()) {
        double mass_kg = 0;
        for (const PointMass& point : points_of_mass(d, k)) mass_kg += point.mass_kg;
        all.push_back({Kind::point_mass, k, fmt::format("mass \"{}\": mass", d.masses[k].name), "kg", mass_kg});
    }
}

}  // namespace

std::span<const PointMass> points_of_mass(const Description& d, std::size_t first) {
    const auto begin = d.masses.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = std::find_if(begin, d.masses.end(), [&](const PointMass& p) { return p.name != begin->name; });
    return {begin, end};
}

double weighted_share(const Linearisation& at, std::size_t cable) {
    const Actuator& actuator = at.system().actuators()[cable];
    const std::vector<double>& shares = at.controls().shares[cable];
    return shares.empty() ? 1 : actuator.measure(view(at.state().x), shares) / actuator.measure(view(at.state().x));
}

std::vector<Parameter> inputs(const Linearisation& at) {
    const Description& d = at.system().model().description();
    const double time = at.controls().time;
    std::vector<Parameter> all;
    for (std::size_t a = 0; a < at.controls().drives.size(); ++a) all.push_back(drive_of(at, a));
    for (std::size_t s = 0; s < d.supports.size(); ++s) {
        if (d.supports[s].moves())
            all.push_back({Kind::support_share, s, fmt::format("fixed \"{}\": share of its motion", d.supports[s].name),
                           "", at.controls().support_share[s]});
    }
    for (std::size_t k = 0; k < d.loads.size(); ++k)
        all.push_back(
            {Kind::load_share, k, fmt::format("load \"{}\": share", d.loads[k].name), "", d.loads[k].share.at(time)});
    if (!(d.gravity_m_s2 == Vec3{}))
        all.push_back({Kind::gravity_share, 0, "gravity: share", "", d.gravity_share.at(time)});
    for (std::size_t k = 0; d.contact && k < d.contact->obstacles.size(); ++k) {
        const Obstacle& obstacle = d.contact->obstacles[k];
        if (!(obstacle.move_m == Vec3{}))
            all.push_back({Kind::obstacle_share, k,
                           fmt::format("obstacle \"{}\": share of its motion", obstacle.body.name), "",
                           obstacle.share.at(time)});
    }
    for (std::size_t j = 0; j < d.joints.size(); ++j) {
        const bool turns = d.joints[j].kind == Joint::Kind::hinge;
        const JointLaw::Drive drive = d.joints[j].law.drive;
        if (drive == JointLaw::Drive::none || !at.system().joints()[j].has_coordinate()) continue;
        const bool is_place = drive == JointLaw::Drive::place;
        all.push_back({Kind::joint_wanted, j,
                       fmt::format("joint \"{}\": {}", d.joints[j].name,
                                   is_place ? (turns ? "angle" : "position") : (turns ? "torque" : "force")),
                       is_place ? (turns ? "rad" : "m") : (turns ? "N m" : "N"), at.controls().joint_wanted[j]});
    }
    return all;
}

std::vector<Parameter> parameters(const Linearisation& at) {
    const auto& inertia = at.controls().inertia;
    return parameters(at, inertia && !inertia->is_tether() ? &inertia->damping() : nullptr);
}

std::vector<Parameter> parameters(const Linearisation& at, const Damping* in_time) {
    const Description& d = at.system().model().description();
    std::vector<Parameter> all;
    add_materials(d, all);
    add_actuators(at, all);
    for (std::size_t k = 0; k < d.loads.size(); ++k)
        add_vector(Kind::load_force, k, fmt::format("load \"{}\": force", d.loads[k].name), "N", d.loads[k].force_N,
                   all);
    for (std::size_t k = 0; k < d.torques.size(); ++k)
        add_vector(Kind::load_torque, k, fmt::format("load \"{}\": torque", d.torques[k].name), "N m",
                   d.torques[k].torque_Nm, all);
    for (std::size_t k = 0; k < d.pressures.size(); ++k)
        all.push_back({Kind::load_pressure, k, fmt::format("load \"{}\": full pressure", d.pressures[k].name), "Pa",
                       d.pressures[k].pressure_Pa});
    add_vector(Kind::gravity, 0, "gravity", "m/s^2", d.gravity_m_s2, all);
    for (std::size_t s = 0; s < d.supports.size(); ++s) {
        const Support& support = d.supports[s];
        const std::string owner = fmt::format("fixed \"{}\"", support.name);
        add_vector(Kind::support_move, s, owner + ": move", "m", support.move_m, all);
        if (support.turn.angle_rad != 0)
            all.push_back({Kind::support_angle, s, owner + ": angle", "rad", support.turn.angle_rad});
    }
    add_contact(d, all);
    add_masses(d, all);
    add_joints(d, in_time != nullptr, all);
    if (in_time == nullptr) return all;
    all.push_back({Kind::mass_damping, 0, "damping by mass", "1/s", in_time->mass_per_s});
    if (in_time->stiffness_s > 0)
        all.push_back({Kind::stiffness_damping, 0, "damping by stiffness", "s", in_time->stiffness_s});
    return all;
}

}  // namespace pliant::sim

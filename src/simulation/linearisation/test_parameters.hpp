// Robots with a changed value of one of their parameters.
#pragma once

#include <doctest/doctest.h>

#include <cmath>

#include "simulation/linearisation/parameters.hpp"
#include "simulation/linearisation/test_robots.hpp"
#include "simulation/material/law_parameters.hpp"

namespace pliant::sim::testing {

inline Description with_value(Description d, const Parameter& p, double value) {
    switch (p.kind) {
        case Parameter::Kind::law:
            d.materials[p.index].law = material::with_parameter(d.materials[p.index].law, p.part, value);
            break;
        case Parameter::Kind::density:
            d.materials[p.index].density_kg_m3 = value;
            break;
        case Parameter::Kind::spring_stiffness:
            d.springs[p.index].stiffness_N_m = value;
            break;
        case Parameter::Kind::spring_free_length:
            d.springs[p.index].free_length_m = value;
            break;
        case Parameter::Kind::cable_friction:
            d.cables[p.index].friction = value;
            break;
        case Parameter::Kind::load_force:
            d.loads[p.index].force_N[p.part] = value;
            break;
        case Parameter::Kind::load_torque:
            d.torques[p.index].torque_Nm[p.part] = value;
            break;
        case Parameter::Kind::load_pressure:
            d.pressures[p.index].pressure_Pa = value;
            break;
        case Parameter::Kind::gravity:
            d.gravity_m_s2[p.part] = value;
            break;
        case Parameter::Kind::ambient_pressure:
            d.ambient_pressure_Pa = value;
            break;
        case Parameter::Kind::support_move:
            d.supports[p.index].move_m[p.part] = value;
            break;
        case Parameter::Kind::support_angle:
            d.supports[p.index].turn.angle_rad = value;
            break;
        case Parameter::Kind::contact_stiffness:
            d.contact->settings.stiffness_Pa = value;
            break;
        case Parameter::Kind::self_friction:
            d.contact->settings.friction = value;
            break;
        case Parameter::Kind::obstacle_friction:
            d.contact->obstacles[p.index].body.friction = value;
            break;
        case Parameter::Kind::object_mass:
            d.objects[p.index].mass_kg = value;
            break;
        case Parameter::Kind::object_friction:
            d.objects[p.index].friction = value;
            break;
        case Parameter::Kind::point_mass:
            for (std::size_t k = p.index, end = k + points_of_mass(d, k).size(); k < end; ++k)
                d.masses[k].mass_kg *= value / p.value;
            break;
        case Parameter::Kind::joint_stiffness:
            d.joints[p.index].law.stiffness = value;
            break;
        case Parameter::Kind::joint_damping:
            d.joints[p.index].law.damping = value;
            break;
        case Parameter::Kind::gap_weight:
            d.growths[p.index].weight_Pa = value;
            break;
        case Parameter::Kind::mass_damping:
        case Parameter::Kind::stiffness_damping:
            break;  // of the motion, not of the robot
        default:
            FAIL("not a number of the robot");
    }
    return d;
}

/// Magnitude by which a value may change: the typical size of its kind if it is zero.
inline double size_of(const Parameter& p) {
    if (p.name.ends_with("poisson_ratio")) return 0.5 - p.value;
    if (p.kind == Parameter::Kind::gravity) return 10;
    if (p.kind == Parameter::Kind::support_move) return 0.1 * edge;
    return p.value != 0 ? std::fabs(p.value) : 1;
}

}  // namespace pliant::sim::testing

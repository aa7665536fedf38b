// The clamped beam of the tests of motion.
#pragma once

#include <cmath>
#include <numbers>

#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::sim::testing {

inline constexpr double beam_length = 0.1, beam_thickness = 0.01, beam_modulus = 1e6, beam_density = 1000;

/// A beam clamped at x = 0, with gravity across it that is there at once; its marker is at its end.
inline Description beam(int order, int pieces, double gravity) {
    Description d;
    d.mesh = reference::kuhn_box({beam_length, beam_thickness, beam_thickness}, pieces, 1, 1, [](Vec3) { return 0; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"A", material::neo_hookean(beam_modulus, 0.3), beam_density}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    d.markers = {
        {"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > beam_length - 1e-9; }))}};
    d.gravity_m_s2 = {0, 0, -gravity};
    d.gravity_share = {{0}, {1}};
    return d;
}

/// First natural frequency of a clamped beam: 1.8751^2 sqrt(EI / (rho A L^4)) / 2 pi (Euler and Bernoulli).
inline double beam_frequency_Hz() {
    const double EI = beam_modulus * std::pow(beam_thickness, 4) / 12;
    return 1.8751 * 1.8751 *
           std::sqrt(EI / (beam_density * beam_thickness * beam_thickness * std::pow(beam_length, 4))) /
           (2 * std::numbers::pi);
}

}  // namespace pliant::sim::testing

// The clamped logarithmic barrier and the mollifier of nearly parallel edges (Li, Ferguson, Schneider et al. 2020,
// equations 6 and 23), each with its first two derivatives.
#pragma once

namespace pliant::sim::contact {

/// Value and derivatives of a function of one variable.
struct Curve {
    double value = 0, slope = 0, curvature = 0;
};

/// b(D) = −(D/D̂ − 1)² ln(D/D̂) for 0 < D < D̂, zero beyond, infinite at D <= 0. D, D̂: distance squared and its reach
/// squared, m²; b is a pure number. Value, slope and curvature are continuous at D̂.
[[nodiscard]] Curve barrier(double squared, double squared_reach);

/// m(c) = c/ε (2 − c/ε) for c < ε, 1 beyond. c: squared cross product of two edges, m⁴.
[[nodiscard]] Curve mollifier(double squared_cross, double threshold);

}  // namespace pliant::sim::contact

// Derivatives of functions of four points by central differences, for tests.
#pragma once

#include <functional>
#include <random>

#include "simulation/contact/distance.hpp"

namespace pliant::sim::contact {

inline double& coordinate(Stencil& x, int k) {
    return x[static_cast<std::size_t>(k / 3)][static_cast<std::size_t>(k % 3)];
}

inline Vector12 numeric_gradient(const std::function<double(const Stencil&)>& f, const Stencil& x, double h) {
    Vector12 gradient;
    for (int k = 0; k < 12; ++k) {
        Stencil forth = x, back = x;
        coordinate(forth, k) += h;
        coordinate(back, k) -= h;
        gradient[k] = (f(forth) - f(back)) / (2 * h);
    }
    return gradient;
}

inline Matrix12 numeric_hessian(const std::function<Vector12(const Stencil&)>& gradient, const Stencil& x, double h) {
    Matrix12 H;
    for (int k = 0; k < 12; ++k) {
        Stencil forth = x, back = x;
        coordinate(forth, k) += h;
        coordinate(back, k) -= h;
        H.col(k) = (gradient(forth) - gradient(back)) / (2 * h);
    }
    return H;
}

/// Rotation about a random axis and a shift.
struct Motion {
    std::array<Vec3, 3> rows;
    Vec3 shift;

    [[nodiscard]] Vec3 turned(const Vec3& p) const { return {dot(rows[0], p), dot(rows[1], p), dot(rows[2], p)}; }
    [[nodiscard]] Vec3 operator()(const Vec3& p) const { return turned(p) + shift; }
    [[nodiscard]] Stencil operator()(const Stencil& x) const {
        return {(*this)(x[0]), (*this)(x[1]), (*this)(x[2]), (*this)(x[3])};
    }
};

template <class Random>
Vec3 random_vector(Random& random) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    return {uniform(random), uniform(random), uniform(random)};
}

template <class Random>
Motion random_motion(Random& random) {
    Vec3 a = random_vector(random), b = random_vector(random);
    a *= 1 / norm(a);
    b = cross(a, b);
    b *= 1 / norm(b);
    return {{a, b, cross(a, b)}, random_vector(random)};
}

}  // namespace pliant::sim::contact

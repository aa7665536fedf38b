#include "simulation/elements/free_rotation.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Vector3;
using Nodes = FreeRotation::Nodes;

/// A vector and its derivative.
using Pair = Eigen::Matrix<double, 3, 2>;

/// A rotation R and its derivative, slope x R.
struct Attitude {
    Matrix3 R = Matrix3::Identity();
    Vector3 slope = Vector3::Zero();
};

Nodes from_centre(const Nodes& x) {
    return x.colwise() - Vector3(x.rowwise().mean());
}

Matrix3 cross_matrix(const Vector3& k) {
    Matrix3 K;
    K << 0, -k.z(), k.y(), k.z(), 0, -k.x(), -k.y(), k.x(), 0;
    return K;
}

Nodes cross(const Vector3& k, const Nodes& x) {
    return cross_matrix(k) * x;
}

Pair cross(const Pair& a, const Pair& b) {
    Pair product;
    product << a.col(0).cross(b.col(0)), a.col(1).cross(b.col(0)) + a.col(0).cross(b.col(1));
    return product;
}

/// Sum of x_a x y_a.
Vector3 sum_of_moments(const Nodes& x, const Nodes& y) {
    Vector3 sum = Vector3::Zero();
    for (int a = 0; a < 4; ++a) sum += x.col(a).cross(y.col(a));
    return sum;
}

/// exp(k) R; the derivative of the exponential is that of Rodrigues' formula, by series for small angles.
Attitude turned(const Pair& k, const Attitude& from) {
    const double square = k.col(0).squaredNorm(), angle = std::sqrt(square);
    const bool is_small = angle < 0.05;
    const double sine = is_small ? 1 - square / 6 * (1 - square / 20 * (1 - square / 42)) : std::sin(angle) / angle;
    const double half = 0.5 * angle;
    const double sinc = is_small ? 1 - square / 24 * (1 - square / 80 * (1 - square / 168)) : std::sin(half) / half;
    const double cosine = 0.5 * sinc * sinc;  // (1 - cos) / angle^2
    const double third = is_small ? (1 - square / 20 * (1 - square / 42)) / 6 : (1 - sine) / square;
    const Matrix3 K = cross_matrix(k.col(0)), one = Matrix3::Identity();
    const Matrix3 E = one + sine * K + cosine * K * K;
    return {E * from.R, (one + cosine * K + third * K * K) * k.col(1) + E * from.slope};
}

}  // namespace

FreeRotation::FreeRotation(const Nodes& x, const Nodes& v)
    : arms_(from_centre(x)),
      velocity_(from_centre(v)),
      momentum_(sum_of_moments(arms_, velocity_)),
      inertia_(arms_.squaredNorm() * Matrix3::Identity() - arms_ * arms_.transpose()),
      inverse_(inertia_.inverse()) {}

FreeRotation::Motion FreeRotation::change(double time, const Nodes& dx, const Nodes& dv) const {
    Change by;
    by.arms = from_centre(dx);
    by.momentum = sum_of_moments(by.arms, velocity_) + sum_of_moments(arms_, from_centre(dv));
    const Matrix3 product = by.arms * arms_.transpose();
    by.inertia = 2 * product.trace() * Matrix3::Identity() - product - product.transpose();
    return move(time, by).change;
}

FreeRotation::Varied FreeRotation::move(double time, const Change& by) const {
    Pair momentum;
    momentum << momentum_, by.momentum;
    // I(t)^-1 w
    const auto over_inertia = [&](const Attitude& turn, const Pair& w) {
        const Matrix3 inverse = turn.R * inverse_ * turn.R.transpose();
        const Vector3 value = inverse * w.col(0), s = turn.slope;
        const Vector3 heavier = turn.R * (by.inertia * (turn.R.transpose() * value));
        Pair result;
        result << value, s.cross(value) + inverse * (w.col(1) - s.cross(w.col(0)) - heavier);
        return result;
    };
    const auto spin = [&](const Attitude& turn) { return over_inertia(turn, momentum); };
    const auto spin_rate = [&](const Attitude& turn) { return over_inertia(turn, cross(momentum, spin(turn))); };

    constexpr double fine = 0.02, most = 10000;  // rad and steps
    const double quickness = spin({}).col(0).norm() + std::sqrt(spin_rate({}).col(0).norm());
    const int steps = static_cast<int>(std::clamp(std::ceil(std::fabs(time) * quickness / fine), 1.0, most));
    const double h = time / steps;
    Attitude turn;
    for (int step = 0; step < steps; ++step) {
        const Pair a = h * spin(turn);
        const Attitude middle = turned(0.5 * a, turn);
        const Pair b = h * spin(middle), c = h * spin(turned(0.5 * b, turn));
        const Pair d = h * spin(turned(c - 0.5 * a, middle));
        turn = turned((3 * a + 2 * (b + c) - d) / 12, turn);
        turn = turned((2 * (b + c) - a + 3 * d) / 12, turn);
    }
    const Pair omega = spin(turn), rate = spin_rate(turn);
    Varied at;
    at.now.x = turn.R * arms_;
    at.now.v = cross(omega.col(0), at.now.x);
    at.now.a = cross(rate.col(0), at.now.x) + cross(omega.col(0), at.now.v);
    at.change.x = cross(turn.slope, at.now.x) + turn.R * by.arms;
    at.change.v = cross(omega.col(1), at.now.x) + cross(omega.col(0), at.change.x);
    at.change.a = cross(rate.col(1), at.now.x) + cross(rate.col(0), at.change.x) + cross(omega.col(1), at.now.v) +
                  cross(omega.col(0), at.change.v);
    return at;
}

}  // namespace pliant::sim

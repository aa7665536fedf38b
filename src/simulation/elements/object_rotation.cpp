#include "simulation/elements/object_rotation.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Vector3;
using Nodes = ObjectRotation::Nodes;

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

ObjectRotation::ObjectRotation(const Nodes& x, const Nodes& v, const Vector3& torque)
    : arms_(from_centre(x)),
      velocity_(from_centre(v)),
      momentum_(sum_of_moments(arms_, velocity_)),
      torque_(torque),
      inertia_(arms_.squaredNorm() * Matrix3::Identity() - arms_ * arms_.transpose()),
      inverse_(inertia_.inverse()) {}

Vector3 ObjectRotation::momentum(const Nodes& x, const Nodes& v) {
    return sum_of_moments(from_centre(x), from_centre(v));
}

Vector3 ObjectRotation::momentum_change(const Nodes& x, const Nodes& v, const Nodes& dx, const Nodes& dv) {
    return sum_of_moments(from_centre(dx), from_centre(v)) + sum_of_moments(from_centre(x), from_centre(dv));
}

ObjectRotation::Motion ObjectRotation::change(double time, const Nodes& dx, const Nodes& dv,
                                              const Vector3& dtorque) const {
    Change by;
    by.torque = dtorque;
    by.arms = from_centre(dx);
    by.momentum = momentum_change(arms_, velocity_, dx, dv);
    const Matrix3 product = by.arms * arms_.transpose();
    by.inertia = 2 * product.trace() * Matrix3::Identity() - product - product.transpose();
    return move(time, by).change;
}

ObjectRotation::Varied ObjectRotation::move(double time, const Change& by) const {
    Pair start, torque;
    start << momentum_, by.momentum;
    torque << torque_, by.torque;
    const auto momentum = [&](double t) -> Pair { return start + t * torque; };
    // I(t)^-1 w
    const auto over_inertia = [&](const Attitude& turn, const Pair& w) {
        const Matrix3 inverse = turn.R * inverse_ * turn.R.transpose();
        const Vector3 value = inverse * w.col(0), s = turn.slope;
        const Vector3 heavier = turn.R * (by.inertia * (turn.R.transpose() * value));
        Pair result;
        result << value, s.cross(value) + inverse * (w.col(1) - s.cross(w.col(0)) - heavier);
        return result;
    };
    const auto spin = [&](double t, const Attitude& turn) { return over_inertia(turn, momentum(t)); };
    const auto spin_rate = [&](double t, const Attitude& turn) {
        return over_inertia(turn, torque + cross(momentum(t), spin(t, turn)));
    };

    constexpr double fine = 0.02, most = 10000;  // rad and steps
    const double quickness = spin(0, {}).col(0).norm() + std::sqrt(spin_rate(0, {}).col(0).norm()) +
                             std::fabs(time) * (inverse_ * torque_).norm();
    const int steps = static_cast<int>(std::clamp(std::ceil(std::fabs(time) * quickness / fine), 1.0, most));
    const double h = time / steps;
    Attitude turn;
    for (int step = 0; step < steps; ++step) {
        const double begin = step * h, half = begin + 0.5 * h;
        const Pair a = h * spin(begin, turn);
        const Attitude middle = turned(0.5 * a, turn);
        const Pair b = h * spin(half, middle), c = h * spin(half, turned(0.5 * b, turn));
        const Pair d = h * spin(begin + h, turned(c - 0.5 * a, middle));
        turn = turned((3 * a + 2 * (b + c) - d) / 12, turn);
        turn = turned((2 * (b + c) - a + 3 * d) / 12, turn);
    }
    const Pair omega = spin(time, turn), rate = spin_rate(time, turn);
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

#include "simulation/contact/friction.hpp"

#include <cmath>
#include <utility>

#include "simulation/contact/surface.hpp"

namespace pliant::sim::contact {

namespace {

/// Two unit vectors that are normal to `n` and to each other.
std::array<Vec3, 2> tangents_of(const Vec3& n) {
    const Vec3 other = std::abs(n.x) <= std::abs(n.y) && std::abs(n.x) <= std::abs(n.z) ? Vec3{1, 0, 0}
                       : std::abs(n.y) <= std::abs(n.z)                                 ? Vec3{0, 1, 0}
                                                                                        : Vec3{0, 0, 1};
    Vec3 a = cross(n, other);
    a *= 1 / norm(a);
    return {a, cross(n, a)};
}

/// f(y), and f'(y)/y, which stays finite at y = 0.
double smoothed_length(double y, double eps) {
    return y < eps ? y * y / eps * (1 - y / (3 * eps)) + eps / 3 : y;
}
double slope_over_length(double y, double eps) {
    return y < eps ? (2 - y / eps) / eps : 1 / y;
}
/// (f''(y) − f'(y)/y) / y²; below ε it is −1/(ε² y).
double curvature_term(double y, double eps) {
    return y < eps ? -1 / (eps * eps * y) : -1 / (y * y * y);
}

}  // namespace

FrozenPair freeze(const Pair& pair, double coefficient, double stiffness_Pa, const Stencil& x) {
    const Nearest n = nearest(pair, x);
    const Vec3 r = separation(pair, n, x);
    FrozenPair frozen;
    frozen.nodes = pair.nodes;
    frozen.weights = n.weights;
    frozen.tangents = tangents_of(unit(r));
    frozen.limit_N = coefficient * normal_force(pair, stiffness_Pa, x);
    frozen.node_count = pair.node_count();
    frozen.first_count = pair.first_count();
    frozen.obstacle = pair.obstacle;
    frozen.robot_first = pair.robot_first;
    return frozen;
}

Friction::Friction(std::vector<FrozenPair> pairs, std::vector<double> step_start, double slip_m)
    : pairs_(std::move(pairs)), start_(std::move(step_start)), slip_m_(slip_m) {}

std::array<double, 2> Friction::slip(const FrozenPair& pair, std::span<const double> x) const {
    Vec3 moved;
    for (int i = 0; i < pair.node_count; ++i)
        moved += pair.weights[i] * (node_at(x, pair.nodes[i]) - node_at(start_, pair.nodes[i]));
    return {dot(pair.tangents[0], moved), dot(pair.tangents[1], moved)};
}

double Friction::energy(std::span<const double> x) const {
    double sum = 0;
    for (const FrozenPair& pair : pairs_) {
        const auto u = slip(pair, x);
        sum += pair.limit_N * smoothed_length(std::hypot(u[0], u[1]), slip_m_);
    }
    return sum;
}

Vec3 Friction::force(std::size_t k, std::span<const double> x) const {
    const FrozenPair& pair = pairs_[k];
    const auto u = slip(pair, x);
    const double factor = -pair.limit_N * slope_over_length(std::hypot(u[0], u[1]), slip_m_);
    return factor * (u[0] * pair.tangents[0] + u[1] * pair.tangents[1]);
}

void Friction::add_gradient(std::span<const double> x, std::span<double> gradient) const {
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const FrozenPair& pair = pairs_[k];
        const Vec3 f = force(k, x);
        for (int i = 0; i < pair.node_count; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                gradient[3 * static_cast<std::size_t>(pair.nodes[i]) + c] -= pair.weights[i] * f[c];
    }
}

void Friction::visit_hessian(std::span<const double> x, const BlockVisitor& visit) const {
    for (const FrozenPair& pair : pairs_) {
        const auto u = slip(pair, x);
        const double y = std::hypot(u[0], u[1]);
        Eigen::Matrix<double, 3, 2> T;
        for (int k = 0; k < 2; ++k) T.col(k) << pair.tangents[k].x, pair.tangents[k].y, pair.tangents[k].z;
        Eigen::Matrix2d inner = slope_over_length(y, slip_m_) * Eigen::Matrix2d::Identity();
        const Eigen::Vector2d along(u[0], u[1]);
        if (y > 1e-9 * slip_m_) inner += curvature_term(y, slip_m_) * along * along.transpose();
        const linalg::Matrix3 block = pair.limit_N * T * inner * T.transpose();
        for (int i = 0; i < pair.node_count; ++i)
            for (int j = 0; j < pair.node_count; ++j)
                if (pair.weights[i] * pair.weights[j] != 0)
                    visit(pair.nodes[i], pair.nodes[j], pair.weights[i] * pair.weights[j] * block);
    }
}

}  // namespace pliant::sim::contact

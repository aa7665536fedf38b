#include "simulation/contact/friction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
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
    frozen.flat_face = pair.flat_face;
    return frozen;
}

Friction::Friction(std::vector<FrozenPair> pairs, std::vector<double> step_start, double slip_m)
    : pairs_(std::move(pairs)), start_(std::move(step_start)), slip_m_(slip_m) {}

std::array<double, 2> Friction::slip(const FrozenPair& pair, std::span<const double> x) const {
    Vec3 moved;
    for (int i = 0; i < pair.node_count; ++i)
        moved += pair.weights[i] * (node_at(x, pair.nodes[i]) - node_at(start_, pair.nodes[i]));
    return {pair.carried_m[0] + dot(pair.tangents[0], moved), pair.carried_m[1] + dot(pair.tangents[1], moved)};
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

Eigen::Matrix2d Friction::stiffness(std::size_t k, std::span<const double> x) const {
    const auto u = slip(pairs_[k], x);
    const double y = std::hypot(u[0], u[1]);
    Eigen::Matrix2d inner = slope_over_length(y, slip_m_) * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d along(u[0], u[1]);
    if (y > 1e-9 * slip_m_) inner += curvature_term(y, slip_m_) * along * along.transpose();
    return pairs_[k].limit_N * inner;
}

void Friction::visit_hessian(std::span<const double> x, const BlockVisitor& visit) const {
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const FrozenPair& pair = pairs_[k];
        Eigen::Matrix<double, 3, 2> T;
        for (int t = 0; t < 2; ++t) T.col(t) << pair.tangents[t].x, pair.tangents[t].y, pair.tangents[t].z;
        const linalg::Matrix3 block = T * stiffness(k, x) * T.transpose();
        for (int i = 0; i < pair.node_count; ++i)
            for (int j = 0; j < pair.node_count; ++j)
                if (pair.weights[i] * pair.weights[j] != 0)
                    visit(pair.nodes[i], pair.nodes[j], pair.weights[i] * pair.weights[j] * block);
    }
}

namespace {

/// What touches what. Which triangle of a flat face is nearest to a point has no meaning: several may be.
std::array<std::int64_t, 6> features_of(const FrozenPair& pair) {
    if (pair.flat_face >= 0) return {pair.nodes[0], pair.flat_face, -1, -1, pair.node_count, pair.first_count};
    return {pair.nodes[0], pair.nodes[1], pair.nodes[2], pair.nodes[3], pair.node_count, pair.first_count};
}

/// Transports the tangents by the smallest rotation that maps one normal to the other.
Eigen::Matrix2d transport(const FrozenPair& from, const FrozenPair& to) {
    const Vec3 n = cross(from.tangents[0], from.tangents[1]), m = cross(to.tangents[0], to.tangents[1]);
    const double share = 1 + dot(n, m);
    Eigen::Matrix2d change;
    for (int b = 0; b < 2; ++b) {
        const Vec3& t = from.tangents[b];
        const Vec3 turned = share > 1e-6 ? t - dot(t, m) / share * (n + m) : t;
        for (int a = 0; a < 2; ++a) change(a, b) = dot(to.tangents[a], turned);
    }
    return change;
}

}  // namespace

std::vector<Carry> find_carries(std::span<const FrozenPair> before, std::span<const FrozenPair> now) {
    std::vector<std::size_t> order(before.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto features = [&](std::size_t k) { return features_of(before[k]); };
    std::ranges::sort(order, {}, features);
    std::vector<Carry> carries;
    for (std::size_t k = 0; k < now.size(); ++k) {
        const auto found = std::ranges::lower_bound(order, features_of(now[k]), {}, features);
        if (found != order.end() && features(*found) == features_of(now[k]))
            carries.push_back({*found, k, transport(before[*found], now[k])});
    }
    return carries;
}

Eigen::Vector2d kept_slip(const std::array<double, 2>& slip, double slip_m) {
    const Eigen::Vector2d u(slip[0], slip[1]);
    const double size = u.norm();
    return size <= slip_m ? u : Eigen::Vector2d(slip_m / size * u);
}

Eigen::Matrix2d kept_slip_gradient(const std::array<double, 2>& slip, double slip_m) {
    const Eigen::Vector2d u(slip[0], slip[1]);
    const double size = u.norm();
    if (size <= slip_m) return Eigen::Matrix2d::Identity();
    return slip_m / size * (Eigen::Matrix2d::Identity() - u * u.transpose() / (size * size));
}

void carry_over(const Friction& before, std::span<const double> x, std::span<FrozenPair> pairs) {
    for (const Carry& carry : find_carries(before.pairs(), pairs)) {
        const Eigen::Vector2d kept = kept_slip(before.slip(before.pairs()[carry.from], x), before.slip_m());
        const Eigen::Vector2d carried = carry.change * kept;
        pairs[carry.to].carried_m = {carried[0], carried[1]};
    }
}

}  // namespace pliant::sim::contact

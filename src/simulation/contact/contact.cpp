#include "simulation/contact/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/core/parallel.hpp"

namespace pliant::sim::contact {

namespace {

constexpr std::size_t pairs_per_piece = 32;

Stencil stencil_of(const Pair& pair, std::span<const double> x) {
    const auto& n = pair.nodes;
    return {node_at(x, n[0]), node_at(x, n[1]), node_at(x, n[2]), node_at(x, n[3])};
}

/// Computes derivatives of all pairs in parallel, for sequential use.
template <class T, class Function>
std::vector<T> for_each_pair(const Pairs& pairs, std::size_t first, std::size_t count, const Function& function) {
    std::vector<T> results(count);
    parallel_for(count, pairs_per_piece, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) results[k] = function(pairs[first + k]);
    });
    return results;
}

}  // namespace

double Contact::energy(const Pairs& pairs, std::span<const double> x) const {
    return parallel_sum(pairs.size(), pairs_per_piece, [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t k = begin; k < end; ++k)
            sum += potential(pairs[k], settings_.stiffness_Pa, stencil_of(pairs[k], x));
        return sum;
    });
}

void Contact::add_gradient(const Pairs& pairs, std::span<const double> x, std::span<double> gradient) const {
    const auto gradients = for_each_pair<Vector12>(pairs, 0, pairs.size(), [&](const Pair& pair) {
        return potential_gradient(pair, settings_.stiffness_Pa, stencil_of(pair, x));
    });
    for (std::size_t k = 0; k < pairs.size(); ++k)
        for (int i = 0; i < pairs[k].node_count(); ++i)
            for (int c = 0; c < 3; ++c)
                gradient[3 * static_cast<std::size_t>(pairs[k].nodes[i]) + c] += gradients[k][3 * i + c];
}

void Contact::visit_hessian(const Pairs& pairs, std::span<const double> x, bool project,
                            const BlockVisitor& visit) const {
    const auto hessian = [&](const Pair& pair) -> Matrix12 {
        const Matrix12 H = potential_hessian(pair, settings_.stiffness_Pa, stencil_of(pair, x));
        return project ? project_to_positive(H, pair.node_count()) : H;
    };
    constexpr std::size_t batch = 4096;  // limits memory: about a kilobyte for each pair
    for (std::size_t first = 0; first < pairs.size(); first += batch) {
        const std::size_t count = std::min(batch, pairs.size() - first);
        const auto hessians = for_each_pair<Matrix12>(pairs, first, count, hessian);
        for (std::size_t k = 0; k < count; ++k) {
            const Pair& pair = pairs[first + k];
            for (int i = 0; i < pair.node_count(); ++i)
                for (int j = 0; j < pair.node_count(); ++j)
                    visit(pair.nodes[i], pair.nodes[j], hessians[k].block<3, 3>(3 * i, 3 * j));
        }
    }
}

Friction Contact::freeze(const Pairs& pairs, std::span<const double> frozen, std::span<const double> step_start,
                         const Friction* before) const {
    std::vector<FrozenPair> result;
    for (const Pair& pair : pairs) {
        const auto nodes = std::span(pair.nodes).first(static_cast<std::size_t>(pair.node_count()));
        const double coefficient = friction_owner(nodes, pair.obstacle).coefficient;
        if (coefficient == 0) continue;
        FrozenPair f = contact::freeze(pair, coefficient, settings_.stiffness_Pa, stencil_of(pair, frozen));
        if (f.limit_N > 0) result.push_back(f);
    }
    if (before != nullptr) carry_over(*before, step_start, result);
    return {std::move(result), {step_start.begin(), step_start.end()}, settings_.slip_m};
}

FrictionOwner Contact::friction_owner(std::span<const int> nodes, int obstacle) const {
    FrictionOwner owner;
    if (obstacle >= 0) owner = {obstacles_[static_cast<std::size_t>(obstacle)].friction, obstacle, -1};
    for (const int node : nodes) {
        const int rigid = part_of(node) - 1;
        if (rigid < 0) continue;
        const double own = rigid_[static_cast<std::size_t>(rigid)].friction;
        if ((owner.obstacle < 0 && owner.rigid < 0) || own > owner.coefficient) owner = {own, -1, rigid};
    }
    if (owner.obstacle < 0 && owner.rigid < 0) owner.coefficient = settings_.friction;
    return owner;
}

double Contact::smallest_distance(const Pairs& pairs, std::span<const double> x) const {
    double smallest = std::numeric_limits<double>::infinity();
    for (const Pair& pair : pairs) {
        const double drawn_in = pair.obstacle < 0 ? 0 : drawn_in_m_[pair.obstacle];
        smallest = std::min(smallest, distance(pair, stencil_of(pair, x)) - drawn_in);
    }
    return smallest;
}

double Contact::add_self_force(const Pairs& pairs, std::span<const double> x, std::span<double> gradient) const {
    double sum = 0;
    for (const Pair& pair : pairs) {
        if (pair.obstacle >= 0 || part_of(pair.nodes[0]) > 0 || part_of(pair.nodes[3]) > 0) continue;
        const Stencil stencil = stencil_of(pair, x);
        sum += normal_force(pair, settings_.stiffness_Pa, stencil);
        const Vector12 change = normal_force_gradient(pair, settings_.stiffness_Pa, stencil);
        for (int i = 0; i < pair.node_count(); ++i) {
            for (int c = 0; c < 3; ++c) gradient[3 * static_cast<std::size_t>(pair.nodes[i]) + c] += change[3 * i + c];
        }
    }
    return sum;
}

Forces Contact::forces(const Pairs& pairs, std::span<const double> x, const Friction* friction) const {
    Forces result{std::vector<Vec3>(obstacles_.size()), std::vector<Vec3>(rigid_.size()), 0,
                  std::vector<double>(static_cast<std::size_t>(robot_nodes_)), smallest_distance(pairs, x)};
    std::vector<Vec3> at_node(static_cast<std::size_t>(node_count()));
    for (const Pair& pair : pairs) {
        const Vector12 gradient = potential_gradient(pair, settings_.stiffness_Pa, stencil_of(pair, x));
        const bool self = pair.obstacle < 0 && part_of(pair.nodes[0]) == 0 && part_of(pair.nodes[3]) == 0;
        if (self) result.self_N += normal_force(pair, settings_.stiffness_Pa, stencil_of(pair, x));
        for (int i = 0; i < pair.node_count(); ++i) {
            const Vec3 force{-gradient[3 * i], -gradient[3 * i + 1], -gradient[3 * i + 2]};
            at_node[pair.nodes[i]] += force;
            if (const int part = part_of(pair.nodes[i]); part > 0)
                result.on_rigid_N[static_cast<std::size_t>(part) - 1] += force;
            else if (pair.obstacle >= 0 && pair.nodes[i] < robot_nodes_)
                result.on_robot_N[pair.obstacle] += force;
        }
    }
    for (std::size_t i = 0; i < robot_.surface.points.size(); ++i) {
        const int node = robot_.surface.points[i];
        if (robot_.areas.points[i] > 0) result.pressure_Pa[node] = norm(at_node[node]) / robot_.areas.points[i];
    }
    if (friction == nullptr) return result;
    for (std::size_t k = 0; k < friction->pairs().size(); ++k) {
        const FrozenPair& pair = friction->pairs()[k];
        const int first = part_of(pair.nodes[0]);
        const int second = part_of(pair.nodes[static_cast<std::size_t>(pair.first_count)]);
        const Vec3 force = friction->force(k, x);
        if (first > 0) result.on_rigid_N[static_cast<std::size_t>(first) - 1] += force;
        if (second > 0) result.on_rigid_N[static_cast<std::size_t>(second) - 1] += -1.0 * force;
        if (pair.obstacle >= 0 && first == 0 && second == 0)
            result.on_robot_N[pair.obstacle] += (pair.robot_first ? 1.0 : -1.0) * force;
    }
    return result;
}

}  // namespace pliant::sim::contact

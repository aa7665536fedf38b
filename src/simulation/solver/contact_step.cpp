#include "simulation/solver/contact_step.hpp"

#include <algorithm>
#include <utility>

#include "base/linalg/dense.hpp"

namespace pliant::sim {
namespace {

/// Of the largest compliance, added to all: rigid objects yield to no forces that would deform them.
constexpr double least_compliance = 1e-7;
constexpr int most_iterations = 100;
constexpr int most_halvings = 30;
constexpr double small = 1e-4;    ///< gradient that ends the iteration, relative to the first
constexpr double enough = 1e-2;   ///< gradient of a solution that is worth a step, likewise
constexpr double blocked = 1e-3;  ///< a step length at which something is in the way

}  // namespace

ContactStep::ContactStep(const Equilibrium& system, const State& state, const Controls& controls, double beyond)
    : system_(system),
      controls_(controls),
      contact_(*system.model().contact(controls.met)),
      start_(system.with_obstacles(state.x, controls.obstacles)),
      pairs_(contact_.find_near(start_, (1 + beyond) * contact_.settings().distance_m)) {
    for (const contact::Pair& pair : pairs_)
        add_carriers(std::span(pair.nodes).first(static_cast<std::size_t>(pair.node_count())));
    if (controls.friction) {
        for (const contact::FrozenPair& pair : controls.friction->pairs())
            add_carriers(std::span(pair.nodes).first(static_cast<std::size_t>(pair.node_count)));
    }
    number_nodes();
}

void ContactStep::add_carriers(std::span<const int> contact_nodes) {
    const std::vector<int>& free_index = system_.model().free_index();
    for (const int& contact_node : contact_nodes) {
        for (const int node : system_.model().object_points().carriers(contact_node)) {
            if (const int free = free_index[static_cast<std::size_t>(node)]; free >= 0) nodes_.push_back(free);
        }
    }
}

void ContactStep::number_nodes() {
    std::ranges::sort(nodes_);
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
    const std::vector<int>& free_index = system_.model().free_index();
    place_.assign(free_index.size(), -1);
    for (std::size_t node = 0; node < place_.size(); ++node) {
        const auto found = std::ranges::lower_bound(nodes_, free_index[node]);
        if (found != nodes_.end() && *found == free_index[node])
            place_[node] = static_cast<int>(found - nodes_.begin());
    }
}

std::vector<int> ContactStep::rows() const {
    std::vector<int> rows;
    for (const int node : nodes_) rows.insert(rows.end(), {3 * node, 3 * node + 1, 3 * node + 2});
    return rows;
}

std::vector<double> ContactStep::motion(const Eigen::VectorXd& delta) const {
    Eigen::VectorXd full = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(place_.size()));
    for (std::size_t node = 0; node < place_.size(); ++node) {
        if (place_[node] >= 0)
            full.segment<3>(3 * static_cast<Eigen::Index>(node)) = delta.segment<3>(3 * place_[node]);
    }
    return system_.with_obstacles(full, Eigen::VectorXd::Zero(controls_.obstacles.size()));
}

double ContactStep::energy(const std::vector<double>& x) const {
    return contact_.energy(pairs_, x) + (controls_.friction ? controls_.friction->energy(x) : 0);
}

Eigen::VectorXd ContactStep::gradient(const std::vector<double>& x) const {
    return system_.contact_gradient(pairs_, x, controls_);
}

Eigen::MatrixXd ContactStep::hessian(const std::vector<double>& x, bool project) const {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size(), size());
    const contact::BlockVisitor add = [&](int a, int b, const linalg::Matrix3& block) {
        const int i = place_[static_cast<std::size_t>(a)], j = place_[static_cast<std::size_t>(b)];
        if (i >= 0 && j >= 0) H.block<3, 3>(3 * i, 3 * j) += block;
    };
    const contact::BlockVisitor add_carried = [&](int a, int b, const linalg::Matrix3& block) {
        system_.model().object_points().visit_block(a, b, block, add);
    };
    contact_.visit_hessian(pairs_, x, project, add_carried);
    if (controls_.friction) controls_.friction->visit_hessian(x, add_carried);
    return H;
}

/// -(stiffness + Hessian of Ψ at x)^-1 slope.
std::optional<Eigen::VectorXd> ContactStep::newton_step(const Eigen::MatrixXd& stiffness, const std::vector<double>& x,
                                                        const Eigen::VectorXd& slope) const {
    for (const bool project : {false, true}) {
        if (auto step = linalg::positive_solution(stiffness + hessian(x, project), -slope)) return step;
    }
    return std::nullopt;
}

double ContactStep::value(const Problem& problem, const Eigen::VectorXd& delta, const std::vector<double>& x) const {
    const Eigen::VectorXd off = delta - problem.without_m;
    return 0.5 * off.dot(problem.stiffness * off) + energy(x);
}

bool ContactStep::descend(const Problem& problem, const Eigen::VectorXd& slope, Place& at) const {
    const auto way = newton_step(problem.stiffness, at.x, slope);
    if (!way) return false;
    const std::vector<double> moved = motion(*way);
    double share = contact_.largest_step(at.x, moved);
    for (int halving = 0; halving < most_halvings && share > blocked; ++halving, share *= 0.5) {
        Place next{at.delta + share * *way, at.x, 0};
        for (std::size_t i = 0; i < moved.size(); ++i) next.x[i] += share * moved[i];
        next.value = value(problem, next.delta, next.x);
        if (!(next.value < at.value + 1e-4 * share * slope.dot(*way))) continue;
        at = std::move(next);
        return true;
    }
    return false;
}

std::optional<Eigen::VectorXd> ContactStep::solve(const Eigen::MatrixXd& compliance,
                                                  const Eigen::VectorXd& without_m) const {
    const double least = least_compliance * compliance.diagonal().maxCoeff();
    auto stiffness = linalg::positive_inverse(compliance + least * Eigen::MatrixXd::Identity(size(), size()));
    if (!stiffness) return std::nullopt;
    const Problem problem{*std::move(stiffness), without_m};
    Place at{Eigen::VectorXd::Zero(size()), start_, 0};
    at.value = value(problem, at.delta, at.x);
    const std::vector<int> at_nodes = rows();
    double at_first = 0;
    for (int iteration = 0;; ++iteration) {
        Eigen::VectorXd forces = gradient(at.x);
        const Eigen::VectorXd slope = problem.stiffness * (at.delta - without_m) + forces(at_nodes);
        if (iteration == 0) at_first = slope.norm();
        if (slope.norm() <= small * at_first) return forces;
        if (iteration < most_iterations && descend(problem, slope, at)) continue;
        return slope.norm() <= enough * at_first ? std::optional(std::move(forces)) : std::nullopt;
    }
}

}  // namespace pliant::sim

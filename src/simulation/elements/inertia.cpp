#include "simulation/elements/inertia.hpp"

#include <cmath>

#include "simulation/elements/elements.hpp"

namespace pliant::sim {

Inertia::Inertia(const Elements& elements, const std::vector<int>& free_index, History begin, double dt,
                 const Damping& damping, std::shared_ptr<const StiffnessMatrix> stiffness)
    : elements_(&elements),
      free_index_(&free_index),
      start_(std::move(begin)),
      dt_(dt),
      damping_(damping),
      stiffness_(std::move(stiffness)) {
    const History& history = start_;
    even_ = history.dt_before > 0 && std::fabs(dt / history.dt_before - 1) < 1e-9;
    rate_ = even_ ? 1.5 / dt : 1 / dt;
    from_ = history.x;
    Eigen::VectorXd velocity = history.v;
    if (even_) {
        from_ = (4 * history.x - history.x_before) / 3;
        velocity = (4 * history.v - history.v_before) / 3;
    }
    coast_ = from_ + velocity / rate_;
}

Eigen::VectorXd Inertia::mass_times(const Eigen::VectorXd& v) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(v.size());
    elements_->apply_mass({v.data(), static_cast<std::size_t>(v.size())},
                          {result.data(), static_cast<std::size_t>(result.size())});
    return result;
}

Eigen::VectorXd Inertia::stiffness_times(const Eigen::VectorXd& v) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(v.size());
    if (!stiffness_) return force;
    const linalg::SymmetricPattern& pattern = *stiffness_->pattern;
    const auto& index = *free_index_;
    Eigen::VectorXd free = Eigen::VectorXd::Zero(pattern.size());
    for (std::size_t node = 0; node < index.size(); ++node) {
        if (index[node] >= 0) free.segment<3>(3 * index[node]) = v.segment<3>(3 * static_cast<Eigen::Index>(node));
    }
    Eigen::VectorXd product = Eigen::VectorXd::Zero(pattern.size());
    linalg::add_product(pattern, stiffness_->values, {free.data(), static_cast<std::size_t>(free.size())}, 1,
                        {product.data(), static_cast<std::size_t>(product.size())});
    for (std::size_t node = 0; node < index.size(); ++node) {
        if (index[node] >= 0)
            force.segment<3>(3 * static_cast<Eigen::Index>(node)) = product.segment<3>(3 * index[node]);
    }
    return force;
}

Eigen::VectorXd Inertia::damping_force(const Eigen::VectorXd& motion) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(motion.size());
    if (damping_.mass_per_s > 0) force += damping_.mass_per_s * mass_times(motion);
    if (stiffness_) force += damping_.stiffness_s * stiffness_times(motion);
    return force;
}

/// With p and q of the two last states or of the last: by p the gradient changes by -(c^2 M + c C), by q by -c M; the
/// velocity by -c and 0.
History Inertia::start_weights(const Eigen::VectorXd& force_weights, const Eigen::VectorXd& velocity_weights) const {
    const Eigen::VectorXd mass = -rate_ * mass_times(force_weights);
    const Eigen::VectorXd by_from = rate_ * (mass - damping_force(force_weights) - velocity_weights);
    if (!even_) return {by_from, mass, Eigen::VectorXd::Zero(mass.size()), Eigen::VectorXd::Zero(mass.size()), 0};
    return {4.0 / 3 * by_from, 4.0 / 3 * mass, -1.0 / 3 * by_from, -1.0 / 3 * mass, 0};
}

double Inertia::energy(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd off = x - coast_;
    const Eigen::VectorXd motion = x - from_;
    return 0.5 * rate_ * rate_ * off.dot(mass_times(off)) + 0.5 * rate_ * motion.dot(damping_force(motion));
}

void Inertia::add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& forces) const {
    forces += rate_ * rate_ * mass_times(x - coast_) + rate_ * damping_force(x - from_);
}

void Inertia::add_hessian(const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                          std::span<double> values) const {
    elements_->add_mass(index, pattern, values, rate_ * (rate_ + damping_.mass_per_s));
    if (!stiffness_) return;
    const linalg::SymmetricPattern& own = *stiffness_->pattern;
    std::vector<int> place(static_cast<std::size_t>(own.nodes));  // of each free node in the pattern
    for (std::size_t node = 0; node < index.size(); ++node) {
        if ((*free_index_)[node] >= 0) place[static_cast<std::size_t>((*free_index_)[node])] = index[node];
    }
    const double factor = rate_ * damping_.stiffness_s;
    for (int j = 0; j < own.nodes; ++j) {
        for (int k = own.node_start[j]; k < own.node_start[j + 1]; ++k) {
            const int row = place[own.node_row[k]], column = place[j];
            const double* block = stiffness_->values.data() + static_cast<std::size_t>(k) * own.block_entries();
            if (row >= column)
                pattern.add_block(values, row, column, [&](int r, int c) { return factor * block[3 * c + r]; });
            else
                pattern.add_block(values, column, row, [&](int r, int c) { return factor * block[3 * r + c]; });
        }
    }
}

}  // namespace pliant::sim

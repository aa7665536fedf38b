#include "simulation/elements/inertia.hpp"

#include <cmath>

#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

/// Weights of the last two states in a BDF2 step that is r times as long as the last one.
struct Bdf2Weights {
    double now, before;
};

Bdf2Weights bdf2_weights(double r) {
    return {(1 + r) * (1 + r) / (1 + 2 * r), -r * r / (1 + 2 * r)};
}

bool is_as_long_as_the_last(const History& history, double dt) {
    return history.dt_before > 0 && std::fabs(dt / history.dt_before - 1) < 1e-9;
}

}  // namespace

Inertia::Inertia(const Elements& elements, const std::vector<int>& free_index, History begin, double dt,
                 const Damping& damping, std::shared_ptr<const StiffnessMatrix> stiffness, Scheme scheme)
    : elements_(&elements),
      free_index_(&free_index),
      start_(std::move(begin)),
      dt_(dt),
      scheme_(scheme),
      damping_(damping),
      stiffness_(std::move(stiffness)) {
    if (scheme_ == Scheme::bdf2 && !(start_.dt_before > 0)) scheme_ = Scheme::euler;
    if (scheme_ == Scheme::bdf2) {
        set_uneven();
    } else if (scheme_ == Scheme::conserving) {
        set_conserving();
    } else {
        set_even();
    }
}

Inertia::Place Inertia::damping_place(const History& history, double dt, Scheme scheme) {
    const bool is_bdf2 = (scheme == Scheme::bdf2 && history.dt_before > 0) ||
                         (scheme == Scheme::even && is_as_long_as_the_last(history, dt));
    if (is_bdf2) return {1, dt, 0};
    if (scheme != Scheme::conserving || !(history.dt_before > 0)) return {1, 0.5 * dt, 0};
    const double share = 0.5 * dt / history.dt_before;
    return {1 + share, 0, -share};
}

void Inertia::set_even() {
    const History& history = start_;
    even_ = scheme_ == Scheme::even && is_as_long_as_the_last(history, dt_);
    rate_ = even_ ? 1.5 / dt_ : 1 / dt_;
    from_ = history.x;
    Eigen::VectorXd velocity = history.v;
    if (even_) {
        from_ = (4 * history.x - history.x_before) / 3;
        velocity = (4 * history.v - history.v_before) / 3;
    }
    coast_ = from_ + velocity / rate_;
    mass_rate_ = rate_ * rate_;
    mass_entry_ = rate_ * (rate_ + damping_.mass_per_s);
}

void Inertia::set_uneven() {
    const double r = dt_ / start_.dt_before;
    const auto [now, before] = bdf2_weights(r);
    rate_ = (1 + 2 * r) / ((1 + r) * dt_);
    from_ = now * start_.x + before * start_.x_before;
    coast_ = from_ + (now * start_.v + before * start_.v_before) / rate_;
    mass_rate_ = rate_ * rate_;
    mass_entry_ = rate_ * (rate_ + damping_.mass_per_s);
}

void Inertia::set_conserving() {
    rate_ = 1 / dt_;
    from_ = start_.x;
    coast_ = start_.x + dt_ * start_.v;
    mass_rate_ = 2 / (dt_ * dt_);
    mass_entry_ = mass_rate_ + rate_ * damping_.mass_per_s;
}

/// Held nodes follow their prescribed motion: for them the velocity of a conserving step, derived from the mean of both
/// ends, would oscillate about the true one for ever.
Eigen::VectorXd Inertia::velocity(const Eigen::VectorXd& x) const {
    if (scheme_ != Scheme::conserving) return rate_ * (x - from_);
    Eigen::VectorXd v = 2 * rate_ * (x - from_) - start_.v;
    for (std::size_t node = 0; node < free_index_->size(); ++node) {
        const auto at = 3 * static_cast<Eigen::Index>(node);
        if ((*free_index_)[node] < 0) v.segment<3>(at) = rate_ * (x.segment<3>(at) - from_.segment<3>(at));
    }
    return v;
}

/// The factor of the mass in the gradient, divided by its rate.
Eigen::VectorXd Inertia::off(const Eigen::VectorXd& x) const {
    Eigen::VectorXd off = x - coast_;
    if (scheme_ != Scheme::conserving) return off;
    for (std::size_t node = 0; node < free_index_->size(); ++node) {
        if ((*free_index_)[node] < 0) off.segment<3>(3 * static_cast<Eigen::Index>(node)) *= 0.5;
    }
    return off;
}

/// Errors are h^3 times the third derivative, times a constant for each of the two methods.
Eigen::VectorXd Inertia::error(const Eigen::VectorXd& x) const {
    const History& h = start_;
    const bool of_first_order = scheme_ == Scheme::euler || (scheme_ == Scheme::even && !even_);
    if (of_first_order) return 0.5 * dt_ * (velocity(x) - h.v);
    if (!(h.dt_before > 0)) return x - h.x - dt_ * h.v;
    const double r = dt_ / h.dt_before, onward = 1.0 / 6 + 1 / (4 * r);
    const double own = scheme_ == Scheme::conserving ? 1.0 / 12 : (1 + r) * (1 + r) / (6 * r * (1 + 2 * r));
    return own / (own + onward) * (x - h.x - dt_ * h.v - 0.5 * dt_ * r * (h.v - h.v_before));
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
    linalg::add_product(*stiffness_->pattern, stiffness_->values, {v.data(), static_cast<std::size_t>(v.size())}, 1,
                        {force.data(), static_cast<std::size_t>(force.size())});
    return force;
}

Eigen::VectorXd Inertia::damping_force(const Eigen::VectorXd& motion) const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(motion.size());
    if (damping_.mass_per_s > 0) force += damping_.mass_per_s * mass_times(motion);
    if (stiffness_) force += damping_.stiffness_s * stiffness_times(motion);
    return force;
}

/// With p and q from the last two states or the last one: with respect to p the gradient changes by -(c^2 M + c C),
/// with respect to q by -c M; the velocity by -c and 0.
History Inertia::start_weights(const Eigen::VectorXd& force_weights, const Eigen::VectorXd& velocity_weights) const {
    const Eigen::VectorXd mass = -rate_ * mass_times(force_weights);
    const Eigen::VectorXd by_from = rate_ * (mass - damping_force(force_weights) - velocity_weights);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(mass.size());
    if (start_.is_still) return {by_from, none, none, none, 0};
    if (scheme_ == Scheme::bdf2) {
        const auto [now, before] = bdf2_weights(dt_ / start_.dt_before);
        return {now * by_from, now * mass, before * by_from, before * mass, 0};
    }
    if (!even_) return {by_from, mass, none, none, 0};
    return {4.0 / 3 * by_from, 4.0 / 3 * mass, -1.0 / 3 * by_from, -1.0 / 3 * mass, 0};
}

double Inertia::evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& forces) const {
    const Eigen::VectorXd off = this->off(x), motion = x - from_;
    const Eigen::VectorXd inertia = mass_rate_ * mass_times(off), damping = rate_ * damping_force(motion);
    forces += inertia + damping;
    return 0.5 * (off.dot(inertia) + motion.dot(damping));
}

void Inertia::add_hessian(const BlockSums& sums, const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                          std::span<double> values) const {
    elements_->add_mass(sums, index, pattern, values, mass_entry_);
    if (!stiffness_) return;
    const linalg::SymmetricPattern& own = *stiffness_->pattern;
    const double factor = rate_ * damping_.stiffness_s;
    for (int j = 0; j < own.nodes; ++j) {
        for (int k = own.node_start[j]; k < own.node_start[j + 1]; ++k) {
            const int row = index[static_cast<std::size_t>(own.node_row[k])],
                      column = index[static_cast<std::size_t>(j)];
            if (row < 0 || column < 0) continue;
            const double* block = stiffness_->values.data() + static_cast<std::size_t>(k) * own.block_entries();
            if (row >= column)
                pattern.add_block(values, row, column, [&](int r, int c) { return factor * block[3 * c + r]; });
            else
                pattern.add_block(values, column, row, [&](int r, int c) { return factor * block[3 * r + c]; });
        }
    }
}

}  // namespace pliant::sim

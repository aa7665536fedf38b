#include "simulation/elements/inertia.hpp"

#include <cmath>

#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

bool is_as_long_as_the_last(const History& history, double dt) {
    return history.dt_before > 0 && std::fabs(dt / history.dt_before - 1) < 1e-9;
}

FreeRotation::Nodes at_nodes(const std::array<int, 4>& nodes, const Eigen::VectorXd& x) {
    FreeRotation::Nodes part;
    for (int a = 0; a < 4; ++a) part.col(a) = x.segment<3>(3 * nodes[static_cast<std::size_t>(a)]);
    return part;
}

void add_at_nodes(const std::array<int, 4>& nodes, const FreeRotation::Nodes& part, Eigen::VectorXd& x) {
    for (int a = 0; a < 4; ++a) x.segment<3>(3 * nodes[static_cast<std::size_t>(a)]) += part.col(a);
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
    set_scheme();
    turning_ = turning_objects();
    for (const Turning& object : turning_) shift(object, defect(object));
}

void Inertia::set_scheme() {
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
        share_now_ = 4.0 / 3;
        share_before_ = -1.0 / 3;
        from_ = (4 * history.x - history.x_before) / 3;
        velocity = (4 * history.v - history.v_before) / 3;
    }
    coast_ = from_ + velocity / rate_;
    mass_rate_ = rate_ * rate_;
    mass_entry_ = rate_ * (rate_ + damping_.mass_per_s);
}

void Inertia::set_uneven() {
    const double r = dt_ / start_.dt_before;
    share_now_ = (1 + r) * (1 + r) / (1 + 2 * r);
    share_before_ = -r * r / (1 + 2 * r);
    rate_ = (1 + 2 * r) / ((1 + r) * dt_);
    from_ = share_now_ * start_.x + share_before_ * start_.x_before;
    coast_ = from_ + (share_now_ * start_.v + share_before_ * start_.v_before) / rate_;
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

std::vector<Inertia::Turning> Inertia::turning_objects() const {
    std::vector<Turning> turning;
    if (start_.is_still || scheme_ == Scheme::conserving) return turning;
    for (const std::array<int, 4>& nodes : elements_->object_nodes())
        turning.push_back({nodes, {at_nodes(nodes, start_.x), at_nodes(nodes, start_.v)}});
    return turning;
}

Inertia::Defect Inertia::defect_of(const FreeRotation::Motion& before, const FreeRotation::Motion& now,
                                   const FreeRotation::Motion& after) const {
    return {after.v - rate_ * (after.x - share_now_ * now.x - share_before_ * before.x),
            after.a - rate_ * (after.v - share_now_ * now.v - share_before_ * before.v)};
}

Inertia::Defect Inertia::defect(const Turning& object) const {
    const double back = share_before_ != 0 ? -start_.dt_before : 0;
    return defect_of(object.motion.at(back), object.motion.at(0), object.motion.at(dt_));
}

Inertia::Defect Inertia::defect_change(const Turning& object, const FreeRotation::Nodes& dx,
                                       const FreeRotation::Nodes& dv) const {
    const double back = share_before_ != 0 ? -start_.dt_before : 0;
    return defect_of(object.motion.change(back, dx, dv), object.motion.change(0, dx, dv),
                     object.motion.change(dt_, dx, dv));
}

void Inertia::shift(const Turning& object, const Defect& by) {
    add_at_nodes(object.nodes, -by.v / rate_, from_);
    add_at_nodes(object.nodes, -by.v / rate_ - by.a / mass_rate_, coast_);
}

Inertia Inertia::change(History by) const {
    Inertia changed = *this;
    by.dt_before = start_.dt_before;
    by.is_still = start_.is_still;
    changed.start_ = std::move(by);
    changed.set_scheme();
    for (const Turning& object : turning_)
        changed.shift(object, defect_change(object, at_nodes(object.nodes, changed.start_.x),
                                            at_nodes(object.nodes, changed.start_.v)));
    return changed;
}

/// Errors are h^3 times the third derivative, times a constant for each of the two methods. Linear in all vectors.
template <class Vectors>
Vectors Inertia::error_from(const Vectors& x_end, const Vectors& v_end, const Vectors& x, const Vectors& v,
                            const Vectors& v_before) const {
    const bool of_first_order = scheme_ == Scheme::euler || (scheme_ == Scheme::even && !even_);
    if (of_first_order) return 0.5 * dt_ * (v_end - v);
    if (!(start_.dt_before > 0)) return x_end - x - dt_ * v;
    const double r = dt_ / start_.dt_before, onward = 1.0 / 6 + 1 / (4 * r);
    const double own = scheme_ == Scheme::conserving ? 1.0 / 12 : (1 + r) * (1 + r) / (6 * r * (1 + 2 * r));
    return own / (own + onward) * (x_end - x - dt_ * v - 0.5 * dt_ * r * (v - v_before));
}

Eigen::VectorXd Inertia::error(const Eigen::VectorXd& x) const {
    Eigen::VectorXd error = error_from<Eigen::VectorXd>(x, velocity(x), start_.x, start_.v, start_.v_before);
    for (const Turning& object : turning_) {
        const FreeRotation::Motion before = object.motion.at(-start_.dt_before), now = object.motion.at(0),
                                   after = object.motion.at(dt_);
        add_at_nodes(object.nodes, -error_from<FreeRotation::Nodes>(after.x, after.v, now.x, now.v, before.v), error);
    }
    return error;
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
/// with respect to q by -c M; the velocity by -c and 0. d_v shifts p by -1/c, and d_a is as -q c.
History Inertia::start_weights(const Eigen::VectorXd& force_weights, const Eigen::VectorXd& velocity_weights) const {
    const Eigen::VectorXd mass = -rate_ * mass_times(force_weights);
    const Eigen::VectorXd by_from = rate_ * (mass - damping_force(force_weights) - velocity_weights);
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(mass.size());
    if (start_.is_still) return {by_from, none, none, none, 0};
    History weights{share_now_ * by_from, share_now_ * mass, share_before_ * by_from, share_before_ * mass, 0};
    add_defect_weights(-by_from / rate_, -mass / rate_, weights);
    return weights;
}

/// `by_v` and `by_a` (3n): derivatives with respect to d_v and d_a.
void Inertia::add_defect_weights(const Eigen::VectorXd& by_v, const Eigen::VectorXd& by_a, History& weights) const {
    for (const Turning& object : turning_) {
        const FreeRotation::Nodes v = at_nodes(object.nodes, by_v), a = at_nodes(object.nodes, by_a);
        const auto worth = [&](const FreeRotation::Nodes& dx, const FreeRotation::Nodes& dv) {
            const Defect change = defect_change(object, dx, dv);
            return v.cwiseProduct(change.v).sum() + a.cwiseProduct(change.a).sum();
        };
        const FreeRotation::Nodes none = FreeRotation::Nodes::Zero();
        FreeRotation::Nodes by_x = none, by_start_v = none;
        for (Eigen::Index k = 0; k < none.size(); ++k) {
            FreeRotation::Nodes unit = none;
            unit(k) = 1;
            by_x(k) = worth(unit, none);
            by_start_v(k) = worth(none, unit);
        }
        add_at_nodes(object.nodes, by_x, weights.x);
        add_at_nodes(object.nodes, by_start_v, weights.v);
    }
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

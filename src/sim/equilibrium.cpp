#include "sim/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/elements.hpp"

namespace pliant::sim {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::span<const double> view(const Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}
std::span<double> view(Eigen::VectorXd& v) {
    return {v.data(), static_cast<std::size_t>(v.size())};
}

}  // namespace

Equilibrium::Equilibrium(const Model& model) : model_(&model) {
    const Description& d = model.description();
    const Eigen::Index n = model.node_count();
    rest_.resize(3 * n);
    external_ = Eigen::VectorXd::Zero(3 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Vec3& p = d.mesh.points[static_cast<std::size_t>(i)];
        rest_.segment<3>(3 * i) << p.x, p.y, p.z;
        const double mass = model.elements().node_mass_kg()[static_cast<std::size_t>(i)];
        external_.segment<3>(3 * i) += mass * Eigen::Vector3d(d.gravity_m_s2.x, d.gravity_m_s2.y, d.gravity_m_s2.z);
    }
    for (const Load& load : d.loads) {
        for (std::size_t k = 0; k < load.nodes.size(); ++k) {
            external_.segment<3>(3 * load.nodes[k]) +=
                load.shares[k] * Eigen::Vector3d(load.force_N.x, load.force_N.y, load.force_N.z);
        }
    }
    for (const Cable& cable : d.cables) {
        cables_.emplace_back(cable, view(std::as_const(rest_)));
        rest_length_.push_back(cables_.back().length(view(rest_)));
    }
    double stiffest = 0;
    for (const Material& material : d.materials) stiffest = std::max(stiffest, material::stiffness_bound(material.law));
    const double volume = mesh::volume(d.mesh);
    force_floor_ = 1e-9 * stiffest * std::pow(volume, 2.0 / 3);
    energy_rounding_ = 1e-16 * stiffest * volume;
}

Controls Equilibrium::controls(double time) const {
    Controls controls;
    controls.load_scale = time;
    const auto& cables = model_->description().cables;
    for (std::size_t c = 0; c < cables.size(); ++c) {
        const CableTarget& target = cables[c].target;
        double length = infinity;
        if (target.kind == CableTarget::Kind::length_ratio) length = rest_length_[c] * (1 + time * (target.value - 1));
        if (target.kind == CableTarget::Kind::shortening_m) length = rest_length_[c] - time * target.value;
        controls.cable_length_m.push_back(length);
        controls.cable_tension_N.push_back(target.kind == CableTarget::Kind::tension_N ? time * target.value : 0);
    }
    return controls;
}

State Equilibrium::rest() const {
    return {rest_, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(cables_.size()))};
}

void Equilibrium::place_supports(const Controls& controls, Eigen::VectorXd& x) const {
    for (const Support& support : model_->description().supports) {
        const Vec3 move = controls.load_scale * support.move_m;
        for (const int node : support.nodes) {
            x.segment<3>(3 * node) = rest_.segment<3>(3 * node) + Eigen::Vector3d(move.x, move.y, move.z);
        }
    }
}

double Equilibrium::external_work(const Eigen::VectorXd& x, double load_scale) const {
    return load_scale * external_.dot(x - rest_);
}

Evaluation Equilibrium::evaluate(const State& state, const Controls& controls) const {
    Evaluation e;
    Eigen::VectorXd internal = Eigen::VectorXd::Zero(state.x.size());
    const Elements::Evaluation elastic = model_->elements().evaluate(view(state.x), view(internal));
    e.min_J = elastic.min_J;
    if (!(e.min_J > 0)) return e;
    e.energy_J = elastic.energy_J - external_work(state.x, controls.load_scale);
    for (std::size_t c = 0; c < cables_.size(); ++c) {
        const double length = cables_[c].length(view(state.x));
        e.energy_J += controls.cable_tension_N[c] * length;
        const double excess = length - controls.cable_length_m[c];
        e.excess_m.push_back(excess);
        const bool pulls = state.tension[static_cast<Eigen::Index>(c)] > 0 && std::isfinite(excess);
        e.excess = std::max(e.excess, (pulls ? std::fabs(excess) : std::max(excess, 0.0)) / rest_length_[c]);
    }
    fill_residual(state, controls, internal, e);
    return e;
}

void Equilibrium::fill_residual(const State& state, const Controls& controls, const Eigen::VectorXd& internal,
                                Evaluation& e) const {
    Eigen::VectorXd driving = -controls.load_scale * external_;
    for (std::size_t c = 0; c < cables_.size(); ++c) {
        cables_[c].add_gradient(view(state.x), state.tension[static_cast<Eigen::Index>(c)], view(driving));
    }
    e.out_of_balance = internal + driving;
    const double unbalanced = restrict_to_free(e.out_of_balance).norm();
    const double balancing = std::max({internal.norm(), driving.norm(), force_floor_});
    e.residual = balancing > 0 ? unbalanced / balancing : 0;
}

Equilibrium::Merit Equilibrium::merit(const Eigen::VectorXd& x, const Controls& controls, double merit_weight) const {
    const Elements::Evaluation elastic = model_->elements().evaluate(view(x), {});
    Merit merit{elastic.min_J, 0};
    if (!(merit.min_J > 0)) return merit;
    merit.value_J = elastic.energy_J - external_work(x, controls.load_scale);
    for (std::size_t c = 0; c < cables_.size(); ++c) {
        const double length = cables_[c].length(view(x));
        merit.value_J += controls.cable_tension_N[c] * length;
        merit.value_J += merit_weight * std::max(length - controls.cable_length_m[c], 0.0);
    }
    return merit;
}

Eigen::VectorXd Equilibrium::restrict_to_free(const Eigen::VectorXd& full) const {
    Eigen::VectorXd free(3 * model_->free_count());
    const auto& index = model_->free_index();
    for (std::size_t node = 0; node < index.size(); ++node) {
        if (index[node] >= 0) free.segment<3>(3 * index[node]) = full.segment<3>(3 * static_cast<Eigen::Index>(node));
    }
    return free;
}

void Equilibrium::add_free(const Eigen::VectorXd& free, double factor, Eigen::VectorXd& full) const {
    const auto& index = model_->free_index();
    for (std::size_t node = 0; node < index.size(); ++node) {
        if (index[node] < 0) continue;
        full.segment<3>(3 * static_cast<Eigen::Index>(node)) += factor * free.segment<3>(3 * index[node]);
    }
}

}  // namespace pliant::sim

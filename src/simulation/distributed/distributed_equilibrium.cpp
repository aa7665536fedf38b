#include "simulation/distributed/distributed_equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/solver/drives.hpp"
#include "simulation/solver/residual.hpp"

namespace pliant::sim::distributed {

using linalg::view;

Result<DistributedEquilibrium> DistributedEquilibrium::create(const Ranks& ranks, Share share) {
    DistributedEquilibrium system;
    Result<Elements> elements = Elements::create(share.part);
    if (Status status = ranks.agree(elements ? Status{} : tl::unexpected(elements.error())); !status)
        return tl::unexpected(status.error());
    system.elements_ = std::make_unique<const Elements>(std::move(*elements));
    system.share_ = std::make_unique<const Share>(std::move(share));
    system.nodes_ = std::make_unique<const NodeExchange>(ranks, system.share());
    const Description& d = system.part();
    const auto n = static_cast<Eigen::Index>(d.mesh.points.size());
    system.all_nodes_.resize(static_cast<std::size_t>(n));
    std::iota(system.all_nodes_.begin(), system.all_nodes_.end(), 0);
    system.rest_.resize(3 * n);
    system.gravity_.resize(3 * n);
    for (Eigen::Index i = 0; i < n; ++i) {
        system.rest_.segment<3>(3 * i) = linalg::vector(d.mesh.points[static_cast<std::size_t>(i)]);
        system.gravity_.segment<3>(3 * i) =
            system.elements().node_mass_kg()[static_cast<std::size_t>(i)] * linalg::vector(d.gravity_m_s2);
    }
    system.hold_nodes();
    system.add_actuators();
    system.find_roundings();
    return system;
}

void DistributedEquilibrium::hold_nodes() {
    for (std::size_t s = 0; s < part().supports.size(); ++s) {
        if (part().supports[s].nodes.empty()) continue;
        supports_.push_back(part().supports[s]);
        support_.push_back(s);
    }
    // The supports of the whole robot were checked on root.
    held_ = std::make_unique<const HeldNodes>(*HeldNodes::create(supports_, static_cast<int>(all_nodes_.size())));
    for (const HeldNodes::Roller& roller : held_->rollers())
        if (share_->fixed[static_cast<std::size_t>(roller.node)] == 0)
            rollers_.push_back({roller.node, roller.may_move});
}

void DistributedEquilibrium::add_actuators() {
    const Description& d = part();
    const auto rest = view(std::as_const(rest_));
    const auto add_wall = [&](const Wall& wall) {
        actuators_.emplace_back();
        if (!wall.faces.empty()) actuators_.back().emplace(ChamberSurface(wall, rest), rest);
    };
    for (const Cable& cable : d.cables) {
        actuators_.emplace_back();
        if (!cable.points.empty()) actuators_.back().emplace(CablePath(cable.points, rest), rest);
    }
    for (const Chamber& chamber : d.chambers) add_wall(chamber.wall);
    for (const PressureLoad& load : d.pressures) add_wall(load.wall);
    rest_measures_ = measures(rest_);
}

void DistributedEquilibrium::find_roundings() {
    const Whole& whole = share_->whole;
    const bool skews = std::ranges::any_of(whole.pressure_skews, [](char skew) { return skew != 0; });
    conservative_ = elements().has_energy() && !skews;
    force_floor_ = 1e-9 * whole.stiffest_Pa * std::pow(whole.volume_m3, 2.0 / 3);
    energy_rounding_ = 1e-16 * whole.stiffest_Pa * whole.volume_m3;
    const double size = std::cbrt(whole.volume_m3 / whole.tets);
    force_rounding_ = 1e-16 * whole.stiffest_Pa * whole.farthest_m * size * std::sqrt(whole.nodes);
}

Controls DistributedEquilibrium::controls(double time) const {
    const Description& d = part();
    Controls controls;
    controls.time = time;
    controls.external_N = d.gravity_share.at(time) * gravity_;
    for (const Load& load : d.loads) {
        const Eigen::Vector3d total = load.share.at(time) * linalg::vector(load.force_N);
        for (std::size_t k = 0; k < load.nodes.size(); ++k)
            controls.external_N.segment<3>(3 * load.nodes[k]) += load.shares[k] * total;
    }
    for (const Support& support : d.supports) controls.support_share.push_back(support.share.at(time));
    for (std::size_t a = 0; a < actuators_.size(); ++a)
        controls.drives.push_back(drive_at(d, a, time, rest_measures_[a]));
    return controls;
}

State DistributedEquilibrium::rest() const {
    return {rest_, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(actuators_.size()))};
}

void DistributedEquilibrium::place_supports(const Controls& controls, Eigen::VectorXd& x) const {
    std::vector<double> shares;
    for (const std::size_t s : support_) shares.push_back(controls.support_share[s]);
    held_->place(supports_, part().mesh.points, shares, x);
}

std::vector<double> DistributedEquilibrium::measures(const Eigen::VectorXd& x) const {
    std::vector<double> sums(actuators_.size(), 0.0);
    for (std::size_t a = 0; a < sums.size(); ++a)
        if (actuators_[a]) sums[a] = actuators_[a]->measure(view(x));
    ranks().add_up(sums);
    return sums;
}

Evaluation DistributedEquilibrium::evaluate(const State& state, const Controls& controls) const {
    Evaluation e;
    Eigen::VectorXd internal = Eigen::VectorXd::Zero(state.x.size());
    const Elements::Evaluation elastic = elements().evaluate(view(state.x), view(internal));
    e.min_J = ranks().smallest(elastic.min_J);
    if (!(e.min_J > 0)) {
        e.flaw = Evaluation::Flaw::inverted;
        return e;
    }
    const std::vector<double> measures = this->measures(state.x);
    const std::size_t cables = part().cables.size();
    for (std::size_t a = cables; a < cables + part().chambers.size(); ++a)
        if (!(measures[a] > 0)) e.flaw = Evaluation::Flaw::collapsed;
    if (!e.possible()) return e;
    e.energy_J = ranks().sum(elastic.energy_J - controls.external_N.dot(state.x - rest_));
    e.multiplier = state.multiplier;
    e.constraint_violation = Eigen::VectorXd::Zero(state.multiplier.size());
    for (std::size_t a = 0; a < measures.size(); ++a)
        add_drive(controls.drives[a], a, {measures[a], rest_measures_[a], is_cable(a)}, part().ambient_pressure_Pa, e);
    Eigen::VectorXd driving = -controls.external_N;
    for (std::size_t a = 0; a < actuators_.size(); ++a)
        if (actuators_[a])
            actuators_[a]->add_gradient(view(state.x), e.multiplier[static_cast<Eigen::Index>(a)], view(driving));
    const Eigen::VectorXd all_internal = nodes().add_up(internal), all_driving = nodes().add_up(driving);
    e.out_of_balance = all_internal + all_driving;
    Eigen::VectorXd free = e.out_of_balance;
    restrict_to_free(free);
    std::array<double, 3> squares{free.squaredNorm(), all_internal.squaredNorm(), all_driving.squaredNorm()};
    ranks().add_up(squares);
    const double unbalanced = std::sqrt(squares[0]);
    const double balancing = std::max(std::sqrt(std::max(squares[1], squares[2])), force_floor_);
    e.residual = relative_residual(unbalanced, balancing, force_rounding_);
    return e;
}

double DistributedEquilibrium::potential_energy(const State& state, const Controls& controls) const {
    return ranks().sum(elements().evaluate(view(state.x), {}).energy_J - controls.external_N.dot(state.x - rest_));
}

Eigen::VectorXd DistributedEquilibrium::measure_gradient(std::size_t actuator, const Eigen::VectorXd& x) const {
    Eigen::VectorXd local = Eigen::VectorXd::Zero(x.size());
    if (actuators_[actuator]) actuators_[actuator]->add_gradient(view(x), 1 / rest_measures_[actuator], view(local));
    Eigen::VectorXd owned = nodes().add_up(local);
    restrict_to_free(owned);
    return owned;
}

std::vector<Vec3> DistributedEquilibrium::reactions(const Evaluation& evaluation) const {
    Eigen::VectorXd local = Eigen::VectorXd::Zero(nodes().local());
    local.head(nodes().owned()) = evaluation.out_of_balance;
    std::vector<double> sums(3 * part().supports.size(), 0.0);
    const std::vector<Vec3> own = held_->reactions(supports_, local);
    for (std::size_t k = 0; k < own.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c) sums[3 * support_[k] + c] = own[k][c];
    ranks().add_up(sums);
    std::vector<Vec3> forces;
    for (std::size_t s = 0; s < part().supports.size(); ++s)
        forces.push_back({sums[3 * s], sums[3 * s + 1], sums[3 * s + 2]});
    return forces;
}

linalg::Lists DistributedEquilibrium::cliques() const {
    linalg::Lists cliques = elements().cliques(all_nodes_);
    for (const auto& actuator : actuators_)
        if (actuator) actuator->append_cliques(all_nodes_, cliques);
    return cliques;
}

void DistributedEquilibrium::add_tangent(const State& state, const linalg::SymmetricPattern& pattern,
                                         const BlockSums& sums, std::span<double> values, bool project) const {
    elements().add_tangent(view(state.x), sums, values, project);
    for (std::size_t a = 0; a < actuators_.size(); ++a) {
        const double multiplier = state.multiplier[static_cast<Eigen::Index>(a)];
        if (actuators_[a] && multiplier != 0)
            actuators_[a]->add_hessian(view(state.x), multiplier, all_nodes_, pattern, values, project);
    }
}

void DistributedEquilibrium::add_skew(const State& state, const linalg::SymmetricPattern& pattern,
                                      std::span<double> values) const {
    elements().add_skew(view(state.x), all_nodes_, pattern, values);
    const std::size_t first = part().steered_count();
    for (std::size_t k = 0; k < part().pressures.size(); ++k) {
        if (share_->whole.pressure_skews[k] == 0 || !actuators_[first + k]) continue;
        actuators_[first + k]->add_skew(view(state.x), state.multiplier[static_cast<Eigen::Index>(first + k)],
                                        all_nodes_, pattern, values);
    }
}

void DistributedEquilibrium::restrict_to_free(Eigen::VectorXd& owned) const {
    for (Eigen::Index k = 0; 3 * k < owned.size(); ++k)
        if (share_->fixed[static_cast<std::size_t>(k)] != 0) owned.segment<3>(3 * k).setZero();
    for (const Roller& roller : rollers_)
        if (roller.node < share_->owned)
            owned.segment<3>(3 * roller.node) = (roller.may_move * owned.segment<3>(3 * roller.node)).eval();
}

}  // namespace pliant::sim::distributed

#include "simulation/solver/solved_actuators.hpp"

#include <algorithm>
#include <numeric>

#include "simulation/solver/drives.hpp"
#include "simulation/solver/held_multipliers.hpp"

namespace pliant::sim {
namespace {

constexpr double rounding = 1e-13;  // of a length, relative to that at rest

}  // namespace

SolvedActuators::SolvedActuators(const std::vector<Drive>& drives, const std::vector<bool>& only_pulls,
                                 const std::vector<double>& rest_measures) {
    for (std::size_t a = 0; a < drives.size(); ++a) {
        if (drives[a].kind == Drive::Kind::multiplier) continue;
        const auto actuator = static_cast<Eigen::Index>(a);
        all_.push_back({actuator, only_pulls[a], drives[a].kind == Drive::Kind::measure, rest_measures[a]});
        actuators_.push_back(actuator);
        only_pull_.push_back(only_pulls[a]);
    }
    scale_.resize(count());
    for (std::size_t k = 0; k < all_.size(); ++k) scale_[static_cast<Eigen::Index>(k)] = all_[k].rest_measure;
}

Eigen::VectorXd SolvedActuators::scaled(const Eigen::VectorXd& multiplier) const {
    return multiplier(actuators_).cwiseProduct(scale_);
}

Eigen::VectorXd SolvedActuators::compliances(const std::vector<Drive>& drives, const Eigen::VectorXd& multiplier,
                                             double ambient_pressure_Pa) const {
    Eigen::VectorXd compliance = Eigen::VectorXd::Zero(count());
    for (std::size_t k = 0; k < all_.size(); ++k) {
        const Drive& drive = drives[static_cast<std::size_t>(all_[k].actuator)];
        const double rest = all_[k].rest_measure;
        if (drive.kind == Drive::Kind::gas)
            compliance[static_cast<Eigen::Index>(k)] =
                gas_compliance(drive, multiplier[all_[k].actuator], ambient_pressure_Pa) / (rest * rest);
    }
    return compliance;
}

SolvedActuators::List SolvedActuators::list() const {
    List all(all_.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

Eigen::VectorXd SolvedActuators::change(const List& some, const Eigen::MatrixXd& S, const Eigen::VectorXd& violation,
                                        const Eigen::VectorXd& scaled_now) const {
    std::vector<bool> only_pull;
    for (const Eigen::Index k : some) only_pull.push_back(only_pull_[static_cast<std::size_t>(k)]);
    return multipliers_that_hold(S, violation + S * scaled_now, only_pull) - scaled_now;
}

bool SolvedActuators::is_too_long_beside(const List& some, const Eigen::VectorXd& violation) const {
    for (Eigen::Index k = 0; k < count(); ++k) {
        if (violation[k] > rounding && !std::ranges::binary_search(some, k)) return true;
    }
    return false;
}

std::vector<bool> SolvedActuators::taut(const Eigen::VectorXd& scaled_now, const Eigen::VectorXd& violation) const {
    std::vector<bool> taut(all_.size());
    for (std::size_t k = 0; k < all_.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        taut[k] = !all_[k].only_pulls || scaled_now[at] > 0 || violation[at] > 0;
    }
    return taut;
}

bool SolvedActuators::settle(std::vector<bool>& taut, const Eigen::VectorXd& scaled,
                             const Eigen::VectorXd& violation) const {
    bool settled = true;
    for (std::size_t k = 0; k < all_.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        if (!all_[k].only_pulls || !(taut[k] ? scaled[at] < 0 : violation[at] > rounding)) continue;
        taut[k] = !taut[k];
        settled = false;
    }
    return settled;
}

void SolvedActuators::add(const Eigen::VectorXd& change, Eigen::VectorXd& multiplier) const {
    multiplier(actuators_) += change.cwiseQuotient(scale_);
    for (const Constraint& one : all_) {
        if (one.only_pulls) multiplier[one.actuator] = std::max(multiplier[one.actuator], 0.0);
    }
}

}  // namespace pliant::sim

// The equations of one step: forces, cable constraints and the residual that says how far from equilibrium a state is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/cable_path.hpp"
#include "sim/model.hpp"

namespace pliant::sim {

/// Where the program wants the robot at one instant.
struct Controls {
    double load_scale = 0;                ///< share of all loads, gravity and prescribed motions
    std::vector<double> cable_length_m;   ///< (cables) longest length allowed; infinity where the tension is given
    std::vector<double> cable_tension_N;  ///< (cables) given tension; 0 where the length is
};

/// What a solver changes: node positions and the tension of every cable.
struct State {
    Eigen::VectorXd x;        ///< (3n) metres
    Eigen::VectorXd tension;  ///< (cables) N, never negative
};

/// Everything that is known about a state at given controls.
struct Evaluation {
    double min_J = 0;                ///< if not positive, nothing below is filled
    double energy_J = 0;             ///< elastic, minus the work of loads, plus given tension times length
    Eigen::VectorXd out_of_balance;  ///< (3n) internal - external forces + tension * dL/dx; at supports the reaction
    std::vector<double> excess_m;    ///< (cables) length - allowed length (minus infinity where the tension is given)
    double residual = 0;             ///< DESIGN: out-of-balance force over the forces that balance, both 2-norms
    double excess = 0;               ///< largest violated length (or slack under tension) over the rest length
    [[nodiscard]] double error() const { return residual > excess ? residual : excess; }
};

/// The discrete system of one model; holds no state.
class Equilibrium {
public:
    explicit Equilibrium(const Model& model);

    [[nodiscard]] Controls controls(double time) const;
    [[nodiscard]] State rest() const;
    /// Puts the nodes of the supports where `controls` wants them.
    void place_supports(const Controls& controls, Eigen::VectorXd& x) const;

    [[nodiscard]] Evaluation evaluate(const State& state, const Controls& controls) const;
    /// Energy and lengths only: what a line search needs. `merit_weight` (cables) is the price of a metre of excess.
    struct Merit {
        double min_J = 0;
        double value_J = 0;
    };
    [[nodiscard]] Merit merit(const Eigen::VectorXd& x, const Controls& controls, double merit_weight) const;

    [[nodiscard]] const Model& model() const { return *model_; }
    [[nodiscard]] const std::vector<CablePath>& cables() const { return cables_; }
    [[nodiscard]] double rest_length_m(std::size_t cable) const { return rest_length_[cable]; }

    /// Energies that differ by less than this are the same to rounding.
    [[nodiscard]] double energy_rounding_J() const { return energy_rounding_; }

    /// (3n) -> (3 free nodes) and back; the rest of `full` is left alone.
    [[nodiscard]] Eigen::VectorXd restrict_to_free(const Eigen::VectorXd& full) const;
    void add_free(const Eigen::VectorXd& free, double factor, Eigen::VectorXd& full) const;

private:
    [[nodiscard]] double external_work(const Eigen::VectorXd& x, double load_scale) const;
    void fill_residual(const State& state, const Controls& controls, const Eigen::VectorXd& internal,
                       Evaluation& e) const;

    const Model* model_;
    std::vector<CablePath> cables_;
    std::vector<double> rest_length_;
    Eigen::VectorXd rest_;      ///< (3n)
    Eigen::VectorXd external_;  ///< (3n) all loads and gravity at full scale
    double force_floor_ = 0;    ///< forces below this are rounding, not load
    double energy_rounding_ = 0;
};

}  // namespace pliant::sim

// A program solved for certain values of the unknowns: what would have been measured, and how that changes with them.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/identify/channel.hpp"
#include "simulation/identify/source.hpp"
#include "simulation/linearisation/linearisation.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim::identify {

/// How the numbers that a state is a function of change with the unknowns, each by a change of 1 in its coordinate.
struct Rates {
    Eigen::MatrixXd parameters;           ///< (sim::parameters(), unknowns)
    std::vector<Eigen::MatrixXd> drives;  ///< (pieces) of (drives, unknowns)
};

/// Keeps every state that it has solved: so many times the robot's positions.
class Trial {
public:
    /// At times in [0, duration]. A robot at rest at every instant and without friction of contact is solved at each of
    /// them, beside the steps of its program; in between, others are interpolated between two steps. Errors: a step
    /// that does not converge; cancelled.
    [[nodiscard]] static Result<std::unique_ptr<Trial>> solve(std::unique_ptr<Variant> variant,
                                                              std::span<const Channel> channels,
                                                              std::span<const double> times, Progress& progress);

    /// (times, channels), in the channels' units.
    [[nodiscard]] const Eigen::MatrixXd& values() const { return values_; }
    /// (times) of (channels, unknowns): by the linearisation of each state; through the steps before it where there is
    /// friction of contact or motion in time. What is lagged stays as in Linearisation. Errors: a state that has no
    /// derivative; cancelled.
    [[nodiscard]] Result<std::vector<Eigen::MatrixXd>> slopes(const Source& source, std::span<const Unknown> unknowns,
                                                              std::span<const double> at, Progress& progress) const;

private:
    /// An equilibrium on the way; `stop` says which it is the end of, -1: none.
    struct Piece {
        int stop = -1;
        sim::State state;
        sim::Controls controls;
        sim::KnownPattern pattern{};
    };
    /// A time between two stops.
    struct Place {
        std::size_t before = 0, after = 0;
        double share = 0;
    };
    struct Forward;

    Trial(std::unique_ptr<Variant> variant, std::span<const Channel> channels);
    [[nodiscard]] bool has_history() const;
    void plan(std::span<const double> times);
    [[nodiscard]] Status run(Progress& progress);
    [[nodiscard]] Eigen::VectorXd channel_values(const Piece& piece) const;
    void keep_values();
    [[nodiscard]] Result<Rates> rates(const Source& source, std::span<const Unknown> unknowns,
                                      std::span<const double> at) const;
    [[nodiscard]] Result<Eigen::MatrixXd> piece_slopes(const Piece& piece, const Rates& rates, std::size_t k,
                                                       Forward& forward) const;

    std::unique_ptr<Variant> variant_;
    std::vector<Channel> channels_;
    std::unique_ptr<sim::Stepper> stepper_;
    std::vector<double> stops_;  ///< ascending, the first is rest
    std::vector<Place> places_;  ///< (times)
    std::vector<Piece> pieces_;  ///< in order, the first is rest
    Eigen::MatrixXd values_;
};

}  // namespace pliant::sim::identify

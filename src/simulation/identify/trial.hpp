// A program solved for given values of the unknowns: simulated measurements, and their derivatives.
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

/// Derivatives of the numbers that a state depends on with respect to the coordinate of each unknown.
struct Rates {
    Eigen::MatrixXd parameters;           ///< (sim::parameters(), unknowns)
    std::vector<Eigen::MatrixXd> drives;  ///< (pieces) of (drives, unknowns)
};

/// Keeps every state that it has solved; memory: the positions of all of them.
class Trial {
public:
    /// Solves for times in [0, duration]. A quasi-static robot without contact friction is solved at each of them, in
    /// addition to the steps of its program; otherwise values are interpolated between two steps. Errors: a step that
    /// does not converge; cancelled.
    [[nodiscard]] static Result<std::unique_ptr<Trial>> solve(std::unique_ptr<Variant> variant,
                                                              std::span<const Channel> channels,
                                                              std::span<const double> times, Progress& progress);

    /// (times, channels), in the channels' units.
    [[nodiscard]] const Eigen::MatrixXd& values() const { return values_; }
    /// (channels) values at rest, in the channels' units.
    [[nodiscard]] Eigen::VectorXd rest() const { return channel_values(pieces_.front()); }
    /// (times) of (channels, unknowns): by linearising each state and, with contact friction or a motion in time,
    /// through the steps before it. Lagged quantities are held fixed as in Linearisation. Errors: a state that has no
    /// derivative; cancelled.
    [[nodiscard]] Result<std::vector<Eigen::MatrixXd>> slopes(const Source& source, std::span<const Unknown> unknowns,
                                                              std::span<const double> at, Progress& progress) const;

private:
    /// An intermediate equilibrium; `stop`: index of the stop that it ends at, -1: none.
    struct Piece {
        int stop = -1;
        sim::State state;
        sim::Controls controls;
        sim::KnownPattern pattern{};
    };
    /// Interpolation between two stops.
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

/// @file
/// Reduced-order models: a robot with a few modes instead of thousands of nodes, for control loops and policies.
/// Hundreds to thousands of equilibria a second, with an estimate of their error and a way back to the whole robot.
///
///     const pliant::ReducedModel reduced = pliant::reduce(model);
///     pliant::ReducedStepper stepper(reduced);
///     pliant::ReducedState state = stepper.start();
///     stepper.step(state, inputs);
///     if (stepper.estimate(state).error_m > 1e-4) whole = stepper.exact(state);
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/inverse.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// Options of reduce().
struct ReductionOptions {
    /// Equilibria to learn from, spread over the ranges of the actuators, at most 100,000; 0: 24 for each actuator, but
    /// at most 240.
    int samples = 0;
    double basis_error = 1e-4;  ///< share of the motion of the samples that the modes may leave out, above 0, below 1
    double force_error = 1e-4;  ///< share of the forces in the modes that the weighted tets may miss, above 0, below 1
    int most_modes = 60;        ///< largest number of modes, 1 to 1000
};

/// A reduced model of a robot. A value; copies share immutable data.
class PLIANT_API ReducedModel {
public:
    /// Reads a model that save() wrote.
    /// @throws Failure if the file cannot be read, is damaged, or was made for another robot or with other settings.
    [[nodiscard]] static ReducedModel load(const Model& model, const std::filesystem::path& file);
    /// Writes the reduced model to a file, whole or not at all.
    /// @throws Failure if the file cannot be written.
    void save(const std::filesystem::path& file) const;

    /// The whole robot.
    [[nodiscard]] const Model& whole() const;
    /// The inputs whose ranges the samples cover.
    [[nodiscard]] const std::vector<SteeredInput>& inputs() const;
    /// Number of modes.
    [[nodiscard]] std::size_t mode_count() const;
    /// Number of tetrahedra that are evaluated.
    [[nodiscard]] std::size_t tet_count() const;
    /// Number of equilibria that the model was made from.
    [[nodiscard]] std::size_t sample_count() const;
    /// Share of the forces of the samples that the weighted tetrahedra miss.
    [[nodiscard]] double force_error() const;
    /// Remarks on how it was made, one sentence each: samples that were left out, a target that was not reached. A
    /// model that was loaded has none.
    [[nodiscard]] const std::vector<std::string>& notes() const;

    /// @cond
    struct Data;
    explicit ReducedModel(std::shared_ptr<const Data> data);
    [[nodiscard]] const std::shared_ptr<const Data>& data() const { return data_; }

private:
    SharedData<const Data> data_;
    /// @endcond
};

/// An equilibrium of a reduced model. A value.
class PLIANT_API ReducedState {
public:
    /// The inputs at which it is in equilibrium.
    [[nodiscard]] Inputs inputs() const;
    /// (modes) m, how much of each mode.
    [[nodiscard]] std::vector<double> amplitudes() const;
    /// (Model::markers()) m.
    [[nodiscard]] std::vector<Point> markers() const;
    /// (Model::cables()) N.
    [[nodiscard]] std::vector<double> tensions_N() const;
    /// (Model::chambers()) Pa above ambient.
    [[nodiscard]] std::vector<double> pressures_Pa() const;
    /// (nodes) m, of all nodes of the whole robot.
    [[nodiscard]] std::vector<Point> positions() const;

    /// @cond
    struct Data;
    explicit ReducedState(std::shared_ptr<const Data> data);
    [[nodiscard]] const Data& data() const { return *data_; }

private:
    SharedData<const Data> data_;
    /// @endcond
};

/// Result of a step of a reduced model.
struct ReducedStep {
    bool found = false;  ///< the state is the equilibrium at the inputs; otherwise it is unchanged
    int iterations = 0;  ///< of Newton's method
};

/// Estimated difference between a reduced state and the equilibrium of the whole robot at the same inputs.
struct ReducedError {
    double error_m = 0;                ///< largest of any node; infinite if the whole robot cannot be there
    std::vector<double> markers_m;     ///< (Model::markers()); empty if error_m is infinite
    std::vector<double> tensions_N;    ///< (Model::cables()); likewise
    std::vector<double> pressures_Pa;  ///< (Model::chambers()); likewise
};

/// A reduced model beside the whole robot, at inputs that it was not made from.
struct ReductionCheck {
    std::vector<double> inputs;  ///< (ReducedModel::inputs()) value of each, in its SteeredInput::unit
    bool found = false;          ///< both have an equilibrium; otherwise the values below have no meaning
    bool touching = false;       ///< the whole robot touches itself there, which the reduced model does not know
    double motion_m = 0;         ///< largest motion of a node of the whole robot, from rest
    double error_m = 0;          ///< largest difference of a node
    double estimated_m = 0;      ///< estimate of that, as ReducedStepper::estimate() gives it
    double force_error = 0;      ///< largest of tensions and pressures, relative to the largest of the samples
    double reduced_s = 0;        ///< wall time of the reduced step, from the inputs before
    double estimate_s = 0;       ///< of the estimate
    double whole_s = 0;          ///< of the step of the whole robot
};

/// Solves a reduced model. Any number of steppers may share a model; each works for one caller at a time: while it
/// does, on another thread or in a Watch, its other members throw a Failure, except start(). It takes states of its
/// model and of copies of that.
class PLIANT_API ReducedStepper {
public:
    /// Sets up the solver.
    explicit ReducedStepper(const ReducedModel& model);
    /// Moves; the moved-from stepper may only be assigned to or destroyed.
    ReducedStepper(ReducedStepper&&) noexcept;
    /// Moves; the moved-from stepper may only be assigned to or destroyed.
    ReducedStepper& operator=(ReducedStepper&&) noexcept;
    ~ReducedStepper();

    /// A state to begin with: the first sample, without actuation if that has an equilibrium.
    [[nodiscard]] ReducedState start() const;
    /// Solves for the equilibrium at `inputs`, from `state`, and stores it there. Equal states and inputs give equal
    /// results.
    /// @throws Failure of kind `input` if the state belongs to another model, or the inputs do not match the robot.
    ReducedStep step(ReducedState& state, const Inputs& inputs);
    /// Estimates the error by one step of Newton's method on the whole robot, projected on all modes of the samples:
    /// some tens of times as expensive as a step of the reduced model, and much cheaper than exact(). It does not see
    /// motions that no sample has.
    /// @throws Failure of kind `input` if the state belongs to another model.
    [[nodiscard]] ReducedError estimate(const ReducedState& state);
    /// The equilibrium of the whole robot at the same inputs, searched from the reduced one; a state of whole().
    /// @throws Failure of kind `input` if the state belongs to another model, of kind `failed` if no equilibrium is
    /// found, or when cancelled.
    [[nodiscard]] State exact(const ReducedState& state, const Watch& watch = {});

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

/// Makes a reduced model: solves for equilibria of the whole robot within the ranges of its actuators, finds the modes
/// of which they are made (proper orthogonal decomposition), and a few tetrahedra whose weighted forces stand for all
/// (energy-conserving sampling and weighting).
/// @throws Failure if an option is out of range; if no actuator has a range; if the robot has contact, friction, moving
/// supports, joints or motion in time, which reduced models do not cover; if no equilibrium is found; or when
/// cancelled.
[[nodiscard]] PLIANT_API ReducedModel reduce(const Model& model, const ReductionOptions& options = {},
                                             const Watch& watch = {});

/// Compares a reduced model with the whole robot at `count` inputs spread over the ranges.
/// @throws Failure if `count` is negative or above 100,000, or when cancelled.
[[nodiscard]] PLIANT_API std::vector<ReductionCheck> check_reduction(const ReducedModel& model, int count,
                                                                     const Watch& watch = {});

}  // namespace pliant

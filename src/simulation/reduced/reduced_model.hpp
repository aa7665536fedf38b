// A reduced-order model of a robot: its motion is a sum of a few modes, and a few of its tets stand for all of them.
//
// Equilibria at inputs spread over the ranges of the actuators are the snapshots. Their proper orthogonal decomposition
// gives the modes V, so that x = X + V q. The forces of the tets, V^T f, are sums over a few tets with weights that
// are fitted to the snapshots: energy-conserving sampling and weighting (Farhat, Avery, Chapman and Cortial 2014).
// Cables, chambers, springs, plates and loads act as on the whole robot. docs/theory.md, "Reduced models".
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "simulation/parts/inverse_task.hpp"
#include "simulation/reduced/projected_system.hpp"
#include "simulation/reduced/sparse_weights.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim::reduced {

struct ReductionOptions {
    int samples = 0;            ///< equilibria to learn from; 0: by the number of inputs
    double basis_error = 1e-4;  ///< share of the motion of the samples that the modes may leave out
    double force_error = 1e-4;  ///< share of the forces in the modes that the weighted tets may miss
    int most_modes = 60;
};

/// An equilibrium of the whole robot that the model was made from.
struct Sample {
    Inputs inputs;
    State state;
    Eigen::VectorXd amplitudes;  ///< (modes in use)
};

/// What a reduced model is made of; a value that can be stored.
struct Reduction {
    /// (3n, all) orthonormal, the most important first, zero where supports hold nodes. The model uses the first few;
    /// the estimate of its error uses all.
    Eigen::MatrixXd modes;
    Eigen::Index used = 0;
    std::vector<Weight> tets;        ///< the tets that count, with their weights
    std::vector<Weight> check_tets;  ///< those of the estimate
    std::vector<Sample> samples;     ///< at least one
    double force_error = 0;          ///< of `tets`, as reached
    /// Samples that were left out because no equilibrium was found there or with less actuation; and likewise because
    /// the robot touches itself.
    int not_found = 0, touching = 0;
};

/// Solves samples and chooses modes and tets. `task` names the inputs and their ranges. Errors: check_reducible(); no
/// equilibrium is found; cancelled.
[[nodiscard]] Result<Reduction> reduce(const Model& model, const StepperOptions& stepping, const InverseTask& task,
                                       const ReductionOptions& options, Progress& progress);

/// A reduction, ready to be solved. Immutable.
class ReducedModel {
public:
    /// `model` must outlive it. Errors: the reduction does not fit the model.
    [[nodiscard]] static Result<ReducedModel> create(const Model& model, Reduction reduction);

    [[nodiscard]] const Model& whole() const { return *model_; }
    [[nodiscard]] const Reduction& reduction() const { return reduction_; }
    [[nodiscard]] Eigen::Index mode_count() const { return reduction_.used; }
    /// Largest norm of the amplitudes of a sample, m: what a step is measured with.
    [[nodiscard]] double reach_m() const { return reach_m_; }

    /// With the modes in use, for solutions.
    [[nodiscard]] const ProjectedModel& part() const { return *part_; }
    /// With all modes, for the estimate of the error.
    [[nodiscard]] const ProjectedModel& check_part() const { return *check_part_; }
    /// (3n) m, of all nodes; `amplitudes` of as many modes as wanted.
    [[nodiscard]] Eigen::VectorXd positions(const Eigen::VectorXd& amplitudes) const {
        return rest_ + reduction_.modes.leftCols(amplitudes.size()) * amplitudes;
    }
    /// Index of the sample that is nearest to the inputs, by whatever quantities these drive the actuators.
    [[nodiscard]] std::size_t nearest_sample(const Inputs& inputs) const;
    /// How far apart inputs are that drive each actuator by the same quantity, in units of what a step usually takes.
    [[nodiscard]] double distance(const Inputs& from, const Inputs& to) const;
    /// The inputs of a sample, as if each actuator were driven by the same quantity as in `like`.
    [[nodiscard]] Inputs inputs_of_sample(std::size_t sample, const Inputs& like) const;

private:
    ReducedModel() = default;
    void take_measures(const std::vector<Sample>& samples);
    const Model* model_ = nullptr;
    Reduction reduction_;
    std::optional<ProjectedModel> part_, check_part_;
    std::unique_ptr<InputUnits> units_;
    Eigen::VectorXd rest_;                       ///< (3n)
    std::vector<std::vector<double>> measures_;  ///< (samples)(actuators) m or m^3
    double reach_m_ = 0;
};

}  // namespace pliant::sim::reduced

// How a reduction is made: samples, modes, weighted tets.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/core/parallel.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/inverse/input_space.hpp"
#include "simulation/material/response.hpp"
#include "simulation/reduced/reduced_model.hpp"
#include "simulation/reduced/sampled_robot.hpp"
#include "simulation/reduced/self_contact.hpp"
#include "simulation/reduced/snapshot_basis.hpp"
#include "simulation/reduced/sparse_weights.hpp"

namespace pliant::sim::reduced {
namespace {

using inverse::InputSpace;

constexpr int least_samples = 24, samples_per_input = 24, most_samples = 240;
constexpr int most_ends = 4;                    ///< inputs up to which every corner of the ranges is a sample
constexpr int most_states = 24;                 ///< samples whose forces the tets are fitted to
constexpr std::size_t most_candidates = 20000;  ///< tets among which some are chosen
constexpr std::size_t tets_at_once = 64;
// The estimate of the error uses further modes, down to this share of the motion, and needs forces for a tangent only.
constexpr double check_basis_error = 1e-6, check_force_error = 1e-3;
constexpr int most_check_modes = 3;   ///< times the modes in use, and ten
constexpr double least_scale = 0.05;  ///< of the largest force: smaller ones are fitted less strictly

// --- samples ---------------------------------------------------------------------------------------------------------

/// Inputs as shares of the ranges: no actuation, all corners if there are few, and points spread in between.
std::vector<Eigen::VectorXd> places(const InputSpace& space, int wanted) {
    std::vector<Eigen::VectorXd> list{space.rest()};
    const Eigen::Index size = space.size();
    for (unsigned corner = 0; size <= most_ends && corner < 1U << static_cast<unsigned>(size); ++corner) {
        Eigen::VectorXd shares(size);
        for (Eigen::Index i = 0; i < size; ++i) shares[i] = (corner >> static_cast<unsigned>(i) & 1U) != 0 ? 1 : 0;
        list.push_back(std::move(shares));
    }
    for (int k = 1; static_cast<int>(list.size()) < wanted; ++k) list.push_back(inverse::spread_point(k, size));
    return list;
}

class SampleSolver {
public:
    SampleSolver(const Model& model, const StepperOptions& stepping, const InverseTask& task, Progress& progress)
        : stepper_(model, stepping), task_(task), space_(stepper_, task), progress_(progress) {}

    /// Solves each from the nearest one that is solved. Beyond one that fails, or touches, none is tried.
    [[nodiscard]] Status solve(int wanted, Reduction& reduction) {
        std::vector<Eigen::VectorXd> open = places(space_, wanted);
        const std::size_t all = open.size();
        known_ = {{space_.rest(), stepper_.rest()}};
        while (!open.empty()) {
            progress_.advance("reduce: samples", 1 - static_cast<double>(open.size()) / static_cast<double>(all));
            if (progress_.cancelled()) return cancelled();
            const auto [from, next] = nearest(open);
            const Eigen::VectorXd shares = open[next];
            open.erase(open.begin() + static_cast<std::ptrdiff_t>(next));
            int* const missed = take(known_[from].second, shares, reduction);
            // More actuation will not do better, and contact takes the longest.
            if (missed != nullptr)
                *missed +=
                    1 + static_cast<int>(std::erase_if(open, [&](const auto& p) { return is_beyond(p, shares); }));
        }
        if (progress_.cancelled()) return cancelled();
        if (reduction.samples.empty())
            return failure(
                "none of {} inputs within the ranges has an equilibrium that a reduced model can be made "
                "from: for {} none was found, and in {} the robot touches itself",
                all, reduction.not_found, reduction.touching);
        return {};
    }

private:
    [[nodiscard]] std::pair<std::size_t, std::size_t> nearest(const std::vector<Eigen::VectorXd>& open) const {
        std::pair<std::size_t, std::size_t> best{0, 0};
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t from = 0; from < known_.size(); ++from) {
            for (std::size_t next = 0; next < open.size(); ++next) {
                const double distance = (known_[from].first - open[next]).squaredNorm();
                if (!(distance < least)) continue;
                least = distance;
                best = {from, next};
            }
        }
        return best;
    }

    /// Null: a sample. Otherwise the count of what it is instead.
    [[nodiscard]] int* take(RobotState robot, const Eigen::VectorXd& shares, Reduction& reduction) {
        if (!stepper_.drive(robot, space_.inputs(shares, task_.times.back()), progress_).arrived)
            return &reduction.not_found;
        if (touches_itself(stepper_, robot)) return &reduction.touching;
        robot.memory = nullptr;
        robot.past.clear();
        reduction.samples.push_back({robot.inputs, robot.now.state, {}});
        known_.emplace_back(shares, std::move(robot));
        return nullptr;
    }

    /// True if every actuator is at `point` actuated at least as much as at `other`.
    [[nodiscard]] bool is_beyond(const Eigen::VectorXd& point, const Eigen::VectorXd& other) const {
        const Eigen::ArrayXd rest = space_.rest(), p = point.array() - rest, q = other.array() - rest;
        return (p * q >= 0).all() && (p.abs() >= q.abs()).all();
    }

    Stepper stepper_;
    const InverseTask& task_;
    InputSpace space_;
    Progress& progress_;
    std::vector<std::pair<Eigen::VectorXd, RobotState>> known_;
};

// --- tets ------------------------------------------------------------------------------------------------------------

/// What single tets do in the modes: result (modes) += V^T f.
class TetForces {
public:
    TetForces(const Elements& elements, const Description& description, const Eigen::MatrixXd& modes)
        : elements_(elements), description_(description), modes_(modes) {}

    /// Internal forces at positions x (3n). False: the tet is inverted.
    [[nodiscard]] bool add_internal(std::size_t t, const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> result) const {
        for (int q = 0; q < elements_.points_per_tet(); ++q) {
            const linalg::Matrix3 F = elements_.deformation_gradient(t, q, linalg::view(x));
            if (!(F.determinant() > 0)) return false;
            const linalg::Matrix3 P = elements_.point_volume(t, q) * material::stress(elements_.law(t), F);
            for (int a = 0; a < static_cast<int>(elements_.nodes_per_tet()); ++a)
                result += modes_at(t, a).transpose() * (P * linalg::vector(elements_.shape_gradient(t, q, a)));
        }
        return true;
    }
    /// The weight of the tet with all of gravity.
    void add_weight(std::size_t t, Eigen::Ref<Eigen::VectorXd> result) const {
        const double density = description_.materials[static_cast<std::size_t>(elements_.material(t))].density_kg_m3;
        const Eigen::Vector3d gravity = linalg::vector(description_.gravity_m_s2);
        for (int q = 0; q < elements_.points_per_tet(); ++q) {
            const double mass = density * elements_.point_volume(t, q);
            for (int a = 0; a < static_cast<int>(elements_.nodes_per_tet()); ++a)
                result += mass * elements_.shape_value(q, a) * (modes_at(t, a).transpose() * gravity);
        }
    }

private:
    using Modes = Eigen::Block<const Eigen::MatrixXd, 3>;
    /// (3, modes) of a node of a tet.
    [[nodiscard]] Modes modes_at(std::size_t t, int a) const {
        return modes_.middleRows<3>(3 * static_cast<Eigen::Index>(elements_.node_of(t, a)));
    }
    const Elements& elements_;
    const Description& description_;
    const Eigen::MatrixXd& modes_;
};

/// Some of the samples, spread over the list.
std::vector<std::size_t> chosen_states(std::size_t count) {
    std::vector<std::size_t> chosen;
    const std::size_t wanted = std::min<std::size_t>(count, most_states);
    for (std::size_t k = 0; k < wanted; ++k) chosen.push_back(k * count / wanted);
    return chosen;
}

/// The forces in the modes of each candidate, (modes * states, candidates), and of all tets together.
struct Training {
    std::vector<std::size_t> candidates;
    Eigen::MatrixXd columns;
    Eigen::VectorXd all;
};

void add_state(const std::function<bool(std::size_t, Eigen::Ref<Eigen::VectorXd>)>& force, std::size_t tets,
               Eigen::Index first, Eigen::Index modes, Training& training) {
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(modes, static_cast<Eigen::Index>(tets));
    std::vector<char> good(tets, 1);
    parallel_for(tets, tets_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) good[t] = force(t, forces.col(static_cast<Eigen::Index>(t))) ? 1 : 0;
    });
    if (!std::ranges::all_of(good, [](char one) { return one != 0; })) return;  // rows of zeros ask for nothing
    training.all.segment(first, modes) = forces.rowwise().sum();
    for (std::size_t k = 0; k < training.candidates.size(); ++k)
        training.columns.block(first, static_cast<Eigen::Index>(k), modes, 1) =
            forces.col(static_cast<Eigen::Index>(training.candidates[k]));
}

/// Makes each state count alike, whatever its forces are; the smallest count less.
void balance(Eigen::Index modes, Training& training) {
    const Eigen::Index states = training.all.size() / modes;
    Eigen::VectorXd sizes(states);
    for (Eigen::Index s = 0; s < states; ++s) sizes[s] = training.all.segment(s * modes, modes).norm();
    for (Eigen::Index s = 0; s < states; ++s) {
        const double size = std::max(sizes[s], least_scale * sizes.maxCoeff());
        if (!(size > 0)) continue;
        training.all.segment(s * modes, modes) /= size;
        training.columns.middleRows(s * modes, modes) /= size;
    }
}

Training training_of(const Model& model, const Reduction& reduction, const Eigen::MatrixXd& in_modes,
                     Progress& progress) {
    const Elements& elements = model.elements();
    const Eigen::Index modes = in_modes.cols();
    const std::size_t tets = elements.tet_count(), stride = (tets + most_candidates - 1) / most_candidates;
    const TetForces forces(elements, model.description(), in_modes);
    const std::vector<std::size_t> states = chosen_states(reduction.samples.size());
    const bool weighs = norm(model.description().gravity_m_s2) > 0;
    const Eigen::Index rows = modes * static_cast<Eigen::Index>(states.size() + (weighs ? 1 : 0));
    Training training;
    for (std::size_t t = 0; t < tets; t += stride) training.candidates.push_back(t);
    training.columns = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(training.candidates.size()));
    training.all = Eigen::VectorXd::Zero(rows);
    const Eigen::VectorXd rest = Equilibrium(model).rest().x;
    for (std::size_t s = 0; s < states.size(); ++s) {
        progress.advance("reduce: forces", static_cast<double>(s) / static_cast<double>(states.size()));
        if (progress.cancelled()) return training;  // of no use, and not used
        const Sample& sample = reduction.samples[states[s]];
        const Eigen::VectorXd x = rest + in_modes * (in_modes.transpose() * (sample.state.x - rest));
        add_state([&](std::size_t t, Eigen::Ref<Eigen::VectorXd> sum) { return forces.add_internal(t, x, sum); }, tets,
                  modes * static_cast<Eigen::Index>(s), modes, training);
    }
    if (weighs) {
        const auto weight = [&](std::size_t t, Eigen::Ref<Eigen::VectorXd> sum) {
            forces.add_weight(t, sum);
            return true;
        };
        add_state(weight, tets, rows - modes, modes, training);
    }
    balance(modes, training);
    return training;
}

/// Tets whose weighted forces in the modes are those of all tets, within `error`.
Result<SparseWeights> chosen_tets(const Model& model, const Reduction& reduction, const Eigen::MatrixXd& modes,
                                  double error, Progress& progress) {
    const Training training = training_of(model, reduction, modes, progress);
    const double digits = std::log(error);
    SparseWeights found = sparse_weights(training.columns, training.all, error, [&](double now) {
        progress.advance("reduce: tets", std::clamp(std::log(now) / digits, 0.0, 1.0));
        return !progress.cancelled();
    });
    if (progress.cancelled()) return cancelled();
    if (found.weights.empty())
        return failure("no sample moves the robot: take more of them (--samples), or larger ranges of its actuators");
    for (Weight& tet : found.weights) tet.column = training.candidates[tet.column];
    return found;
}

void choose_modes(const Model& model, const ReductionOptions& options, Reduction& reduction) {
    const Eigen::VectorXd rest = Equilibrium(model).rest().x;
    Eigen::MatrixXd motions(rest.size(), static_cast<Eigen::Index>(reduction.samples.size()));
    for (std::size_t k = 0; k < reduction.samples.size(); ++k)
        motions.col(static_cast<Eigen::Index>(k)) = reduction.samples[k].state.x - rest;
    reduction.modes = snapshot_basis(motions, options.basis_error, options.most_modes);
    reduction.used = reduction.modes.cols();
    for (std::size_t k = 0; k < reduction.samples.size(); ++k)
        reduction.samples[k].amplitudes = reduction.modes.transpose() * motions.col(static_cast<Eigen::Index>(k));
    const auto most = most_check_modes * static_cast<int>(reduction.used) + 10;
    reduction.modes = snapshot_basis(motions, std::min(check_basis_error, options.basis_error), most);
}

}  // namespace

Result<Reduction> reduce(const Model& model, const StepperOptions& stepping, const InverseTask& task,
                         const ReductionOptions& options, Progress& progress) {
    if (Status status = check_reducible(model.description()); !status) return tl::unexpected(status.error());
    const auto inputs = static_cast<int>(task.inputs.size());
    const int wanted =
        options.samples > 0 ? options.samples : std::clamp(samples_per_input * inputs, least_samples, most_samples);
    Reduction reduction;
    SampleSolver solver(model, stepping, task, progress);
    if (Status status = solver.solve(wanted, reduction); !status) return tl::unexpected(status.error());
    choose_modes(model, options, reduction);
    if (reduction.modes.cols() == 0)
        return failure("no sample moves the robot: take more of them (--samples), or larger ranges of its actuators");
    Result<SparseWeights> tets =
        chosen_tets(model, reduction, reduction.modes.leftCols(reduction.used), options.force_error, progress);
    if (!tets) return tl::unexpected(tets.error());
    Result<SparseWeights> check_tets =
        chosen_tets(model, reduction, reduction.modes, std::max(check_force_error, options.force_error), progress);
    if (!check_tets) return tl::unexpected(check_tets.error());
    reduction.force_error = tets->error;
    reduction.tets = std::move(tets->weights);
    reduction.check_tets = std::move(check_tets->weights);
    progress.advance("reduce: tets", 1);
    return reduction;
}

}  // namespace pliant::sim::reduced

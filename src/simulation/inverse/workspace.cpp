#include "simulation/inverse/workspace.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "simulation/inverse/follow.hpp"

namespace pliant::sim::inverse {
namespace {

constexpr int spread_in_one_piece = 50;

/// The inputs of a piece, in the order in which they are solved.
struct Plan {
    int rows = 0, columns = 0;
    std::vector<Eigen::VectorXd> inputs;
};

Plan line(int side) {
    Plan plan{1, side, {}};
    for (int k = 0; k < side; ++k)
        plan.inputs.push_back(Eigen::VectorXd::Constant(1, 1 - static_cast<double>(k) / (side - 1)));
    return plan;
}

/// Inputs i and j vary; each of the others is at the end of its range given by a bit of `ends`.
Plan sheet(Eigen::Index size, Eigen::Index i, Eigen::Index j, unsigned ends, int side) {
    Plan plan{side, side, {}};
    Eigen::VectorXd inputs(size);
    unsigned bit = 0;
    for (Eigen::Index k = 0; k < size; ++k) {
        if (k != i && k != j) inputs[k] = (ends >> bit++ & 1U) != 0 ? 1 : 0;
    }
    for (int row = 0; row < side; ++row) {
        for (int column = 0; column < side; ++column) {
            inputs[i] = static_cast<double>(row) / (side - 1);
            inputs[j] = static_cast<double>(column) / (side - 1);
            plan.inputs.push_back(inputs);
        }
    }
    return plan;
}

std::vector<Plan> plans_for(Eigen::Index size, const WorkspaceOptions& options) {
    std::vector<Plan> plans;
    if (size == 1) return {line(options.side)};
    const bool sheets = size <= static_cast<Eigen::Index>(most_inputs_with_sheets);
    for (Eigen::Index i = 0; sheets && i < size; ++i) {
        for (Eigen::Index j = i + 1; j < size; ++j) {
            for (unsigned ends = 0; ends < 1U << static_cast<unsigned>(size - 2); ++ends)
                plans.push_back(sheet(size, i, j, ends, options.side));
        }
    }
    for (int first = 0; first < options.between; first += spread_in_one_piece) {
        Plan plan;
        const int end = std::min(options.between, first + spread_in_one_piece);
        for (int k = first; k < end; ++k) plan.inputs.push_back(spread_point(k + 1, size));
        plans.push_back(std::move(plan));
    }
    return plans;
}

std::size_t sample_count(const std::vector<Plan>& plans) {
    std::size_t count = 0;
    for (const Plan& plan : plans) count += plan.inputs.size();
    return count;
}

/// The samples of a plan, with each row of a sheet, and the rows themselves, from the end that is nearer to rest: from
/// there the way to the first sample is the shortest.
std::vector<std::size_t> order_of_solving(const Plan& plan, const Eigen::VectorXd& rest) {
    std::vector<std::size_t> order(plan.inputs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (plan.rows == 0) return order;
    const auto at = [&](int row, int column) { return static_cast<std::size_t>(row * plan.columns + column); };
    const auto to_rest = [&](int row, int column) { return (plan.inputs[at(row, column)] - rest).norm(); };
    const bool from_last_row = to_rest(plan.rows - 1, 0) < to_rest(0, 0);
    const bool from_last_column = to_rest(0, plan.columns - 1) < to_rest(0, 0);
    auto next = order.begin();
    for (int row = 0; row < plan.rows; ++row) {
        for (int column = 0; column < plan.columns; ++column)
            *next++ =
                at(from_last_row ? plan.rows - 1 - row : row, from_last_column ? plan.columns - 1 - column : column);
    }
    return order;
}

class PieceSolver {
public:
    PieceSolver(Stepper& stepper, const InverseTask& task, const InputSpace& space)
        : stepper_(stepper), task_(task), space_(space) {}

    /// Empty if cancelled.
    std::optional<WorkspacePiece> solve(const Plan& plan, Progress& progress,
                                        const std::function<void()>& after_each) const {
        WorkspacePiece piece{plan.rows, plan.columns, {}};
        piece.samples.resize(plan.inputs.size());
        Start now{stepper_.rest(), true}, row = now;
        const std::vector<std::size_t> order = order_of_solving(plan, space_.rest());
        for (std::size_t n = 0; n < order.size(); ++n) {
            if (progress.cancelled()) return std::nullopt;
            // The first of a row starts from the first of the previous row.
            const bool begins_row = plan.rows > 1 && n % static_cast<std::size_t>(plan.columns) == 0;
            if (begins_row) now = row;
            WorkspaceSample& solved = piece.samples[order[n]];
            solved = sample(now, plan.inputs[order[n]], piece.reason, progress);
            if (begins_row && solved.found) row = now;
            after_each();
        }
        if (progress.cancelled()) return std::nullopt;
        return piece;
    }

private:
    struct Start {
        RobotState state;
        bool is_rest;
    };

    /// `now` becomes its state; if none is found, it is unchanged, after also trying from rest, and `reason` says why
    /// unless it says so of an earlier sample.
    WorkspaceSample sample(Start& now, const Eigen::VectorXd& inputs, std::string& reason,
                           const Progress& progress) const {
        WorkspaceSample sample;
        for (Eigen::Index i = 0; i < inputs.size(); ++i) sample.values.push_back(space_.value(i, inputs[i]));
        const Inputs wanted = space_.inputs(inputs, task_.times.back());
        RobotState next = now.state;
        const StepReport report = stepper_.drive(next, wanted, progress);
        sample.found = report.arrived;
        if (!sample.found && !now.is_rest && !progress.cancelled()) {
            next = stepper_.rest();
            sample.found = stepper_.drive(next, wanted, progress).arrived;
        }
        if (!sample.found && reason.empty()) reason = report.reason;
        if (!sample.found) return sample;
        now = {std::move(next), false};
        const RobotState& there = now.state;
        const Description& d = stepper_.model().description();
        for (const Marker& marker : d.markers)
            sample.markers.push_back(position(marker.point, linalg::view(there.x())));
        for (std::size_t a = 0; a < d.steered_count(); ++a) {
            const double m = there.now.state.multiplier[static_cast<Eigen::Index>(a)];
            if (a < d.cables.size())
                sample.tensions_N.push_back(m);
            else
                sample.pressures_Pa.push_back(0 - m);
        }
        return sample;
    }

    Stepper& stepper_;
    const InverseTask& task_;
    const InputSpace& space_;
};

/// True if a stored piece matches the plan; the file may have been tampered with.
bool fits(const WorkspacePiece& piece, const Plan& plan, const Description& d, std::size_t inputs) {
    const auto sample_fits = [&](const WorkspaceSample& sample) {
        if (sample.values.size() != inputs) return false;
        if (!sample.found) return sample.markers.empty() && sample.tensions_N.empty() && sample.pressures_Pa.empty();
        return sample.markers.size() == d.markers.size() && sample.tensions_N.size() == d.cables.size() &&
               sample.pressures_Pa.size() == d.chambers.size();
    };
    return piece.rows == plan.rows && piece.columns == plan.columns && piece.samples.size() == plan.inputs.size() &&
           std::ranges::all_of(piece.samples, sample_fits);
}

}  // namespace

Status check_samples(const InverseTask& task, const WorkspaceOptions& options) {
    if (task.inputs.size() <= most_inputs_with_sheets || options.between > 0) return {};
    return input_error(
        "no sample is asked for: more than {} actuators have ranges, so that there are no sheets, only samples spread "
        "between (--between), of which 1 is the least",
        most_inputs_with_sheets);
}

std::size_t sample_count(const InverseTask& task, const WorkspaceOptions& options) {
    return sample_count(plans_for(static_cast<Eigen::Index>(task.inputs.size()), options));
}

std::string why_nothing_is_found(const Workspace& workspace) {
    std::string reason;
    for (const WorkspacePiece& piece : workspace.pieces) {
        if (std::ranges::any_of(piece.samples, &WorkspaceSample::found)) return "";
        if (reason.empty()) reason = piece.reason;
    }
    return "no sample has an equilibrium" + (reason.empty() ? "" : ": " + reason);
}

Result<Workspace> find_workspace(const Model& model, const StepperOptions& stepping, const InverseTask& task,
                                 const WorkspaceOptions& options,
                                 const std::function<std::optional<WorkspacePiece>(std::size_t)>& known,
                                 const std::function<Status(std::size_t, const WorkspacePiece&)>& keep,
                                 Progress& progress) {
    if (Status status = check_samples(task, options); !status) return tl::unexpected(status.error());
    const std::vector<Plan> plans = plans_for(static_cast<Eigen::Index>(task.inputs.size()), options);
    const std::size_t all = sample_count(plans);
    std::size_t done = 0;
    Workspace workspace;
    for (std::size_t k = 0; k < plans.size(); ++k) {
        const auto tell = [&] {
            progress.advance("workspace", static_cast<double>(done) / static_cast<double>(all));
            ++done;
        };
        if (std::optional<WorkspacePiece> before = known ? known(k) : std::nullopt;
            before && fits(*before, plans[k], model.description(), task.inputs.size())) {
            done += before->samples.size();
            workspace.pieces.push_back(std::move(*before));
            continue;
        }
        // Each piece has its own stepper, so that results do not depend on earlier solves.
        Stepper stepper(model, stepping);
        const InputSpace space(stepper, task);
        std::optional<WorkspacePiece> piece = PieceSolver(stepper, task, space).solve(plans[k], progress, tell);
        if (!piece) {
            workspace.cancelled = true;
            return workspace;
        }
        if (Status kept = keep ? keep(k, *piece) : Status(); !kept) return tl::unexpected(kept.error());
        workspace.pieces.push_back(std::move(*piece));
    }
    progress.advance("workspace", 1);
    return workspace;
}

}  // namespace pliant::sim::inverse

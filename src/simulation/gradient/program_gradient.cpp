#include "simulation/gradient/program_gradient.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/linalg/vectors.hpp"
#include "simulation/gradient/backwards.hpp"
#include "simulation/gradient/step_adjoint.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim {
namespace {

/// An equilibrium of the program and its position in it.
struct Piece {
    double time = 0;
    State state;
    Controls controls;
};

class Backwards {
public:
    Backwards(const Model& model, const Program& program, const Objective& objective, const GradientOptions& options,
              Progress& progress)
        : program_(program),
          objective_(objective),
          options_(options),
          progress_(progress),
          stepper_(model, stepper_options(program)),
          carried_(Carried::nothing(stepper_.system())) {
        result_.values.resize(static_cast<std::size_t>(program.steps));
    }

    [[nodiscard]] Result<ProgramGradient> run() {
        for (const Measure& measure : objective_.measures) {
            if (Status status = check(stepper_.system(), measure); !status) return tl::unexpected(status.error());
        }
        if (has_history() && !options_.by.numbers.empty())
            return input_error("numbers of the drawing have no derivative {}", cause_of_history());
        const Status status = has_history() ? all_back() : all_forward();
        if (!status) return tl::unexpected(status.error());
        std::ranges::reverse(result_.instants);
        for (const std::vector<double>& values : result_.values)
            result_.value += objective_.judge(1 + static_cast<int>(&values - result_.values.data()), values).value;
        progress_.advance(stage, 1);
        return std::move(result_);
    }

private:
    static constexpr const char* stage = "gradient";

    /// True if a step depends on the one before.
    [[nodiscard]] bool has_history() const { return stepper_.has_inertia() || stepper_.system().has_friction(); }

    /// Its first cause, as the end of a sentence. Precondition: has_history().
    [[nodiscard]] std::string cause_of_history() const {
        if (stepper_.options().dynamics) return "over motion in time";
        if (stepper_.system().has_friction()) return "over friction";
        // A tether to the step before holds what no support does.
        const auto& objects = stepper_.model().description().objects;
        return fmt::format("where {}, since each equilibrium then depends on the one before",
                           objects.empty() ? std::string("no support holds a body")
                                           : fmt::format("there is an object (\"{}\")", objects.front().name));
    }

    /// Advances the robot from the end of step k - 1 to that of step k.
    [[nodiscard]] Status forward(RobotState& robot, int k, std::vector<Piece>* pieces) {
        progress_.advance(stage, std::min(1.0, result_.steps_taken / expected_steps()));
        if (progress_.cancelled()) return cancelled();
        StepPath path = program_path(stepper_, program_, robot, k);
        if (pieces != nullptr)
            path.after_piece = [&](const RobotState& at) {
                pieces->push_back({at.controls.time, at.now.state, at.controls});
            };
        const StepReport report = stepper_.step(robot, path, progress_);
        if (progress_.cancelled()) return cancelled();
        ++result_.steps_taken;
        pattern_ = known_pattern(stepper_.system(), stepper_.laplacian(), robot.memory.get());
        if (!report.arrived) return failure("stopped at step {} of {}: {}", k, program_.steps, report.reason);
        return {};
    }

    [[nodiscard]] double expected_steps() const {
        const int steps = program_.steps;
        return has_history() ? steps * (1.0 + times_forward(steps, options_.kept)) : steps;
    }

    /// If steps are independent, each is differentiated as soon as it is solved.
    [[nodiscard]] Status all_forward() {
        RobotState robot = stepper_.rest();
        for (int k = 1; k <= program_.steps; ++k) {
            if (Status status = forward(robot, k, nullptr); !status) return status;
            if (Status status = back_over({robot.controls.time, robot.now.state, robot.controls}, k, true); !status)
                return status;
        }
        std::ranges::reverse(result_.instants);  // in the order of a backward pass
        return {};
    }

    [[nodiscard]] Status all_back() {
        const Status status = go_back<RobotState>(
            stepper_.rest(), 0, program_.steps, options_.kept,
            [&](RobotState& robot, int k) { return forward(robot, k, nullptr); },
            [&](const RobotState& before, int k) -> Status {
                RobotState robot = before;
                std::vector<Piece> pieces;
                if (Status arrived = forward(robot, k, &pieces); !arrived) return arrived;
                for (std::size_t p = pieces.size(); p-- > 0;) {
                    if (Status gone = back_over(pieces[p], k, p + 1 == pieces.size()); !gone) return gone;
                }
                return {};
            });
        if (!status) return status;
        if (result_.by.rest.size() > 0) result_.by.rest += carried_.x;  // the program begins at rest
        if (stepper_.options().dynamics) go_back_to_start();
        return status;
    }

    /// Nodes of an object start with velocity v + w x (x - c), c their mean.
    void go_back_to_start() {
        const Description& d = stepper_.model().description();
        const Eigen::VectorXd rest = stepper_.system().rest().x;
        result_.by_start = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(d.objects.size()));
        for (std::size_t k = 0; k < d.objects.size(); ++k) {
            const Eigen::Vector3d spin = linalg::vector(d.objects[k].angular_velocity_rad_s);
            const Eigen::Vector3d centre = stepper_.model().objects()[k].centre(linalg::view(rest));
            auto by = result_.by_start.col(static_cast<Eigen::Index>(k));
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (const int node : d.objects[k].nodes) {
                const Eigen::Vector3d worth = carried_.v.segment<3>(3 * node);
                by.head<3>() += worth;
                by.tail<3>() += (rest.segment<3>(3 * node) - centre).cross(worth);
                sum += worth.cross(spin) / 4;
            }
            if (result_.by.rest.size() == 0) continue;
            for (const int node : d.objects[k].nodes)
                result_.by.rest.segment<3>(3 * node) +=
                    Eigen::Vector3d(carried_.v.segment<3>(3 * node)).cross(spin) - sum;
        }
    }

    /// `last`: the last piece of its step, where the objective is evaluated. If all derivatives are zero, nothing is
    /// solved.
    [[nodiscard]] Status back_over(const Piece& piece, int k, bool last) {
        const std::optional<Slope> own = last ? judged(piece, k) : std::nullopt;
        if (!own && carried_.is_nothing()) {
            result_.instants.push_back({k, piece.time, {}});
            return {};
        }
        auto at = Linearisation::create(stepper_.system(), piece.state, piece.controls, pattern_, gradient_residual);
        if (!at) return tl::unexpected(at.error());
        auto by = go_back_over(*at, own ? *own : no_slope(stepper_.system()), options_.by, carried_);
        if (!by) return failure("step {} of {} has no derivative: {}", k, program_.steps, by.error().message);
        result_.instants.push_back({k, piece.time, std::exchange(by->inputs, {})});
        add(*by, result_.by);
        return {};
    }

    /// The objective's slope at the end of a step; empty if it does not depend on it.
    [[nodiscard]] std::optional<Slope> judged(const Piece& piece, int k) {
        std::vector<Slope> slopes;
        std::vector<double>& values = result_.values[static_cast<std::size_t>(k - 1)];
        values.clear();
        for (const Measure& measure : objective_.measures) {
            slopes.push_back(slope(stepper_.system(), piece.state, piece.controls, measure));
            values.push_back(slopes.back().value);
        }
        const Judgement judgement = objective_.judge(k, values);
        const auto is_zero = [](double rate) { return rate == 0; };
        if (std::ranges::all_of(judgement.slopes, is_zero)) return std::nullopt;
        Slope sum = no_slope(stepper_.system());
        for (std::size_t m = 0; m < judgement.slopes.size(); ++m) add(slopes[m], judgement.slopes[m], sum);
        if (options_.by.numbers.empty()) return sum;
        const Eigen::Map<const Eigen::VectorXd> rates(judgement.slopes.data(),
                                                      static_cast<Eigen::Index>(judgement.slopes.size()));
        sum.by_numbers =
            measures_by_numbers(options_.by.numbers, piece.state, piece.controls, objective_.measures).transpose() *
            rates;
        return sum;
    }

    const Program& program_;
    const Objective& objective_;
    const GradientOptions& options_;
    Progress& progress_;
    Stepper stepper_;
    KnownPattern pattern_;  ///< of the last step
    Carried carried_;
    ProgramGradient result_;
};

}  // namespace

Result<ProgramGradient> program_gradient(const Model& model, const Program& program, const Objective& objective,
                                         const GradientOptions& options, Progress& progress) {
    return Backwards(model, program, objective, options, progress).run();
}

}  // namespace pliant::sim

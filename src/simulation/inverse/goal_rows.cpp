#include "simulation/inverse/goal_rows.hpp"

#include <algorithm>
#include <cmath>

#include "base/linalg/vectors.hpp"
#include "simulation/inverse/force_goals.hpp"

namespace pliant::sim::inverse {
namespace {

using linalg::vector;

Vec3 place_of(const Model& model, std::size_t marker, const Eigen::VectorXd& x) {
    return position(model.description().markers[marker].point, linalg::view(x));
}

/// The current values that correspond to the goal's wanted values.
std::vector<Vec3> got(const Equilibrium& system, const RobotState& robot, const Goal& goal) {
    const auto place = [&](std::size_t k) { return place_of(system.model(), goal.markers[k], robot.x()); };
    switch (goal.kind) {
        case GoalKind::plane:
            return {place(0)};
        case GoalKind::direction: {
            const Vec3 way = place(1) - place(0);
            const double length = norm(way);
            return {length > 0 ? 1 / length * way : Vec3{}};
        }
        case GoalKind::contact_force:
        case GoalKind::support_force:
            return {force_of(system, robot.now.state, robot.controls, robot.evaluation, goal)};
        case GoalKind::position:
            break;
    }
    std::vector<Vec3> places;
    for (std::size_t k = 0; k < goal.markers.size(); ++k) places.push_back(place(k));
    return places;
}

/// One row for each number, in SI.
std::vector<double> misses(const Goal& goal, const std::vector<Vec3>& got, const std::vector<Vec3>& wanted) {
    if (goal.kind == GoalKind::plane) return {dot(got[0] - wanted[0], wanted[1])};
    if (goal.sum_of_sizes) return {got[0].x - wanted[0].x};
    std::vector<double> all;
    for (std::size_t k = 0; k < got.size(); ++k) {
        const Vec3 miss = got[k] - wanted[k];
        all.insert(all.end(), {miss.x, miss.y, miss.z});
    }
    return all;
}

double error_of(const Goal& goal, const std::vector<double>& misses) {
    if (misses.size() == 1) return std::fabs(misses[0]);
    double largest = 0;
    for (std::size_t k = 0; k + 2 < misses.size(); k += 3)
        largest = std::max(largest, std::hypot(misses[k], misses[k + 1], misses[k + 2]));
    if (goal.kind == GoalKind::direction) return 2 * std::asin(std::min(1.0, largest / 2));
    return largest;
}

/// Adds rows to a sparse matrix.
class RowWriter {
public:
    explicit RowWriter(const Equilibrium& system) : system_(system) {}
    void begin() { ++rows_; }
    /// entry . the place of a marker
    void add_marker(std::size_t marker, const Vec3& entry) {
        const Attachment& point = system_.model().description().markers[marker].point;
        for (std::size_t k = 0; k < point.nodes.size(); ++k) {
            for (int c = 0; c < 3; ++c)
                entries_.emplace_back(rows_ - 1, 3 * point.nodes[k] + c,
                                      point.weights[k] * entry[static_cast<std::size_t>(c)]);
        }
    }
    void add(const Quantity& quantity, double factor) {
        for (Eigen::Index i = 0; i < quantity.by_positions.size(); ++i) {
            if (quantity.by_positions[i] != 0)
                entries_.emplace_back(rows_ - 1, static_cast<int>(i), factor * quantity.by_positions[i]);
        }
        for (Eigen::Index a = 0; a < quantity.by_multipliers.size(); ++a) {
            if (quantity.by_multipliers[a] != 0) add_multiplier(a, factor * quantity.by_multipliers[a]);
        }
    }
    void add_multiplier(Eigen::Index actuator, double value) { multipliers_.emplace_back(rows_ - 1, actuator, value); }
    void add_input(Eigen::Index input, double value) { inputs_.emplace_back(rows_ - 1, input, value); }

    [[nodiscard]] RowGradients finish(Eigen::Index inputs) const {
        RowGradients g;
        g.by_positions.resize(rows_, 3 * system_.model().node_count());
        g.by_positions.setFromTriplets(entries_.begin(), entries_.end());
        g.by_multipliers = Eigen::MatrixXd::Zero(rows_, static_cast<Eigen::Index>(system_.actuators().size()));
        g.by_inputs = Eigen::MatrixXd::Zero(rows_, inputs);
        for (const auto& e : multipliers_) g.by_multipliers(e.row(), e.col()) += e.value();
        for (const auto& e : inputs_) g.by_inputs(e.row(), e.col()) += e.value();
        return g;
    }

private:
    const Equilibrium& system_;
    int rows_ = 0;
    std::vector<Eigen::Triplet<double>> entries_;
    std::vector<Eigen::Triplet<double, Eigen::Index>> multipliers_, inputs_;
};

constexpr Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Derivative of the unit vector from a to b: (I - n n^T) / |b - a|.
void add_direction(RowWriter& rows, const Linearisation& at, const Goal& goal, double scale) {
    const Model& model = at.system().model();
    const Vec3 way = place_of(model, goal.markers[1], at.state().x) - place_of(model, goal.markers[0], at.state().x);
    const double length = norm(way);
    if (!(length > 0)) return;
    const Vec3 n = 1 / length * way;
    for (std::size_t c = 0; c < 3; ++c) {
        rows.begin();
        const Vec3 entry = scale / length * (axes[c] - n[c] * n);
        rows.add_marker(goal.markers[1], entry);
        rows.add_marker(goal.markers[0], -1.0 * entry);
    }
}

void add_goal(RowWriter& rows, Linearisation& at, const Goal& goal, const std::vector<Vec3>& wanted, double scale) {
    switch (goal.kind) {
        case GoalKind::position:
            for (const std::size_t marker : goal.markers) {
                for (const Vec3& axis : axes) {
                    rows.begin();
                    rows.add_marker(marker, scale * axis);
                }
            }
            return;
        case GoalKind::plane:
            rows.begin();
            rows.add_marker(goal.markers[0], scale * wanted[1]);
            return;
        case GoalKind::direction:
            add_direction(rows, at, goal, scale);
            return;
        case GoalKind::contact_force:
        case GoalKind::support_force:
            for (const Quantity& quantity : force_gradients(at, goal)) {
                rows.begin();
                rows.add(quantity, scale);
            }
            return;
    }
}

}  // namespace

std::vector<GoalState> goal_states(const Equilibrium& system, const InverseTask& task, const RobotState& robot,
                                   std::size_t waypoint) {
    std::vector<GoalState> states;
    for (const Goal& goal : task.goals) {
        GoalState state;
        state.got = got(system, robot, goal);
        state.error = error_of(goal, misses(goal, state.got, goal.at(waypoint)));
        state.reached = state.error <= goal.tolerance;
        states.push_back(std::move(state));
    }
    return states;
}

double difference(const Goal& goal, const GoalState& one, const GoalState& other, std::size_t waypoint) {
    std::vector<Vec3> there = other.got;
    if (goal.kind == GoalKind::plane) there.push_back(goal.at(waypoint)[1]);
    return error_of(goal, misses(goal, one.got, there));
}

GoalRows::GoalRows(const Stepper& stepper, const InverseTask& task, const InputSpace& space)
    : stepper_(&stepper), task_(&task), space_(&space), tension_N_(stepper.units().tension_N()) {
    for (std::size_t g = 0; g < task.goals.size(); ++g)
        least_weight_ = g == 0 ? task.goals[g].weight : std::min(least_weight_, task.goals[g].weight);
    const double length = std::cbrt(mesh::volume(stepper.model().mesh()));
    pressure_Pa_ = tension_N_ / (length * length);
}

/// The smallest weight of the goals is scaled to 1, so that small residuals mean that every goal is within its
/// tolerance.
double GoalRows::scale(const Goal& goal) const {
    return std::sqrt(goal.weight / least_weight_) / goal.tolerance;
}

std::vector<GoalState> GoalRows::goals(const RobotState& robot, std::size_t waypoint) const {
    return goal_states(stepper_->system(), *task_, robot, waypoint);
}

Eigen::VectorXd GoalRows::values(const RobotState& robot, const Eigen::VectorXd& inputs, std::size_t waypoint,
                                 const PriceTerm& price) const {
    std::vector<double> all;
    for (const Goal& goal : task_->goals) {
        const double factor = price.goals * scale(goal);
        for (const double miss : misses(goal, got(stepper_->system(), robot, goal), goal.at(waypoint)))
            all.push_back(factor * miss);
    }
    if (price.factor > 0) {
        const Eigen::VectorXd prices = std::sqrt(price.factor) * price_values(robot, inputs, price.before);
        all.insert(all.end(), prices.begin(), prices.end());
    }
    return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

std::vector<std::size_t> GoalRows::goals_of_rows(const RobotState& robot, std::size_t waypoint) const {
    std::vector<std::size_t> all;
    for (std::size_t g = 0; g < task_->goals.size(); ++g) {
        const Goal& goal = task_->goals[g];
        const std::size_t rows = misses(goal, got(stepper_->system(), robot, goal), goal.at(waypoint)).size();
        all.insert(all.end(), rows, g);
    }
    return all;
}

double GoalRows::effort_unit(Eigen::Index input) const {
    return space_->input(input).actuator < stepper_->system().cable_count() ? tension_N_ : pressure_Pa_;
}

bool GoalRows::has_prices() const {
    return std::ranges::any_of(task_->inputs,
                               [](const Steered& in) { return in.effort_price > 0 || in.change_price > 0; });
}

Eigen::VectorXd GoalRows::price_values(const RobotState& robot, const Eigen::VectorXd& inputs,
                                       const Eigen::VectorXd& before) const {
    Eigen::VectorXd all(2 * space_->size());
    for (Eigen::Index i = 0; i < space_->size(); ++i) {
        const Steered& in = space_->input(i);
        const double effort = robot.now.state.multiplier[static_cast<Eigen::Index>(in.actuator)] / effort_unit(i);
        all[2 * i] = std::sqrt(in.effort_price) * effort;
        all[2 * i + 1] = std::sqrt(in.change_price) * (inputs[i] - before[i]);
    }
    return all;
}

double GoalRows::price(const RobotState& robot, const Eigen::VectorXd& inputs, const Eigen::VectorXd& before) const {
    return 0.5 * price_values(robot, inputs, before).squaredNorm();
}

RowGradients GoalRows::gradients(Linearisation& at, std::size_t waypoint, const PriceTerm& price) const {
    RowWriter rows(at.system());
    for (const Goal& goal : task_->goals) add_goal(rows, at, goal, goal.at(waypoint), price.goals * scale(goal));
    for (Eigen::Index i = 0; price.factor > 0 && i < space_->size(); ++i) {
        const Steered& in = space_->input(i);
        rows.begin();
        rows.add_multiplier(static_cast<Eigen::Index>(in.actuator),
                            std::sqrt(price.factor * in.effort_price) / effort_unit(i));
        rows.begin();
        rows.add_input(i, std::sqrt(price.factor * in.change_price));
    }
    return rows.finish(space_->size());
}

}  // namespace pliant::sim::inverse

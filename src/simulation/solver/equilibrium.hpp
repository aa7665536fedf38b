// The equations of one step: forces, actuators and the residual that says how far from equilibrium a state is.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "simulation/actuators/actuator.hpp"
#include "simulation/actuators/fluid_forces.hpp"
#include "simulation/actuators/spring.hpp"
#include "simulation/actuators/torque.hpp"
#include "simulation/elements/block_sums.hpp"
#include "simulation/elements/inertia.hpp"
#include "simulation/elements/joint_force.hpp"
#include "simulation/elements/plate.hpp"
#include "simulation/model/model.hpp"

namespace pliant::sim {

/// Where the program wants the robot at one instant.
struct Controls {
    double time = 0;
    Eigen::VectorXd external_N;              ///< (3n) dead loads and gravity
    std::vector<Eigen::Vector3d> torque_Nm;  ///< (torques)
    std::vector<double> support_share;       ///< (supports) of their prescribed motion
    std::vector<Drive> drives;               ///< (actuators)
    /// (actuators) how the tension of a cable with friction drops along it, frozen at some state of this step; empty
    /// lists where there is no friction.
    std::vector<std::vector<double>> shares;
    Eigen::VectorXd obstacles;  ///< (3 obstacle nodes) where the obstacles are
    /// Friction as frozen at some state of this step; none before contact.
    std::shared_ptr<const contact::Friction> friction = nullptr;
    std::vector<double> joint_wanted;  ///< (joints) what drives them: JointDrive::wanted
    std::vector<double> joint_start;   ///< (joints) their coordinates where the step begins; empty: all zero
    bool met = false;  ///< the robot has met itself: where its contact with itself waits for that, it acts
    std::shared_ptr<const Inertia> inertia = nullptr;  ///< of a step in time; none for a robot at rest at every instant
};

/// What a solver changes: node positions and the multiplier of every actuator.
struct State {
    Eigen::VectorXd x;           ///< (3n) metres
    Eigen::VectorXd multiplier;  ///< (actuators) tension of cables, N, never negative; minus the pressure of air, Pa
};

/// Everything that is known about a state at given controls.
struct Evaluation {
    /// What no body can do: then only min_J is filled.
    enum class Flaw {
        none,
        inverted,   ///< a tetrahedron is turned inside out
        pierced,    ///< surfaces touch or have passed through each other
        collapsed,  ///< a chamber has no volume left
    };
    Flaw flaw = Flaw::none;
    double min_J = 0;
    double energy_J = 0;             ///< elastic and of given multipliers and gas, minus the work of loads
    Eigen::VectorXd out_of_balance;  ///< (3n) internal - external forces + sum m dg/dx; at supports the reaction
    Eigen::VectorXd multiplier;      ///< (actuators) the state's or, where not the measure is driven, what it must be
    Eigen::VectorXd
        constraint_violation;  ///< (actuators) (g - wanted g) / rest g; zero where not the measure is driven
    double residual = 0;       ///< DESIGN: out-of-balance force over the forces that balance, both 2-norms
    double violation = 0;      ///< largest constraint violation that counts: not that of a slack cable
    [[nodiscard]] double error() const { return residual > violation ? residual : violation; }
    [[nodiscard]] bool possible() const { return flaw == Flaw::none; }
};

/// What an impossible state does, for messages: "turns a tetrahedron inside out".
[[nodiscard]] std::string_view name(Evaluation::Flaw flaw);

/// Which nodes a tangent is about: the free ones, in the order of Model::free_index, or all, also those that are held,
/// in their own.
enum class TangentNodes { free, all };

/// Where the entries of the tangent go; made anew where contact couples nodes that nothing else does.
struct TangentLayout {
    linalg::SymmetricPattern pattern;  ///< over these nodes, block 3
    BlockSums element_sums;            ///< of the tets
    TangentNodes nodes = TangentNodes::free;
};

/// A node that a support holds in one or two directions.
struct FreeRoller {
    Eigen::Index node = 0, free = 0;  ///< index among all nodes, and among the free ones
    Eigen::Matrix3d may_move;         ///< projector onto the directions in which it may move
};

/// The discrete system of one model; holds no state. Actuators: first the cables, then the chambers, then the pressure
/// loads, each in the order of the model.
class Equilibrium {
public:
    explicit Equilibrium(const Model& model);

    [[nodiscard]] Controls controls(double time) const;
    /// What drives a cable or chamber whose target has this value, with the error of its zero.
    [[nodiscard]] Drive drive(std::size_t actuator, double target) const;
    /// The shares of all cables with friction at positions x on the way from the drives `before` to the `wanted` ones,
    /// (actuators) each; and, for those driven by length, the weighted length that x would have if the true one were as
    /// wanted.
    void freeze_cable_friction(const Eigen::VectorXd& x, std::span<const Drive> wanted, std::span<const Drive> before,
                               Controls& controls) const;
    /// Largest error of the true lengths of cables with friction, relative to rest.
    [[nodiscard]] double cable_friction_error(const State& state, std::span<const Drive> wanted) const;
    [[nodiscard]] bool has_cable_friction() const;
    [[nodiscard]] State rest() const;
    /// Puts the nodes of the supports where `controls` wants them.
    void place_supports(const Controls& controls, Eigen::VectorXd& x) const;

    [[nodiscard]] Evaluation evaluate(const State& state, const Controls& controls) const;
    /// Elastic energy, with that of springs, and contact energy minus the work of dead loads and gravity since rest; 0
    /// where the laws have none.
    [[nodiscard]] double potential_energy(const State& state, const Controls& controls) const;

    /// Node lists that contact couples at one state, as indices of the nodes that a tangent is about.
    [[nodiscard]] std::vector<std::vector<int>> contact_cliques(const State& state, const Controls& controls,
                                                                TangentNodes nodes = TangentNodes::free) const;
    /// For the body, its actuators and these cliques.
    [[nodiscard]] TangentLayout lay_out_tangent(const std::vector<std::vector<int>>& touching = {},
                                                TangentNodes nodes = TangentNodes::free) const;
    /// Over all nodes, for what is beside the tets. Preconditions: no inertia, no gap elements; they need those, too.
    [[nodiscard]] TangentLayout lay_out_tangent_beside_tets(const std::vector<std::vector<int>>& touching) const;
    /// Adds the symmetric part of the tangent at fixed multipliers, without the constraints and the compressibility of
    /// gas. With `project` every part is replaced by the nearest positive semi-definite one. Over the free nodes,
    /// rollers are decoupled along the directions in which they are held. Precondition: min_J > 0.
    void add_tangent(const State& state, const Controls& controls, const TangentLayout& layout,
                     std::span<double> values, bool project) const;
    /// The same without that of the tets: of plates, springs, inertia, contact and actuators alone.
    void add_tangent_beside_tets(const State& state, const Controls& controls, const TangentLayout& layout,
                                 std::span<double> values, bool project) const;
    /// Adds what add_tangent leaves out, of a law without an energy, of torques and of pressure on patches with a free
    /// rim (over all nodes: on all patches): a matrix S with S^T = -S, of which `values` hold the blocks at and below
    /// the diagonal.
    void add_skew(const State& state, const Controls& controls, const TangentLayout& layout,
                  std::span<double> values) const;
    /// The largest share of a motion (3n) along which nothing passes through anything; the obstacles move by
    /// `obstacle_motion` (3 obstacle nodes; empty: not at all). 1 where nothing can touch.
    [[nodiscard]] double largest_step(const Eigen::VectorXd& x, const Eigen::VectorXd& motion, const Controls& controls,
                                      const Eigen::VectorXd& obstacle_motion = {}) const;
    /// Friction for a step that began at `start`, with the contact forces of `state`; what sticks goes on from the
    /// friction of `start_controls`. Nothing without contact.
    [[nodiscard]] std::shared_ptr<const contact::Friction> freeze_friction(const State& state, const State& start,
                                                                           const Controls& controls,
                                                                           const Controls& start_controls) const;
    /// True if something rubs.
    [[nodiscard]] bool has_friction() const;
    /// True if surfaces are near enough to each other to act.
    [[nodiscard]] bool touches(const State& state, const Controls& controls) const;
    /// Where contact of the robot with itself waits until it is needed: true if on the straight way between two states
    /// its surfaces come so near each other that it is. `now`: the controls of `state`.
    [[nodiscard]] bool meets_itself(const State& state, const Controls& now, const State& next,
                                    const Controls& then) const;
    /// Where the robot's surface has passed through itself, m, if it has. Where contact holds it apart nothing is
    /// looked for.
    [[nodiscard]] std::optional<Vec3> crossing(const State& state, const Controls& controls) const;
    /// Robot nodes, then the points of objects, then the nodes of the obstacles: what contact knows as x, or as a
    /// motion.
    [[nodiscard]] std::vector<double> with_obstacles(const Eigen::VectorXd& x, const Eigen::VectorXd& obstacles) const;
    /// Contact forces of a state, for results. Precondition: the model has contact.
    [[nodiscard]] contact::Forces contact_forces(const State& state, const Controls& controls) const;
    /// (3n) N, pressure and friction of everything that touches a node; zero without contact.
    [[nodiscard]] Eigen::VectorXd contact_node_forces(const State& state, const Controls& controls) const;

    /// True if pressure acts on a patch with a free rim: the tangent then has a skew part, which add_tangent leaves
    /// out.
    [[nodiscard]] bool has_skew() const { return !skew_.empty(); }
    /// Torques have a skew part, too, but of little weight where their nodes are stiff: Newton does without it.
    [[nodiscard]] bool has_torques() const { return !torques_.empty(); }
    /// (3 free) -> (3 free): the skew part of the tangent times v.
    [[nodiscard]] Eigen::VectorXd apply_skew(const State& state, const Eigen::VectorXd& v) const;

    [[nodiscard]] const Model& model() const { return *model_; }
    [[nodiscard]] const std::vector<Actuator>& actuators() const { return actuators_; }
    [[nodiscard]] const std::vector<SpringPath>& springs() const { return springs_; }
    [[nodiscard]] const std::vector<Plate>& plates() const { return plates_; }
    [[nodiscard]] const std::vector<AffineBody>& objects() const { return model_->objects(); }
    [[nodiscard]] const std::vector<JointForce>& joints() const { return joints_; }
    [[nodiscard]] JointDrive joint_drive(const Controls& controls, std::size_t joint) const;
    /// (joints) angles and places at x, on from where a step has begun; none without joints.
    [[nodiscard]] std::vector<double> joint_coordinates(const Eigen::VectorXd& x, const Controls& controls) const;
    [[nodiscard]] const std::vector<FreeRoller>& rollers() const { return rollers_; }
    [[nodiscard]] std::size_t cable_count() const { return model_->description().cables.size(); }
    /// What a sealed chamber gives by for each unit of multiplier: -dg/dm.
    [[nodiscard]] double gas_compliance(const Drive& drive, double multiplier) const;

    /// All forces are the gradient of one energy, so that a line search may use it.
    [[nodiscard]] bool conservative() const { return conservative_; }
    /// Energies that differ by less than this are the same to rounding.
    [[nodiscard]] double energy_rounding_J() const { return energy_rounding_; }

    /// (3n) -> (3 free nodes) and back, of forces and motions: rollers have none along the directions in which they are
    /// held. The rest of `full` is left alone.
    [[nodiscard]] Eigen::VectorXd restrict_to_free(const Eigen::VectorXd& full) const;
    void add_free(const Eigen::VectorXd& free, double factor, Eigen::VectorXd& full) const;
    /// (3n) -> (3 free nodes), of positions.
    [[nodiscard]] Eigen::VectorXd free_positions(const Eigen::VectorXd& full) const;

private:
    /// (n) where a node stands among those that a tangent is about, or -1.
    [[nodiscard]] const std::vector<int>& index_of(TangentNodes nodes) const {
        return nodes == TangentNodes::all ? all_nodes_ : model_->free_index();
    }
    void append_cliques_beside_tets(const std::vector<int>& index, const std::vector<std::vector<int>>& touching,
                                    linalg::Lists& cliques) const;
    void add_actuators();
    /// Where a node is held in a direction, the tangent couples that direction to nothing else.
    void decouple_rollers(const linalg::SymmetricPattern& pattern, std::span<double> values) const;
    void add_plates(double stiffness_Pa, double volume_m3);
    [[nodiscard]] Eigen::VectorXd external_at(double time) const;
    [[nodiscard]] std::optional<GapElements> gap_elements_of(std::size_t cable) const;
    [[nodiscard]] Drive drive(std::size_t actuator, double target, double offset) const;
    [[nodiscard]] Drive drive_at(std::size_t actuator, double time) const;
    [[nodiscard]] bool rim_is_held(const Wall& wall) const;
    /// Energy of an actuator whose measure is not driven, at measure g > 0.
    [[nodiscard]] double drive_energy(const Drive& drive, std::size_t actuator, double g) const;
    [[nodiscard]] const contact::Contact* contact(const Controls& controls) const {
        return model_->contact(controls.met);
    }
    [[nodiscard]] double contact_energy(const Eigen::VectorXd& x, const Controls& controls) const;
    void add_contact(const Eigen::VectorXd& x, const Controls& controls, Eigen::VectorXd& forces, double& energy) const;
    [[nodiscard]] Eigen::VectorXd obstacles_at(double time) const;
    void add_fluid();
    [[nodiscard]] Eigen::Vector3d gravity_at(double time) const;
    /// Adds forces on the mesh's nodes of what acts on all of contact's nodes.
    void add_carried(const std::vector<double>& on_all, Eigen::VectorXd& forces) const;
    void add_buoyancy(const Eigen::VectorXd& x, const Controls& controls, Eigen::VectorXd& forces,
                      double& energy) const;
    /// In a step in time.
    struct Stream {
        std::vector<double> start, v;
    };
    [[nodiscard]] Stream stream(const Eigen::VectorXd& x, const Inertia& inertia) const;
    void add_drag(const Eigen::VectorXd& x, const Controls& controls, const Inertia& inertia, Eigen::VectorXd& forces,
                  double& energy) const;
    void add_drag_tangent(const Eigen::VectorXd& x, const Controls& controls, const Inertia& inertia,
                          const TangentLayout& layout, std::span<double> values) const;
    void visit_carried(const TangentLayout& layout, std::span<double> values,
                       const std::function<void(const contact::BlockVisitor&)>& blocks) const;
    [[nodiscard]] bool has_collapsed_chamber(const Eigen::VectorXd& x) const;
    void fill_actuators(const State& state, const Controls& controls, Evaluation& e) const;
    /// Forces that balance, (3n) each.
    struct Balance {
        Eigen::VectorXd internal, driving;
    };
    /// All but the residual, of a state at rest or, with `inertia`, at the end of a step.
    [[nodiscard]] Evaluation evaluate_at(const State& state, const Controls& controls, const Inertia* inertia,
                                         Balance& balance) const;
    /// Of a step that takes the mean of the forces along its way.
    [[nodiscard]] Evaluation evaluate_mean(const State& state, const Controls& controls, Balance& balance) const;
    [[nodiscard]] Eigen::VectorXd driving_forces(const State& state, const Controls& controls,
                                                 const Evaluation& e) const;
    void fill_residual(const Balance& balance, Evaluation& e) const;
    void add_tangent_at(const State& state, const Controls& controls, const TangentLayout& layout,
                        std::span<double> values, bool project) const;

    const Model* model_;
    std::vector<FreeRoller> rollers_;
    std::vector<Actuator> actuators_;
    std::vector<Plate> plates_;
    std::vector<SpringPath> springs_;
    std::vector<JointForce> joints_;
    std::vector<TorqueForces> torques_;
    std::optional<FluidForces> fluid_;
    std::vector<int> all_nodes_;     ///< (n) 0, 1, 2, ...
    Eigen::VectorXd rest_;           ///< (3n)
    Eigen::VectorXd gravity_;        ///< (3n) at full share
    std::vector<std::size_t> skew_;  ///< actuators: pressure loads with a free rim
    bool conservative_ = true;
    double force_floor_ = 0;  ///< forces below this are rounding, not load
    double energy_rounding_ = 0;
    double force_rounding_ = 0;  ///< out of balance by no more than this is in balance
};

}  // namespace pliant::sim

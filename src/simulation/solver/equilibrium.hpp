// The equations of one step: forces, actuators and the residual that measures the distance from equilibrium.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
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

/// Inputs of the program at one instant.
struct Controls {
    double time = 0;
    Eigen::VectorXd external_N;              ///< (3n) dead loads and gravity
    std::vector<Eigen::Vector3d> torque_Nm;  ///< (torques)
    std::vector<double> support_share;       ///< (supports) share of their prescribed motion
    std::vector<Drive> drives;               ///< (actuators)
    /// (actuators) tension drop along each cable with friction, frozen at a state of this step; empty lists without
    /// friction.
    std::vector<std::vector<double>> shares;
    Eigen::VectorXd obstacles;  ///< (3 obstacle nodes) positions of the obstacles
    /// Friction frozen at a state of this step; null before contact.
    std::shared_ptr<const contact::Friction> friction = nullptr;
    std::vector<double> joint_wanted;  ///< (joints) targets of driven joints: JointDrive::wanted
    std::vector<double> joint_start;   ///< (joints) their coordinates at the start of the step; empty: all zero
    bool met = false;                  ///< self-contact, if deferred, is active
    std::shared_ptr<const Inertia> inertia = nullptr;  ///< of a step in time; null in a quasi-static step
    /// (objects) of an energy-conserving step: their mean stress at a state near its end, AffineBody::mean_stress(), J.
    std::vector<linalg::Matrix3> object_stress = {};

    /// Forces are means along the path of the step.
    [[nodiscard]] bool of_means() const { return inertia && !inertia->means().empty(); }
};

/// The unknowns of the solver: node positions and the multiplier of every actuator.
struct State {
    Eigen::VectorXd x;           ///< (3n) metres
    Eigen::VectorXd multiplier;  ///< (actuators) tension of cables, N, never negative; minus the pressure of air, Pa
};

/// What presses on what at a state, each once, ascending.
struct Touching {
    std::vector<std::array<int, 2>> surfaces;        ///< contact::Contact::partners()
    std::vector<std::array<std::int64_t, 3>> faces;  ///< contact::Contact::faces_met()
    std::vector<std::array<int, 2>> stops;  ///< joint, and which of its limits it is at: 0 the lower, 1 the upper
    [[nodiscard]] bool none() const { return surfaces.empty() && stops.empty(); }
    [[nodiscard]] bool is_part_of(const Touching& other) const {
        return std::ranges::includes(other.surfaces, surfaces) && std::ranges::includes(other.faces, faces) &&
               std::ranges::includes(other.stops, stops);
    }
};

/// Results of evaluating a state at given controls.
struct Evaluation {
    /// Why a state is physically impossible: then only min_J is filled in.
    enum class Flaw {
        none,
        inverted,   ///< a tetrahedron is inverted
        pierced,    ///< surfaces touch or intersect
        collapsed,  ///< a chamber has no volume
    };
    Flaw flaw = Flaw::none;
    double min_J = 0;
    double energy_J = 0;             ///< elastic energy and that of prescribed multipliers and gas, minus the work of
                                     ///< loads
    Eigen::VectorXd out_of_balance;  ///< (3n) internal - external forces + sum m dg/dx; at supports the reaction
    Eigen::VectorXd multiplier;      ///< (actuators) that of the state or, if the measure is not driven, its prescribed
                                     ///< value
    Eigen::VectorXd constraint_violation;  ///< (actuators) (g - wanted g) / rest g; zero if the measure is not driven
    double residual = 0;                   ///< out-of-balance force over the forces that balance, both 2-norms
    double violation = 0;                  ///< largest constraint violation, without slack cables
    [[nodiscard]] double error() const { return residual > violation ? residual : violation; }
    [[nodiscard]] bool possible() const { return flaw == Flaw::none; }
};

/// Description of an impossible state, for messages: "turns a tetrahedron inside out".
[[nodiscard]] std::string_view name(Evaluation::Flaw flaw);

/// The nodes of a tangent: the free ones, in the order of Model::free_index, or all, including held ones, in their own
/// order.
enum class TangentNodes { free, all };

/// What a tangent includes: everything, or everything except contact and friction.
enum class TangentParts { all, without_contact };

/// Sparsity pattern of the tangent; rebuilt when contact couples further nodes.
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

/// The discrete system of one model; stateless. Actuators: first the cables, then the chambers, then the pressure
/// loads, each in the order of the model.
class Equilibrium {
public:
    explicit Equilibrium(const Model& model);

    [[nodiscard]] Controls controls(double time) const;
    /// The drive of a cable or chamber with this target value, including the offset of its zero.
    [[nodiscard]] Drive drive(std::size_t actuator, double target) const;
    /// Tension shares of all cables with friction at positions x, on the path from the drives `before` to the `wanted`
    /// ones, (actuators) each; and, for cables driven by length, the weighted length at x that corresponds to the
    /// prescribed true length. Cables whose drive stays drag in the direction of the shares that `controls` has so far.
    void freeze_cable_friction(const Eigen::VectorXd& x, std::span<const Drive> wanted, std::span<const Drive> before,
                               Controls& controls) const;
    /// Largest error of the true lengths of cables with friction, relative to rest.
    [[nodiscard]] double cable_friction_error(const State& state, std::span<const Drive> wanted) const;
    [[nodiscard]] bool has_cable_friction() const;
    [[nodiscard]] State rest() const;
    /// Moves the nodes of the supports to their positions in `controls`.
    void place_supports(const Controls& controls, Eigen::VectorXd& x) const;

    [[nodiscard]] Evaluation evaluate(const State& state, const Controls& controls) const;
    /// Elastic energy, including springs, and contact energy, minus the work of dead loads and gravity since rest; 0 if
    /// the laws have no energy.
    [[nodiscard]] double potential_energy(const State& state, const Controls& controls) const;

    /// Groups of nodes that contact couples at one state, as indices in the tangent.
    [[nodiscard]] std::vector<std::vector<int>> contact_cliques(const State& state, const Controls& controls,
                                                                TangentNodes nodes = TangentNodes::free) const;
    /// For the body, its actuators and these groups.
    [[nodiscard]] TangentLayout lay_out_tangent(const std::vector<std::vector<int>>& touching = {},
                                                TangentNodes nodes = TangentNodes::free) const;
    /// Over all nodes, for everything except tets and inertia. Precondition: no gap elements, which need the tets'
    /// pattern too.
    [[nodiscard]] TangentLayout lay_out_tangent_beside_tets(const std::vector<std::vector<int>>& touching) const;
    /// Adds the symmetric part of the tangent at fixed multipliers, without constraints and gas compliance. With
    /// `project` every part is replaced by one without negative eigenvalues. Over the free nodes, rollers are
    /// decoupled along the directions in which they are held. Precondition: min_J > 0.
    void add_tangent(const State& state, const Controls& controls, const TangentLayout& layout,
                     std::span<double> values, bool project, TangentParts parts = TangentParts::all) const;
    /// The same without tets, inertia and drag: plates, springs, contact and actuators alone.
    void add_tangent_beside_tets(const State& state, const Controls& controls, const TangentLayout& layout,
                                 std::span<double> values, bool project, TangentParts parts = TangentParts::all) const;
    /// (3 free) gradient of the energy of `pairs` and of the friction in `controls`, at positions `x` of all nodes of
    /// contact, as of with_obstacles(). Precondition: the model has contact.
    [[nodiscard]] Eigen::VectorXd contact_gradient(const contact::Pairs& pairs, const std::vector<double>& x,
                                                   const Controls& controls) const;
    /// Adds the skew part, which add_tangent leaves out: of a law without an energy, of torques and of pressure on
    /// patches with a free rim (over all nodes: on all patches). A matrix S with S^T = -S, of which `values` hold the
    /// blocks at and below the diagonal.
    void add_skew(const State& state, const Controls& controls, const TangentLayout& layout,
                  std::span<double> values) const;
    /// The largest share of a motion (3n) without intersections; the obstacles move by `obstacle_motion` (3 obstacle
    /// nodes; empty: not at all). 1 if nothing can touch.
    [[nodiscard]] double largest_step(const Eigen::VectorXd& x, const Eigen::VectorXd& motion, const Controls& controls,
                                      const Eigen::VectorXd& obstacle_motion = {}) const;
    /// True if largest_step() is 1; quicker where it is not.
    [[nodiscard]] bool is_free(const Eigen::VectorXd& x, const Eigen::VectorXd& motion, const Controls& controls,
                               const Eigen::VectorXd& obstacle_motion = {}) const;
    /// Friction for a step that began at `start`, with the contact forces of `state`; surfaces that stick continue from
    /// the friction of `start_controls`. Null without contact.
    [[nodiscard]] std::shared_ptr<const contact::Friction> freeze_friction(const State& state, const State& start,
                                                                           const Controls& controls,
                                                                           const Controls& start_controls) const;
    /// True if there is any friction.
    [[nodiscard]] bool has_friction() const;
    /// (objects) Controls::object_stress for a step from `start` (3n) to x.
    [[nodiscard]] std::vector<linalg::Matrix3> object_stress(const Eigen::VectorXd& start,
                                                             const Eigen::VectorXd& x) const;
    /// True if surfaces are within contact range.
    [[nodiscard]] bool touches(const State& state, const Controls& controls) const;
    [[nodiscard]] Touching touching(const State& state, const Controls& controls) const;
    /// If self-contact is deferred: true if the surfaces come so close on the straight path between two states that it
    /// must become active. `now`: the controls of `state`.
    [[nodiscard]] bool meets_itself(const State& state, const Controls& now, const State& next,
                                    const Controls& then) const;
    /// A point where the robot's surface intersects itself, m, if any. Not checked if contact prevents it.
    [[nodiscard]] std::optional<Vec3> crossing(const State& state, const Controls& controls) const;
    /// Robot nodes, then the points of objects, then the nodes of the obstacles: positions, or a motion, in the format
    /// of contact.
    [[nodiscard]] std::vector<double> with_obstacles(const Eigen::VectorXd& x, const Eigen::VectorXd& obstacles) const;
    /// Contact forces of a state, for results. Precondition: the model has contact.
    [[nodiscard]] contact::Forces contact_forces(const State& state, const Controls& controls) const;
    /// (3n) N, normal force and friction of everything that touches a node; zero without contact.
    [[nodiscard]] Eigen::VectorXd contact_node_forces(const State& state, const Controls& controls) const;

    /// True if pressure acts on a patch with a free rim: the tangent then has a skew part, which add_tangent leaves
    /// out.
    [[nodiscard]] bool has_skew() const { return !skew_.empty(); }
    [[nodiscard]] bool has_torques() const { return !torques_.empty(); }
    /// The skew part of the tangent of torques, turns skew turns^T, in rotations of their nodes as one: these are so
    /// stiff among themselves that it hardly matters in other motions.
    struct TorqueSkew {
        Eigen::MatrixXd turns;  ///< (3 free, k) forces of unit torques about the three axes; k = 0: no torque acts
        Eigen::MatrixXd skew;   ///< (k, k)
    };
    [[nodiscard]] TorqueSkew torque_skew(const State& state, const Controls& controls) const;
    /// (3 free) -> (3 free): the skew part of the tangent, without that of torques, times v.
    [[nodiscard]] Eigen::VectorXd apply_skew(const State& state, const Eigen::VectorXd& v) const;

    [[nodiscard]] const Model& model() const { return *model_; }
    [[nodiscard]] const std::vector<Actuator>& actuators() const { return actuators_; }
    [[nodiscard]] const std::vector<SpringPath>& springs() const { return springs_; }
    [[nodiscard]] const std::vector<Plate>& plates() const { return plates_; }
    [[nodiscard]] const std::vector<AffineBody>& objects() const { return model_->objects(); }
    [[nodiscard]] const std::vector<JointForce>& joints() const { return joints_; }
    [[nodiscard]] JointDrive joint_drive(const Controls& controls, std::size_t joint) const;
    /// (joints) angles and displacements at x, continued from the start of the step; empty without joints.
    [[nodiscard]] std::vector<double> joint_coordinates(const Eigen::VectorXd& x, const Controls& controls) const;
    [[nodiscard]] const std::vector<FreeRoller>& rollers() const { return rollers_; }
    [[nodiscard]] std::size_t cable_count() const { return model_->description().cables.size(); }
    /// Compliance of a sealed chamber: -dg/dm.
    [[nodiscard]] double gas_compliance(const Drive& drive, double multiplier) const;

    /// True if all forces are the gradient of one energy, so that a line search can use it.
    [[nodiscard]] bool conservative() const { return conservative_; }
    /// Energies that differ by less than this are equal to rounding.
    [[nodiscard]] double energy_rounding_J() const { return energy_rounding_; }

    /// (3n) -> (3 free nodes) and back, for forces and motions: rollers have none along the directions in which they
    /// are held. Other entries of `full` are unchanged.
    [[nodiscard]] Eigen::VectorXd restrict_to_free(const Eigen::VectorXd& full) const;
    void add_free(const Eigen::VectorXd& free, double factor, Eigen::VectorXd& full) const;
    /// (3n) -> (3 free nodes), for positions.
    [[nodiscard]] Eigen::VectorXd free_positions(const Eigen::VectorXd& full) const;

private:
    /// (n) index of a node in the tangent, or -1.
    [[nodiscard]] const std::vector<int>& index_of(TangentNodes nodes) const {
        return nodes == TangentNodes::all ? all_nodes_ : model_->free_index();
    }
    void append_cliques_beside_tets(const std::vector<int>& index, const std::vector<std::vector<int>>& touching,
                                    linalg::Lists& cliques) const;
    void add_actuators();
    /// Decouples the directions in which rollers are held from everything else.
    void decouple_rollers(const linalg::SymmetricPattern& pattern, std::span<double> values) const;
    void add_plates(double stiffness_Pa, double volume_m3);
    [[nodiscard]] Eigen::VectorXd external_at(double time) const;
    [[nodiscard]] std::optional<GapElements> gap_elements_of(std::size_t cable) const;
    [[nodiscard]] Drive drive(std::size_t actuator, double target, double offset) const;
    [[nodiscard]] Drive drive_at(std::size_t actuator, double time) const;
    [[nodiscard]] bool rim_is_held(const Wall& wall) const;
    [[nodiscard]] const contact::Contact* contact(const Controls& controls) const {
        return model_->contact(controls.met);
    }
    [[nodiscard]] double contact_energy(const Eigen::VectorXd& x, const Controls& controls) const;
    void add_contact(const Eigen::VectorXd& x, const Controls& controls, Eigen::VectorXd& forces, double& energy) const;
    [[nodiscard]] Eigen::VectorXd obstacles_at(double time) const;
    void add_fluid();
    [[nodiscard]] FluidForces::Gravity gravity_at(double time) const;
    /// Transfers forces on all of contact's nodes to the nodes of the mesh.
    void add_carried(const std::vector<double>& on_all, Eigen::VectorXd& forces) const;
    void add_buoyancy(const Eigen::VectorXd& x, const Controls& controls, Eigen::VectorXd& forces,
                      double& energy) const;
    /// Fluid forces in a step in time.
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
    /// The forces that balance, (3n) each.
    struct Balance {
        Eigen::VectorXd internal, driving;
    };
    /// Everything except the residual, for a quasi-static state or, with `inertia`, the end of a step.
    [[nodiscard]] Evaluation evaluate_at(const State& state, const Controls& controls, const Inertia* inertia,
                                         Balance& balance) const;
    /// For a step that uses the mean of the forces along its path.
    [[nodiscard]] Evaluation evaluate_mean(const State& state, const Controls& controls, Balance& balance) const;
    [[nodiscard]] Eigen::VectorXd driving_forces(const State& state, const Controls& controls,
                                                 const Evaluation& e) const;
    void fill_residual(const Balance& balance, Evaluation& e) const;
    void add_tangent_at(const State& state, const Controls& controls, const TangentLayout& layout,
                        std::span<double> values, bool project, TangentParts parts) const;

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
    double force_floor_ = 0;  ///< forces below this are rounding errors, not loads
    double energy_rounding_ = 0;
    double force_rounding_ = 0;  ///< out-of-balance forces up to this count as zero
};

}  // namespace pliant::sim

/// @file
/// Simulation of soft robots driven by cables and chambers: from a robot file to a sequence of states.
///
/// SI units throughout: metres, newtons, pascals, seconds. Robot, Model and State are values: a copy is independent of
/// the original, and cheap because immutable data are shared; what was moved from keeps its value. Nothing is drawn,
/// printed or logged. Different objects may be used from different threads at the same time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/base.hpp"

namespace pliant {

/// A robot as its file describes it: bodies, materials, cables, chambers, supports, markers and a program.
class PLIANT_API Robot {
public:
    /// Reads a robot file (TOML). `changes` override keys of the file, written KEY=VALUE, as in "mesh.order=1" or
    /// "cable.flexor.target.length_ratio=0.8".
    /// @throws Failure if the file cannot be read, or it or a change is invalid: one line for each mistake, at most a
    /// dozen, and then how many more there are.
    [[nodiscard]] static Robot load(const std::filesystem::path& file, const std::vector<std::string>& changes = {});
    /// Reads a robot from the text of a robot file. Files that it names are looked up relative to `folder`, or to the
    /// working directory if that is empty. Its name in messages and in Failure::file() is
    /// "robot text", in `folder`.
    /// @throws Failure if the text or a change is invalid, as for load().
    [[nodiscard]] static Robot parse(std::string_view toml, const std::filesystem::path& folder = {},
                                     const std::vector<std::string>& changes = {});

    /// Name given in the robot file.
    [[nodiscard]] const std::string& name() const;
    /// Duration of the program; in seconds for a motion in time.
    [[nodiscard]] double duration() const;
    /// Number of steps of the program.
    [[nodiscard]] int steps() const;
    /// Text of a robot file for `folder` that describes this robot with its changes; files that it names are looked up
    /// relative to that folder.
    /// @throws Failure if a file that the robot file is based on can no longer be read, or has become invalid.
    [[nodiscard]] std::string text(const std::filesystem::path& folder) const;

    /// @cond
    struct Data;
    explicit Robot(std::shared_ptr<const Data> data);
    [[nodiscard]] const Data& data() const { return *data_; }
    [[nodiscard]] const std::shared_ptr<const Data>& shared() const { return data_; }

private:
    SharedData<const Data> data_;
    /// @endcond
};

/// A tetrahedral mesh supplied by the caller.
struct Mesh {
    std::vector<Point> points;  ///< m
    std::vector<int> tets;  ///< (tets * nodes_per_tet) indices into points; the nodes of edges 01 12 20 03 13 23 last
    int nodes_per_tet = 4;  ///< or 10
    std::vector<int> regions{};                       ///< (tets) index into region_names; empty: all tets are in the
                                                      ///< first region
    std::vector<std::string> region_names = {"all"};  ///< names that `region` of a body refers to
};

/// Solver options. Options that are not set take the value in the robot file.
struct StepOptions {
    std::optional<double> tolerance{};     ///< largest residual of a converged step: 1e-10 to 0.1 for a Model, above
                                           ///< 0 and below 1 for a Stepper
    std::optional<int> iteration_limit{};  ///< for each substep, not negative; 0: that of the solver
};

/// A meshed robot, ready to be simulated. Immutable. References and spans that it returns are valid as long as it or a
/// copy of it exists.
class PLIANT_API Model {
public:
    /// Meshes the bodies, or reads the mesh file that the robot names, and attaches actuators, supports and markers to
    /// the mesh. Meshing is done by the program `pliant-mesh`, which must be installed; a robot with a mesh file does
    /// not need it.
    /// @throws Failure if the geometry or the mesh is invalid, `pliant-mesh` is not found or fails, or parts of the
    /// robot do not fit the mesh, with one line for each; or when cancelled.
    explicit Model(const Robot& robot, const Watch& watch = {});
    /// Uses the given mesh for a robot that says `mesh.file = "memory:"` and names its regions as for any mesh file.
    /// Points that no tetrahedron uses are dropped and inverted tetrahedra are reoriented; nodes are therefore
    /// renumbered, in the order of rest_positions().
    /// @throws Failure if the robot's bodies are drawn rather than taken from a mesh, `mesh` is not a valid mesh, or
    /// parts of the robot do not fit it, with one line for each.
    Model(const Robot& robot, const Mesh& mesh);
    /// The same with options that replace `program.tolerance` (1e-10 to 0.1) and `program.max_iterations` of the robot
    /// in everything that is done with the model: steps, batches, programs, searches, gradients, reduced models.
    /// @throws Failure if an option is out of range, or as for Model(robot, watch).
    Model(const Robot& robot, const StepOptions& options, const Watch& watch = {});
    /// The same with options, for a given mesh.
    /// @throws Failure if an option is out of range, or as for Model(robot, mesh).
    Model(const Robot& robot, const Mesh& mesh, const StepOptions& options);

    /// Number of nodes of the mesh.
    [[nodiscard]] std::size_t node_count() const;
    /// Number of tetrahedra of the mesh.
    [[nodiscard]] std::size_t tet_count() const;
    /// Order of the elements: 1 for 4 nodes a tetrahedron, 2 for 10.
    [[nodiscard]] int order() const;
    /// (nodes) rest positions, m.
    [[nodiscard]] std::vector<Point> rest_positions() const;
    /// (3 nodes) rest positions without a copy: x, y and z of each node, m.
    [[nodiscard]] std::span<const double> rest_coordinates() const;
    /// (tets * 4 or 10) node indices of each tetrahedron, corners first.
    [[nodiscard]] const std::vector<int>& tets() const;
    /// (tets) index of each tetrahedron into region_names().
    [[nodiscard]] const std::vector<int>& regions() const;
    /// Names of the bodies, one for each region.
    [[nodiscard]] const std::vector<std::string>& region_names() const;
    /// (triangles) corner nodes of the surface, counter-clockwise seen from outside.
    [[nodiscard]] std::vector<std::array<int, 3>> surface() const;
    /// Names of the cables, in the order of Inputs::cables.
    [[nodiscard]] std::vector<std::string> cables() const;
    /// Names of the chambers, in the order of Inputs::chambers.
    [[nodiscard]] std::vector<std::string> chambers() const;
    /// Names of the markers, in the order of Observation::markers.
    [[nodiscard]] std::vector<std::string> markers() const;
    /// Warnings about the robot as described, before any step; one sentence each.
    [[nodiscard]] std::vector<std::string> warnings() const;

    /// @cond
    struct Data;
    [[nodiscard]] const std::shared_ptr<const Data>& data() const { return data_; }

private:
    SharedData<const Data> data_;
    /// @endcond
};

/// How one cable or chamber is driven.
struct Drive {
    /// Which quantity is prescribed.
    enum class By {
        length,    ///< of a cable, m; a slack cable may be shorter
        tension,   ///< of a cable, N
        volume,    ///< of a chamber, m^3
        pressure,  ///< of a chamber, Pa above ambient
        gas,       ///< of a sealed chamber: absolute pressure times volume, J
    };
    By by = By::length;  ///< which quantity is prescribed
    double value = 0;    ///< in the unit given above: a length or tension not negative, a volume or amount of gas above
                         ///< 0, a pressure not below a vacuum

    /// Same quantity and same value.
    friend bool operator==(const Drive&, const Drive&) = default;
};

/// All inputs to a robot at one instant.
struct Inputs {
    double time = 0;              ///< program time, which sets supports, loads, gravity, obstacles and driven joints
    std::vector<Drive> cables;    ///< in the order of Model::cables()
    std::vector<Drive> chambers;  ///< in the order of Model::chambers()
};

/// Everything about a robot that changes: positions, velocities, multipliers, contact, friction and the memory of the
/// solver. Two states are equal if all their bits are equal. A step from equal states gives equal states, on any number
/// of threads and whatever was solved in between.
class PLIANT_API State {
public:
    /// (nodes) node positions, m.
    [[nodiscard]] std::vector<Point> positions() const;
    /// (3 nodes) node positions without a copy: x, y and z of each node, m; valid until this state is stepped, and as
    /// long as it or a copy of it exists.
    [[nodiscard]] std::span<const double> coordinates() const;
    /// (nodes) node velocities, m/s; all zero in a quasi-static simulation.
    [[nodiscard]] std::vector<Point> velocities() const;
    /// The inputs at which this state is in equilibrium; of the rest state, those at the start of the program. A state
    /// that a stepper of a robot with other constants has loaded keeps its inputs, but is not in equilibrium until its
    /// next step.
    [[nodiscard]] Inputs inputs() const;

    /// The whole state in binary form, for storage. Stepper::state_from() says which steppers can read it back.
    [[nodiscard]] std::string bytes() const;
    /// Writes bytes() to a file, whole or not at all.
    /// @throws Failure if the file cannot be written.
    void save(const std::filesystem::path& file) const;

    /// True if all bits are equal.
    friend PLIANT_API bool operator==(const State& a, const State& b);

    /// @cond
    struct Data;
    explicit State(std::shared_ptr<const Data> data);
    [[nodiscard]] const Data& data() const { return *data_; }

private:
    SharedData<const Data> data_;
    /// @endcond
};

/// Result of a step.
struct StepResult {
    bool arrived = false;  ///< the state has the requested inputs; otherwise it is as far as the solver got
    bool loose = false;    ///< accepted at a looser tolerance, because friction did not settle
    std::string reason;    ///< why it did not arrive, or at which tolerance it was accepted; otherwise empty
    int iterations = 0;    ///< solver iterations
    int pieces = 0;        ///< number of substeps that the step was divided into
    double residual = 0;   ///< norm of the out-of-balance force over the norm of the forces that balance
};

/// Measurable quantities of a state.
struct Observation {
    /// A cable.
    struct Cable {
        std::string name;         ///< as in the robot file
        double length_m = 0;      ///< along the whole cable
        double length_ratio = 1;  ///< length over rest length
        double tension_N = 0;     ///< never negative
    };
    /// A chamber.
    struct Chamber {
        std::string name;         ///< as in the robot file
        double volume_m3 = 0;     ///< enclosed by its walls
        double volume_ratio = 1;  ///< volume over rest volume
        double pressure_Pa = 0;   ///< above ambient
    };
    /// A spring.
    struct Spring {
        std::string name;     ///< as in the robot file
        double length_m = 0;  ///< between its ends
        double force_N = 0;   ///< positive where it pulls
    };
    /// A marker.
    struct Marker {
        std::string name;  ///< as in the robot file
        Point position_m;  ///< current position
    };
    /// Force on the robot from a support or an obstacle.
    struct Force {
        std::string name;  ///< as in the robot file
        Point force_N;     ///< acting on the robot
    };
    /// A sensor.
    struct Sensor {
        /// One of the values that the sensor gives.
        struct Reading {
            std::string name;  ///< "strain", "force_x"...: listed in docs/reference/robot.md
            std::string unit;  ///< SI, such as "N"; "" if dimensionless
            double value = 0;  ///< in that unit
        };
        std::string name;               ///< as in the robot file
        std::vector<Reading> readings;  ///< always the same ones, in the same order
    };
    /// A joint.
    struct Joint {
        std::string name;       ///< as in the robot file
        Point force_N;          ///< from the first connected part on the second
        Point torque_Nm;        ///< likewise; about the joint
        double coordinate = 0;  ///< hinge: angle with whole turns, rad; slider: displacement, m; otherwise 0
        double effort = 0;      ///< drive, hold and damping along it, N m or N
    };
    /// A rigid object.
    struct Object {
        std::string name;                            ///< as in the robot file
        Point position_m;                            ///< of the centre of mass
        std::array<double, 4> rotation{1, 0, 0, 0};  ///< since the start: unit quaternion w, x, y, z, w >= 0
        Point force_N;                               ///< normal force and friction of everything that touches it
    };
    std::vector<Cable> cables;      ///< in the order of Model::cables()
    std::vector<Chamber> chambers;  ///< in the order of Model::chambers()
    std::vector<Spring> springs;    ///< in the order of the robot file
    std::vector<Marker> markers;    ///< in the order of Model::markers()
    std::vector<Force> supports;    ///< reactions of the supports
    std::vector<Force> contacts;    ///< normal force and friction of the obstacles
    std::vector<Sensor> sensors;    ///< in the order of the robot file
    std::vector<Joint> joints;      ///< in the order of the robot file
    std::vector<Object> objects;    ///< in the order of the robot file
    double self_contact_N = 0;      ///< sum of the magnitudes of the self-contact forces
    /// Smallest distance between surfaces that are near enough to repel each other, m; infinite if there are none. That
    /// to a plane or a closed obstacle is measured from its drawn surface, which lies 0.9 of the contact distance
    /// outside the one that repels: where the robot is pressed hard on it, the value is negative, by less than that.
    double smallest_distance_m = std::numeric_limits<double>::infinity();
    double energy_J = 0;          ///< elastic and contact energy, minus the work of loads and gravity
    double kinetic_energy_J = 0;  ///< of a motion in time, otherwise 0
    double min_J = 1;             ///< smallest J = det F over all integration points
};

/// One value per tetrahedron: the mean over its integration points.
struct Fields {
    std::vector<double> volume_ratio;       ///< J = det F
    std::vector<double> von_mises_Pa;       ///< von Mises stress, from the Cauchy stress
    std::vector<double> max_stretch;        ///< largest principal stretch
    std::vector<double> energy_density_Pa;  ///< J/m^3 of rest volume; 0 if the law has no energy
};

/// Advances a robot from one state to the next. Any number of steppers may share a model; each works for one caller at
/// a time: while it does, on another thread or in a Watch, its other members throw a Failure, except fields() and
/// cable_paths(), which need the model alone. It accepts states of its model and of copies of that model. A state of
/// any other Model, even one of the same robot, is brought over with State::bytes() and state_from().
class PLIANT_API Stepper {
public:
    /// Sets up the solver; costs about as much as one or two steps.
    /// @throws Failure if an option is out of range.
    explicit Stepper(const Model& model, const StepOptions& options = {});
    /// Moves; the moved-from stepper may only be assigned to or destroyed.
    Stepper(Stepper&&) noexcept;
    /// Moves; the moved-from stepper may only be assigned to or destroyed.
    Stepper& operator=(Stepper&&) noexcept;
    ~Stepper();

    /// The rest state: undeformed and, for a motion in time, with zero velocity.
    [[nodiscard]] State rest() const;
    /// The inputs that the robot's program prescribes at `time`.
    /// @throws Failure if the time is not finite.
    [[nodiscard]] Inputs program(double time) const;
    /// Solves for equilibrium at `inputs` and stores the new state in `state`. The inputs are ramped linearly from
    /// those of the state, in as many substeps as needed. A motion in time is integrated up to `inputs.time`, which
    /// must be later than the time of the state, in equal time steps no longer than `program.time_step`, or than those
    /// of the program where they were made longer to divide its duration; at the same time, up to rounding, nothing
    /// moves. A step that finds no equilibrium is not a Failure: the result says so, and `state`
    /// is as far as the solver got. The Watch is told the share of the way that is done.
    /// @throws Failure of kind `input`, with `state` unchanged, if the state belongs to another model, the number of
    /// drives differs from that of the cables and chambers, a value is not possible, or a motion in time does not lead
    /// to a later time or takes more than 10,000 time steps; of kind `cancelled`: `state` is then as far as the solver
    /// got.
    StepResult step(State& state, const Inputs& inputs, const Watch& watch = {});
    /// All measurable quantities of a state.
    /// @throws Failure if the state belongs to another model.
    [[nodiscard]] Observation observe(const State& state) const;
    /// Strains and stresses of a state.
    /// @throws Failure if the state belongs to another model.
    [[nodiscard]] Fields fields(const State& state) const;
    /// (nodes) contact force on each node, normal force and friction, N; zero for nodes without contact.
    /// @throws Failure if the state belongs to another model.
    [[nodiscard]] std::vector<Point> contact_forces(const State& state) const;
    /// (cables)(points) m, the path of each cable in this state.
    /// @throws Failure if the state belongs to another model.
    [[nodiscard]] std::vector<std::vector<Point>> cable_paths(const State& state) const;
    /// Restores a state from State::bytes(). It may be a state of another robot if the mesh, also of objects, is the
    /// same, node for node, and so are names and places of supports, cables, chambers, pressure loads, springs and
    /// joints, the numbers of corners of obstacles and of torques, and whether there is motion in time. Material
    /// constants, masses, forces, gravity, targets, stiffness and friction may differ: the state is then not in
    /// equilibrium until its next step.
    /// @throws Failure of kind `input` if the bytes are damaged, are not a state, are of another version of the format,
    /// or belong to a robot that differs in more than that.
    [[nodiscard]] State state_from(std::string_view bytes) const;
    /// Restores a state from a file written by State::save().
    /// @throws Failure if the file cannot be read, or as for state_from().
    [[nodiscard]] State load(const std::filesystem::path& file) const;

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pliant

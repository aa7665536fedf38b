/// @file
/// Simulation of soft robots that cables and chambers drive: from a robot file to states, one step after the other.
///
/// SI units throughout: metres, newtons, pascals, seconds. All classes are values: a copy of a Robot, a Model or a
/// State is independent of the original (and cheap: what never changes is shared). Nothing is drawn, printed or logged.
/// Different objects may be used by different threads at the same time.
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
    /// Reads a robot file (TOML). `changes` are KEY=VALUE, as in "mesh.order=1" or
    /// "cable.flexor.target.length_ratio=0.8".
    /// @throws Failure with a line for each problem of the file.
    [[nodiscard]] static Robot load(const std::filesystem::path& file, const std::vector<std::string>& changes = {});
    /// The same of a text; files that it names are sought from `folder`, or where the program runs.
    [[nodiscard]] static Robot parse(std::string_view toml, const std::filesystem::path& folder = {},
                                     const std::vector<std::string>& changes = {});

    /// As in the file.
    [[nodiscard]] const std::string& name() const;
    /// Duration of its program, in seconds for a motion in time.
    [[nodiscard]] double duration() const;
    /// Steps of its program.
    [[nodiscard]] int steps() const;

    /// @cond
    struct Data;
    explicit Robot(std::shared_ptr<const Data> data);
    [[nodiscard]] const Data& data() const { return *data_; }
    [[nodiscard]] const std::shared_ptr<const Data>& shared() const { return data_; }

private:
    std::shared_ptr<const Data> data_;
    /// @endcond
};

/// A mesh of tetrahedra that a program has made itself.
struct Mesh {
    std::vector<Point> points;  ///< m
    std::vector<int> tets;  ///< (tets * nodes_per_tet) indices into points; the nodes of edges 01 12 20 03 13 23 last
    int nodes_per_tet = 4;  ///< or 10
    std::vector<int> regions{};                       ///< (tets) index into region_names; empty: all in the first
    std::vector<std::string> region_names = {"all"};  ///< what `region` of a body names
};

/// A robot that is meshed and ready to be simulated. Never changes.
class PLIANT_API Model {
public:
    /// Meshes the bodies, or reads the mesh that the file names, and ties everything to it. Meshing is done by the
    /// program `pliant-mesh`, which must be installed; a robot with a mesh file needs none.
    /// @throws Failure of the geometry, the mesh, or of what does not fit it.
    explicit Model(const Robot& robot, const Watch& watch = {});
    /// The same with a mesh for a robot that says `mesh.file = "memory:"` and names its regions as in any mesh file.
    /// Points that no tetrahedron uses are left out, tetrahedra that are inside out are turned; nodes have an order of
    /// their own, that of rest_positions().
    /// @throws Failure where the robot's bodies are drawn, or the mesh is none.
    Model(const Robot& robot, const Mesh& mesh);

    /// Nodes of the mesh.
    [[nodiscard]] std::size_t node_count() const;
    /// Tetrahedra of the mesh.
    [[nodiscard]] std::size_t tet_count() const;
    /// 1: 4 nodes a tetrahedron; 2: 10.
    [[nodiscard]] int order() const;
    /// (nodes) positions at rest, m.
    [[nodiscard]] std::vector<Point> rest_positions() const;
    /// (3 nodes) the same without a copy, x, y and z of each node; there as long as a copy of this model is.
    [[nodiscard]] std::span<const double> rest_coordinates() const;
    /// (tets * 4 or 10) node indices, corners first.
    [[nodiscard]] const std::vector<int>& tets() const;
    /// (tets) index into region_names().
    [[nodiscard]] const std::vector<int>& regions() const;
    /// Names of the bodies.
    [[nodiscard]] const std::vector<std::string>& region_names() const;
    /// (triangles) nodes of the surface, seen from outside counter-clockwise; corners only.
    [[nodiscard]] std::vector<std::array<int, 3>> surface() const;
    /// Names, in the order of Inputs::cables.
    [[nodiscard]] std::vector<std::string> cables() const;
    /// Names, in the order of Inputs::chambers.
    [[nodiscard]] std::vector<std::string> chambers() const;
    /// Names, in the order of Observation::markers.
    [[nodiscard]] std::vector<std::string> markers() const;
    /// What is odd about the robot before anything moves, a sentence each.
    [[nodiscard]] std::vector<std::string> warnings() const;

    /// @cond
    struct Data;
    [[nodiscard]] const std::shared_ptr<const Data>& data() const { return data_; }

private:
    std::shared_ptr<const Data> data_;
    /// @endcond
};

/// How one cable or chamber is driven.
struct Drive {
    /// What is given.
    enum class By {
        length,    ///< of a cable, m: it may be shorter where it is slack
        tension,   ///< of a cable, N
        volume,    ///< of a chamber, m^3
        pressure,  ///< of a chamber, Pa above ambient
        gas,       ///< of a sealed chamber: absolute pressure times volume, J
    };
    By by = By::length;  ///< what is given
    double value = 0;    ///< how much, in the unit above

    /// Same kind and same number.
    friend bool operator==(const Drive&, const Drive&) = default;
};

/// Everything that steers a robot at one instant.
struct Inputs {
    double time = 0;              ///< of the program: drives supports, loads, gravity and obstacles
    std::vector<Drive> cables;    ///< in the order of Model::cables()
    std::vector<Drive> chambers;  ///< in the order of Model::chambers()
};

/// Everything about a robot that changes: positions, velocities, multipliers, contact, friction and what the solver
/// remembers. Two states are equal if all their bits are; a step from equal states gives equal states, on any number of
/// threads and whatever was solved in between.
class PLIANT_API State {
public:
    /// (nodes) m.
    [[nodiscard]] std::vector<Point> positions() const;
    /// (3 nodes) the same without a copy, x, y and z of each node; there as long as this state or a copy of it is, and
    /// is not stepped.
    [[nodiscard]] std::span<const double> coordinates() const;
    /// (nodes) m/s; all 0 for a robot at rest at every instant.
    [[nodiscard]] std::vector<Point> velocities() const;
    /// That it is in equilibrium with.
    [[nodiscard]] Inputs inputs() const;

    /// All of it, to be kept; belongs to this model.
    [[nodiscard]] std::string bytes() const;
    /// Writes bytes() to a file, whole or not at all.
    /// @throws Failure of the disk.
    void save(const std::filesystem::path& file) const;

    /// True if all bits are the same.
    friend PLIANT_API bool operator==(const State& a, const State& b);

    /// @cond
    struct Data;
    explicit State(std::shared_ptr<const Data> data);
    [[nodiscard]] const Data& data() const { return *data_; }

private:
    std::shared_ptr<const Data> data_;
    /// @endcond
};

/// What a step did.
struct StepResult {
    bool arrived = false;  ///< the state has the inputs that were asked for; otherwise it is as far as it got
    bool loose = false;    ///< accepted on looser terms than the tolerance, because friction did not settle
    std::string reason;    ///< why it did not arrive, or on which terms; empty otherwise
    int iterations = 0;    ///< of the solver
    int pieces = 0;        ///< that the step was cut into
    double residual = 0;   ///< norm of the out-of-balance force over that of the forces that balance
};

/// What can be read off a state.
struct Observation {
    /// A cable.
    struct Cable {
        std::string name;         ///< as in the robot file
        double length_m = 0;      ///< along all its points
        double length_ratio = 1;  ///< of that at rest
        double tension_N = 0;     ///< never negative
    };
    /// A chamber.
    struct Chamber {
        std::string name;         ///< as in the robot file
        double volume_m3 = 0;     ///< inside its walls
        double volume_ratio = 1;  ///< of that at rest
        double pressure_Pa = 0;   ///< above ambient
    };
    /// A spring.
    struct Spring {
        std::string name;     ///< as in the robot file
        double length_m = 0;  ///< between its ends
        double force_N = 0;   ///< positive where it pulls
    };
    /// Something with a place.
    struct Marker {
        std::string name;  ///< as in the robot file
        Point position_m;  ///< in the state
    };
    /// Something that exerts a force on the robot: a support or an obstacle.
    struct Force {
        std::string name;  ///< as in the robot file
        Point force_N;     ///< on the robot
    };
    /// A sensor.
    struct Sensor {
        /// One of the numbers that it gives.
        struct Reading {
            std::string name;  ///< "strain", "force_x"; docs/reference/robot.md lists them
            std::string unit;  ///< SI: "N"; "" for a plain number
            double value = 0;  ///< in the unit
        };
        std::string name;               ///< as in the robot file
        std::vector<Reading> readings;  ///< always the same, in the same order
    };
    /// A joint.
    struct Joint {
        std::string name;       ///< as in the robot file
        Point force_N;          ///< of the first of the two things on the second
        Point torque_Nm;        ///< likewise, about the joint
        double coordinate = 0;  ///< angle of a hinge, rad, with whole turns; place of a slider, m; else 0
        double effort = 0;      ///< what drives, holds and damps along it, N m or N
    };
    /// A rigid object.
    struct Object {
        std::string name;                            ///< as in the robot file
        Point position_m;                            ///< of its centre of mass
        std::array<double, 4> rotation{1, 0, 0, 0};  ///< from where it started: unit quaternion w, x, y, z, w >= 0
        Point force_N;                               ///< pressure and friction of all that touches it
    };
    std::vector<Cable> cables;      ///< in the order of Model::cables()
    std::vector<Chamber> chambers;  ///< in the order of Model::chambers()
    std::vector<Spring> springs;    ///< in the order of the robot file
    std::vector<Marker> markers;    ///< in the order of Model::markers()
    std::vector<Force> supports;    ///< reactions
    std::vector<Force> contacts;    ///< pressure and friction of obstacles
    std::vector<Sensor> sensors;    ///< in the order of the robot file
    std::vector<Joint> joints;      ///< in the order of the robot file
    std::vector<Object> objects;    ///< in the order of the robot file
    double self_contact_N = 0;      ///< sum of the sizes of the robot's forces on itself
    /// Smallest distance between surfaces that are near enough to act; infinite where none are.
    double smallest_distance_m = std::numeric_limits<double>::infinity();
    double energy_J = 0;          ///< elastic and contact energy, minus the work of loads and gravity
    double kinetic_energy_J = 0;  ///< of a motion in time
    double min_J = 1;             ///< smallest ratio of volumes, now over rest, of any point
};

/// One value for each tetrahedron: the mean over its integration points.
struct Fields {
    std::vector<double> volume_ratio;       ///< det F
    std::vector<double> von_mises_Pa;       ///< of the Cauchy stress
    std::vector<double> max_stretch;        ///< largest principal stretch
    std::vector<double> energy_density_Pa;  ///< J/m^3 of rest volume; 0 where the law has no energy
};

/// How steps are solved. What is left out is as the robot's file says.
struct StepOptions {
    std::optional<double> tolerance{};     ///< largest residual
    std::optional<int> iteration_limit{};  ///< for one piece of a step
};

/// Takes a robot from one state to the next. For one thread at a time; as many as wanted may share a model.
class PLIANT_API Stepper {
public:
    /// Prepares the solver: as much work as a step or two.
    explicit Stepper(const Model& model, const StepOptions& options = {});
    /// Moves it; the other one is of no use afterwards.
    Stepper(Stepper&&) noexcept;
    /// Moves it; the other one is of no use afterwards.
    Stepper& operator=(Stepper&&) noexcept;
    ~Stepper();

    /// Undeformed and, for a motion in time, still.
    [[nodiscard]] State rest() const;
    /// What the robot's program asks for at `time`.
    [[nodiscard]] Inputs program(double time) const;
    /// Goes from `state` to the inputs, on a straight way in as many pieces as it takes, and leaves the new state
    /// there. A motion in time takes until `inputs.time`, which must be later than that of the state.
    /// @throws Failure of kind `input` where the state belongs to another model, there are not as many drives as cables
    /// and chambers, or a number is not possible; or of kind `cancelled`, `state` is then as far as it got.
    StepResult step(State& state, const Inputs& inputs, const Watch& watch = {});
    /// Everything that can be read off a state.
    [[nodiscard]] Observation observe(const State& state) const;
    /// Strains and stresses.
    [[nodiscard]] Fields fields(const State& state) const;
    /// (nodes) N, pressure and friction of everything that touches a node; zero where nothing does.
    [[nodiscard]] std::vector<Point> contact_forces(const State& state) const;
    /// (cables)(points) m, the path of each cable in this state.
    [[nodiscard]] std::vector<std::vector<Point>> cable_paths(const State& state) const;
    /// The state whose State::bytes() these are.
    /// @throws Failure: no state, one of another version or model, or damaged.
    [[nodiscard]] State state_from(std::string_view bytes) const;
    /// The state that State::save() wrote to this file.
    [[nodiscard]] State load(const std::filesystem::path& file) const;

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pliant

// The robot file as read: one plain value, validated, without any derived data. docs/reference/robot.md describes every
// key.
//
// Coordinates are in the file's `length_unit` (`unit_m` metres); all other quantities are SI.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/core/vec3.hpp"
#include "geometry/mesh/placement.hpp"
#include "geometry/shapes/solid.hpp"
#include "robot/description/drive.hpp"
#include "robot/description/goal.hpp"
#include "robot/description/law.hpp"
#include "robot/description/program.hpp"

namespace pliant::robot {

struct MaterialSpec {
    std::string name;
    material::Law law = material::NeoHookean{};
    double youngs_modulus_Pa = 0;
    double poisson_ratio = 0;
    bool has_bulk_modulus = false;  ///< the file gives bulk_modulus, which determines the Poisson ratio
    double density_kg_m3 = 0;
    std::string resin;                             ///< default: the material's own name
    std::optional<std::array<double, 3>> colour;   ///< sRGB, each in [0, 1]
    double exposure_s = 0, bottom_exposure_s = 0;  ///< per layer when printed; 0: the printer file's default
    bool from_library = false;                     ///< the file has no table of it
};

/// In length units.
struct BoxSelector {
    Vec3 low, high;
};

/// Geometry of a body or of air: a solid expression, a surface file, or a region of the mesh file ("all": every
/// region).
struct SurfaceFile {
    std::filesystem::path path;
    std::string part{};           ///< for a 3MF file: the object or the material; empty: all of it
    mesh::Placement placement{};  ///< lengths in length units
};
struct MeshRegion {
    std::string name;
    std::optional<BoxSelector> box;  ///< only the tets whose centroid is inside, out of those selected above
};
/// The closed cavity of the bodies around a point; only for air.
struct CavityAt {
    Vec3 point;
};
/// The notches crossed by cables that request it; only for gaps.
struct CrossedNotches {};
using Geometry = std::variant<mesh::Solid, SurfaceFile, MeshRegion, CavityAt, CrossedNotches>;

/// A graded body that changes from its material to another; in length units.
struct PrintBlend {
    int material = 0;  ///< index into Robot::materials
    Vec3 from, to;
    std::vector<double> shares{0, 1};  ///< fraction of the other material, evenly spaced from `from` to `to`
    double cell = 0;                   ///< edge of the single-material squares of the dither pattern; 0: a pixel
};

struct BodySpec {
    std::string name;
    int material = 0;  ///< index into Robot::materials
    Geometry geometry;
    double size = 0;  ///< mesh size in it, in length units; 0: that of the whole mesh
    int line = 0;
    std::optional<PrintBlend> blend{};  ///< a simulation uses discrete grades, build_grades.hpp
    double exposure_s = 0;              ///< per layer when printed; 0: that of its material
};

/// Stands for a mesh file: the mesh is given by the caller (robot::take_mesh).
inline constexpr std::string_view mesh_in_memory = "memory:";

struct MeshSpec {
    double size = 0;  ///< in length units; 0: 1/24 of the longest side of the bodies' bounding box
    std::optional<std::filesystem::path> file;
    mesh::Placement placement{};  ///< of the file's mesh; lengths in length units
    int order = 2;
    std::optional<int> elements_through_wall;  ///< at least; default: 3, or what the size gives if one is set
    std::optional<double> close_gaps;          ///< in length units, not below 0; default: a thousandth of the size
    double size_near_cables = 0;               ///< in length units; 0: no requirement
    std::optional<double> point_reach;         ///< in length units, not below 0; default: an eighth of the mean edge
    int line = 0;
};

/// Selectors: which part of the robot is meant; in length units.
struct PlaneSelector {
    Vec3 point, normal;
};
struct SphereSelector {
    Vec3 center;
    double radius = 0;
};
struct SurfaceSelector {
    std::filesystem::path path;
};
struct NodeSelector {
    std::vector<int> nodes;
};
using Selector = std::variant<BoxSelector, PlaneSelector, SphereSelector, SurfaceSelector, NodeSelector>;

struct FixedSpec {
    std::string name;
    Selector selector;
    Vec3 move;  ///< length units
    double rotate_deg = 0;
    Vec3 rotation_axis{1, 0, 0};
    Vec3 rotation_center;          ///< length units
    std::vector<Vec3> directions;  ///< directions in which the nodes are held; empty: all
    Curve share = ramp(0, 1);
    int line = 0;
};

/// A rigid plate glued to the nodes inside the selector.
struct PlateSpec {
    std::string name;
    Selector selector;
    int line = 0;
};

/// Where a load acts, other than a selector of faces.
struct LoadPoints {
    std::vector<Vec3> points;  ///< length units; the load is shared equally
    double radius = 0;         ///< of the material that the load is spread over, length units; 0: the tet that holds
                               ///< the point
};
struct LoadLine {
    std::vector<Vec3> points;  ///< length units; spread evenly over the rest length
};
struct LoadOnNodes {
    Selector selector;  ///< shared equally by the selected nodes
};
struct LoadOnRigid {
    bool object = false;  ///< an object; else a plate
    std::string name;
};

struct LoadSpec {
    std::string name;
    std::variant<Selector, LoadOnNodes, LoadPoints, LoadLine, LoadOnRigid> place;
    Vec3 force_N;
    Vec3 torque_Nm;                     ///< on rigid parts
    std::optional<double> pressure_Pa;  ///< instead of the force: follows the surface, positive: compresses it
    Curve share = ramp(0, 1);
    int line = 0;
};

/// A mass attached to a point of the robot.
struct MassSpec {
    std::string name;
    Vec3 point;
    double mass_kg = 0;
    std::optional<Vec3> center{};                            ///< of mass, length units; default: the point
    Vec3 inertia_kg_m2;                                      ///< principal, about the center; zero: none
    std::array<Vec3, 2> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}};  ///< the first two principal axes
    double radius = 0;  ///< of the material that carries it, length units; 0: the smallest possible
    int line = 0;
};

/// Which end of a cable or spring is fixed in space.
enum class Anchor { none, first, last };

struct CableSpec {
    std::string name;
    std::vector<Vec3> points;
    Anchor anchor = Anchor::none;
    bool guides_at_crossings = false;  ///< adds a guide point wherever the path enters or leaves a body
    double eyelet_radius = 0;          ///< length units
    double friction = 0;               ///< coefficient in the guides
    CableTarget target;
    bool gap_elements = false;           ///< the thesis' model (T3.5) instead of the length constraint
    bool fill_notches = false;           ///< the notches that it crosses become gaps
    double weight = default_gap_weight;  ///< of its gap elements, if their gap has none of its own
    int line = 0;
    std::optional<SteeringSpec> steering{};
};

struct SpringSpec {
    std::string name;
    std::vector<Vec3> points;
    Anchor anchor = Anchor::none;
    double eyelet_radius = 0;  ///< length units
    double stiffness_N_m = 0;
    std::optional<double> free_length;  ///< length units; default: the length as drawn
    bool only_pulls = false;
    int line = 0;
};

/// Empty space that closes under a cable with gap elements: a solid cut out of the bodies, a region, or the notches
/// that cables cross.
inline constexpr std::string_view notches_name = "notches";
struct GapSpec {
    std::string name;
    Geometry space;
    int line = 0;
    std::optional<double> weight{};  ///< of its elements, relative to the softest Young's modulus
};

/// The air of a chamber: a solid cut out of the bodies, a closed surface file, a region of the mesh file, or a cavity
/// of the bodies.
struct ChamberSpec {
    std::string name;
    Geometry air;
    ChamberTarget target;
    bool elements = false;               ///< the thesis' model (T3.6) instead of the volume constraint
    double weight = default_air_weight;  ///< of the elements, relative to the softest Young's modulus
    int line = 0;
    std::optional<SteeringSpec> steering{};
};

/// A rigid body that the robot may touch.
struct ObstacleSpec {
    std::string name;
    std::variant<mesh::Solid, SurfaceFile, PlaneSelector> shape;  ///< for a plane: the half-space behind it, its normal
                                                                  ///< points out
    double friction = 0;
    Vec3 move;  ///< length units
    Curve share = ramp(0, 1);
    int line = 0;
    int start_line = 0;  ///< of the key at time 0 that moves it; 0: there is none
};

/// A free rigid body with mass.
struct ObjectSpec {
    std::string name;
    std::variant<mesh::Solid, SurfaceFile> shape;
    mesh::Placement placement{};  ///< of either, initial placement; lengths in length units
    double density_kg_m3 = 0;     ///< 0: its mass is given
    double mass_kg = 0;
    Vec3 velocity_m_s, angular_velocity_rad_s;
    double friction = 0;  ///< against everything that it touches
    int line = 0;
};

/// A joint between two things at a point.
struct JointSpec {
    enum class Kind { glue, hinge, slider, ball, motor };
    std::string name;
    Kind kind = Kind::glue;
    std::array<std::string, 2> between;  ///< bodies, plates, objects, or world_name
    Vec3 point;                          ///< length units
    Vec3 axis{0, 0, 1};                  ///< of a hinge, motor or slider, not zero
    double radius = 0;                   ///< of the patch of a soft body that it holds, length units; 0: from the mesh
    double stiffness = 0;                ///< along the free coordinate, N m/rad or N/m
    double damping = 0;                  ///< N m s/rad or N s/m
    std::optional<std::array<double, 2>> limits;  ///< rad, or m
    bool by_force = false;                        ///< `wanted` is a torque, N m, or a force, N; else a position
    std::optional<Curve> wanted;                  ///< rad, m, N m or N over the program's time; none: not driven
    std::optional<double> clearance;              ///< length units; empty: no contact between the two anywhere
    int line = 0;
};
inline constexpr std::string_view world_name = "world";

struct ContactSpec {
    bool self = true;
    double distance = 0;                 ///< length units; 0: a thousandth of the robot's size
    std::optional<double> stiffness_Pa;  ///< default: a tenth of the softest Young's modulus
    double friction = 0;                 ///< of the robot against itself
    double slip = 0;                     ///< length units; 0: a hundredth of the distance
    int line = 0;
};

/// The fluid around the robot and objects.
struct FluidSpec {
    double density_kg_m3 = 0;
    double drag_normal = 0, drag_tangential = 0;
    std::optional<double> level;  ///< height of its surface, opposite to gravity, length units; empty: everywhere
    Vec3 current_m_s;
    int line = 0;
};

struct MarkerSpec {
    std::string name;
    std::variant<Vec3, BoxSelector> place;
    int line = 0;
};

/// Sensors: what is measured, and where; lengths in length units.
struct StrainSensorSpec {
    std::vector<Vec3> points;
};
struct BackboneSensorSpec {
    std::vector<Vec3> points;
    double radius = 0;  ///< of the material whose rotation is taken about each point; 0: the smallest possible
};
struct ContactSensorSpec {
    Selector selector;
};
struct ActuatorSensorSpec {
    enum class Kind { tension, volume, pressure };
    Kind kind = Kind::tension;
    std::size_t index = 0;  ///< into Robot::cables or Robot::chambers
};
struct DistanceSensorSpec {
    std::array<std::variant<Vec3, std::string>, 2> ends;  ///< a point, or the name of a marker or an object
};
struct MotionSensorSpec {
    std::variant<Vec3, std::string> place;  ///< a point, or the name of an object
    std::array<Vec3, 2> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}};
    double radius = 0;
};
struct SensorSpec {
    std::string name;
    std::variant<StrainSensorSpec, BackboneSensorSpec, ContactSensorSpec, ActuatorSensorSpec, DistanceSensorSpec,
                 MotionSensorSpec>
        what;
    int line = 0;
};

struct Robot {
    std::filesystem::path file;
    std::string name;
    double unit_m = 1e-3;
    std::vector<MaterialSpec> materials;
    std::vector<BodySpec> bodies;
    MeshSpec mesh;
    std::vector<FixedSpec> fixed;
    std::vector<PlateSpec> plates;
    std::vector<LoadSpec> loads;
    std::vector<MassSpec> masses;
    std::vector<CableSpec> cables;
    std::vector<SpringSpec> springs;
    std::vector<ChamberSpec> chambers;
    std::vector<GapSpec> gaps;
    std::optional<ContactSpec> contact;  ///< set if the file has [contact], an obstacle or an object
    std::vector<ObstacleSpec> obstacles;
    std::vector<ObjectSpec> objects;
    std::vector<JointSpec> joints;
    std::optional<FluidSpec> fluid;
    std::vector<MarkerSpec> markers;
    std::vector<SensorSpec> sensors;
    std::vector<GoalSpec> goals;
    /// A file that stands on this one has another course of the program, and gives the goals no times of it.
    bool times_of_other_program = false;
    Vec3 gravity_m_s2;
    Curve gravity_share = ramp(0, 1);
    double ambient_pressure_Pa = 101325;
    Program program;
    std::vector<std::string> notes;  ///< what is not quite as the file says, one sentence each
};

/// True if unsupported pieces are allowed: the robot moves in time, or something may hold them by contact.
[[nodiscard]] inline bool may_be_free(const Robot& robot) {
    return robot.program.dynamics.has_value() || !robot.obstacles.empty() || !robot.joints.empty() ||
           robot.fluid.has_value();
}

}  // namespace pliant::robot

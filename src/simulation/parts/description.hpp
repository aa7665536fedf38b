// A robot with its mesh: mesh, laws, supports, loads, cables, chambers, markers; the input of a Model. Time runs from
// 0, at rest, to the end of the program.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "robot/description/law.hpp"
#include "simulation/contact/contact.hpp"
#include "simulation/parts/robot_names.hpp"

namespace pliant::sim {

/// A point that rides on the mesh: sum of weights[i] * x[nodes[i]] + fixed. Without nodes it is fixed in space.
struct Attachment {
    std::vector<int> nodes;
    std::vector<double> weights;  ///< sum 1
    Vec3 fixed;                   ///< metres; with nodes zero, except on a plane of symmetry (Attacher::spread)
};

/// The affine motion of the material near a point: the weight of each node in the motion of the point, and the gradient
/// of that weight.
struct AttachedFrame {
    std::vector<int> nodes;
    std::vector<double> weights;  ///< sum 1
    std::vector<Vec3> gradients;  ///< 1/m, sum 0
    /// A point that moves with the frame, at the offset `arm` from the frame's point at rest.
    [[nodiscard]] Attachment at(const Vec3& arm) const;
};

struct Material {
    std::string name;
    material::Law law;
    double density_kg_m3 = 0;
};

/// A rotation, right-handed about an axis through a point.
struct Turn {
    double angle_rad = 0;
    Vec3 axis{1, 0, 0};  ///< of any length but zero
    Vec3 center_m;
};

/// Nodes with prescribed motion: at each instant they are rotated from rest by share * angle and then shifted by share
/// * move. With directions they are held along those alone and slide across them: rollers, planes of symmetry.
struct Support {
    std::string name;
    std::vector<int> nodes;
    Vec3 move_m;
    Curve share = ramp(0, 1);
    Turn turn{};
    std::vector<Vec3> directions{};  ///< of any length but zero; empty: held in all directions
    [[nodiscard]] bool moves() const { return turn.angle_rad != 0 || !(move_m == Vec3{}); }
    /// Position of a node that is at `rest` at rest, both in metres.
    [[nodiscard]] Vec3 position(const Vec3& rest, double share_now) const;
    /// The vector `arm` from that node, rotated only: the derivative of its position with respect to `rest`, along
    /// `arm`.
    [[nodiscard]] Vec3 turned_arm(const Vec3& arm, double share_now) const;
    /// Derivatives of that position: with respect to the angle of the whole rotation, m per rad, and with respect to
    /// the share, m.
    [[nodiscard]] Vec3 arc(const Vec3& rest, double share_now) const;
    [[nodiscard]] Vec3 velocity(const Vec3& rest, double share_now) const;
};

/// A force that keeps its direction: share * force.
struct Load {
    std::string name;
    std::vector<int> nodes;
    std::vector<double> shares;  ///< (nodes) of the total force, sum 1
    Vec3 force_N;
    Curve share = ramp(0, 1);
    /// The faces over which it is spread evenly at rest, which `shares` follow from (surface_shares()); empty: they are
    /// given.
    std::vector<mesh::Face> faces{};
};

/// A torque with constant direction, share * torque, on nodes that move as one: those of a plate or object. See
/// torque.hpp for its forces.
struct TorqueLoad {
    std::string name;
    std::vector<int> nodes;  ///< at least three, not collinear
    Vec3 torque_Nm;
    Curve share = ramp(0, 1);
};

/// A face of a wall: 3 corners and, if it is curved, the points between 0-1, 1-2, 2-0 (else -1); indices into
/// Wall::points. Counter-clockwise seen from the solid side: the normal points out of the air.
using WallFace = std::array<int, 6>;

/// A surface under air pressure; its points are attached to the mesh.
struct Wall {
    std::vector<Attachment> points;
    std::vector<WallFace> faces;
    /// The last so many faces are mouths of a chamber: no body has them, a support closes the chamber there. They bound
    /// the volume, but the air presses on the support, not on the robot.
    std::size_t mouth_faces = 0;

    [[nodiscard]] std::span<const WallFace> faces_of_bodies() const {
        return std::span(faces).first(faces.size() - mouth_faces);
    }
};

/// A pressure that follows the surface as it deforms: share * pressure, towards the solid.
struct PressureLoad {
    std::string name;
    Wall wall;
    double pressure_Pa = 0;
    Curve share = ramp(0, 1);
};

/// A cable through guide points; its length is that of the polyline. It slides without friction or, with a coefficient
/// above zero, like a rope over bollards: its tension, prescribed at the pulled end, drops at every bend.
struct Cable {
    std::string name;
    std::vector<Attachment> points;  ///< at least two
    CableTarget target;
    double friction = 0;
    bool pulled_at_first = true;  ///< else at the last point
};

/// An elastic spring along a path of points: its force is stiffness * (length - free length), of either sign unless it
/// only pulls, as a rubber band does.
struct Spring {
    std::string name;
    std::vector<Attachment> points;  ///< at least two
    double stiffness_N_m = 0;
    std::optional<double> free_length_m = std::nullopt;  ///< without force; empty: the rest length
    bool only_pulls = false;
};

/// Air inside a closed wall. The multiplier of its volume is minus its pressure (above ambient, of either sign).
struct Chamber {
    std::string name;
    Wall wall;
    ChamberTarget target;
};

/// The thesis' actuators (T3.5, T3.6): a cable or chamber that is driven by its length or volume acts through the
/// elements of one material, meshed empty space. They are scaled along `direction` or, if that is zero, in volume until
/// the actuator's measure meets its target (actuated_space.hpp). If several cables pass one gap, each has the tets that
/// are nearest to it.
struct Growth {
    int material = 0;      ///< for air: air_law(), for a gap: gap_law()
    Vec3 direction;        ///< for a gap: along the cable, of length 1
    int actuator = 0;      ///< first the cables, then the chambers
    double weight_Pa = 0;  ///< above 0: stiffness with which the elements are held to their target
    double length_m = 0;   ///< for a gap: rest length of the cable inside it, above 0
    Vec3 center_m;         ///< for a gap: a point of that cable
};

/// Nodes glued to a rigid plate: they keep their shape and move as one.
struct RigidPlate {
    std::string name;
    std::vector<int> nodes;  ///< at least three, not collinear
};

/// A rigid body that the robot may touch; its position is rest + share * move.
struct Obstacle {
    contact::Obstacle body;  ///< without its place at the start, which follows from the rest
    Vec3 move_m;
    Curve share = ramp(0, 1);
};

/// A free rigid body with mass. Four nodes of the mesh, which belong to no tet, carry it: its motion is affine, and a
/// stiff energy keeps it rigid (affine_body.hpp). Each of them has a quarter of its mass, and together they have its
/// inertia (mesh::equal_mass_points).
struct FreeObject {
    std::string name;
    mesh::TriMesh surface;  ///< metres, initial position
    std::array<int, 4> nodes{};
    double mass_kg = 0;
    Vec3 velocity_m_s{}, angular_velocity_rad_s{};  ///< initial velocities of a motion in time
    double friction = 0;  ///< coefficient against everything; if the other one has one too, the larger applies
    int line = 0;         ///< of the file that draws it, for errors; 0: unknown
};

/// A point mass on the robot, without rotational inertia. A mass with inertia is represented by four of them.
struct PointMass {
    std::string name;
    Attachment point;
    double mass_kg = 0;
};

/// Forces along the free coordinate of a hinge (its angle, rad) or a slider (its displacement, m); the coordinate is
/// zero at rest.
struct JointLaw {
    double stiffness = 0;  ///< N m/rad or N/m, about `rest`
    double rest = 0;
    double damping = 0;  ///< N m s/rad or N s/m, in a motion in time
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    enum class Drive { none, place, force };
    Drive drive = Drive::none;
    Curve wanted = ramp(0, 0);  ///< target position, or force: N m or N
};

/// Two things that are joined at the same four points of each, given at rest: the centre, and an arm from there along
/// each of three right-handed orthonormal axes; the first axis is that of a hinge or a slider. Points of the fixed
/// world have no nodes.
struct Joint {
    enum class Kind { glue, hinge, slider, ball };
    std::string name;
    Kind kind = Kind::glue;
    std::array<Attachment, 4> first, second;
    double arm_m = 0;          ///< distance of the points from the centre
    double stiffness_N_m = 0;  ///< of the connection: see joint_force.hpp
    JointLaw law{};
    /// The two things: an object, or -1 for the robot's bodies and -2 for the world.
    std::array<int, 2> objects{-2, -2};
    double clear_m = 0;  ///< no contact between the two this near to the joint at rest; infinite: none at all
};

/// Which surfaces can touch, and how.
struct ContactRules {
    contact::Surface surface;    ///< of the robot's bodies, without objects
    contact::Settings settings;  ///< distance, stiffness and friction above zero are chosen by the caller
    std::vector<Obstacle> obstacles;
    /// With settings.self: self-contact acts only from the first step in which the surfaces would pass through each
    /// other. Until then it costs almost nothing and exerts no force.
    bool self_when_met = false;
};

/// The fluid around robot and objects: buoyancy, and drag on what moves through it.
struct Fluid {
    double density_kg_m3 = 0;
    double drag_normal = 0, drag_tangential = 0;
    std::optional<double> level_m{};  ///< height of its surface, opposite to gravity; empty: everywhere
    Vec3 current_m_s;
    std::vector<std::array<int, 3>> skin;  ///< of the bodies, counter-clockwise seen from outside; without chambers
};

/// A point of the material whose position is reported.
struct Marker {
    std::string name;
    Attachment point;
};

// The sensors of [[sensor]]; sensors.hpp names the readings of each.
struct StrainSensor {
    std::vector<Attachment> points;  ///< at least two: a path
};
/// Sections along a line of points, from the motion of the material about each.
struct BackboneSensor {
    std::vector<AttachedFrame> sections;    ///< at least three
    std::vector<std::array<Vec3, 3>> axes;  ///< (sections) at rest: right-handed, the third along the line
};
struct ContactSensor {
    std::vector<int> nodes;        ///< of the patch
    std::vector<double> areas_m2;  ///< of the patch at rest: each node has a third of the adjacent triangles
    std::vector<double> owned_m2;  ///< likewise of the whole surface, including what is outside the patch
};
struct ActuatorSensor {
    enum class Kind { tension, volume, pressure };
    Kind kind = Kind::tension;
    std::size_t index = 0;  ///< of the cable or chamber
};
struct DistanceSensor {
    std::array<Attachment, 2> points;
};
/// Accelerometer and gyroscope.
struct MotionSensor {
    AttachedFrame frame;
    std::array<Vec3, 3> axes;  ///< of the sensor at rest, right-handed
};
struct Sensor {
    std::string name;
    std::variant<StrainSensor, BackboneSensor, ContactSensor, ActuatorSensor, DistanceSensor, MotionSensor> what;
};

struct Description {
    mesh::TetMesh mesh;                   ///< metres, positive volumes
    std::vector<Material> materials;      ///< at least one
    std::vector<int> material_of_region;  ///< (regions)
    std::vector<Support> supports;
    std::vector<Load> loads;
    std::vector<PressureLoad> pressures;
    std::vector<Cable> cables;
    std::vector<Chamber> chambers;
    std::vector<Spring> springs{};
    std::vector<Growth> growths;
    std::vector<RigidPlate> plates;
    std::vector<FreeObject> objects{};  ///< they need contact
    std::vector<PointMass> masses{};
    std::vector<Joint> joints{};
    std::vector<TorqueLoad> torques{};
    std::vector<Sensor> sensors{};
    /// Pieces that no support holds are allowed: they move in time, or touch something that holds them.
    bool may_be_free = false;
    bool moves_in_time = false;  ///< in time, so that a fluid exerts drag
    std::optional<ContactRules> contact = std::nullopt;
    std::optional<Fluid> fluid = std::nullopt;
    std::vector<Marker> markers;
    Vec3 gravity_m_s2;
    Curve gravity_share = ramp(0, 1);
    double ambient_pressure_Pa = 101325;
    std::vector<int> material_of_tet{};  ///< (tets) for graded bodies, instead of the material of the region; else
                                         ///< empty
    /// (tets) above zero: how often each tet counts in energy, forces and mass; empty: once. For a few tets that stand
    /// for all (simulation/reduced).
    std::vector<double> tet_weights{};
    std::vector<std::string> notes{};  ///< remarks for the user, one line each

    /// Number of cables and chambers, which inputs drive; pressure loads follow the program.
    [[nodiscard]] std::size_t steered_count() const { return cables.size() + chambers.size(); }
};

/// Position of an attachment for node positions `x` (3n).
[[nodiscard]] Vec3 position(const Attachment& point, std::span<const double> x);
/// Motion of an attachment for a motion `v` (3n) of the nodes; zero where it is fixed in space.
[[nodiscard]] Vec3 motion(const Attachment& point, std::span<const double> v);

}  // namespace pliant::sim

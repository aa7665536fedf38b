// The input of a report: a finished simulation as plain data. Lengths in metres, everything in SI.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "presentation/draw/colour.hpp"
#include "presentation/draw/obstacle.hpp"
#include "presentation/report/measured.hpp"
#include "simulation/run/fields.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::robot {
struct Robot;
}
namespace pliant::sim {
class Model;
}

namespace pliant::report {

struct Material {
    std::string name;
    std::string law;               ///< for people: "neo-Hookean, E 12 MPa, Poisson ratio 0.45"
    std::string resin;             ///< what it is printed in; may be empty
    double density_kg_m3 = 0;      ///< 0: not given
    std::optional<Colour> colour;  ///< empty: a colour of the palette, by index
};

/// Wall times in addition to that of the solver, which `sim::Trajectory` has.
struct Timing {
    double mesh_s = 0;      ///< reading the robot file, and meshing
    double model_s = 0;     ///< building the model, before the solver's setup
    double files_s = 0;     ///< tables, frames and robot.glb
    double pictures_s = 0;  ///< drawing and writing them
};

struct Simulation {
    std::string robot;                   ///< name of the robot
    const mesh::TetMesh& mesh;           ///< at rest
    std::vector<Material> materials{};   ///< at least one
    std::vector<int> region_material{};  ///< (regions of the mesh), index into materials; -1: a void, never drawn
    const sim::Trajectory& result;       ///< at least the rest state; every step has (n, 3) positions
    std::function<sim::Fields(std::span<const Vec3>)> fields{};  ///< of node positions; (tets) values each
    /// [step][cable][point], as many steps as the result has; empty where there are no cables.
    std::vector<std::vector<std::vector<Vec3>>> cable_points{};
    std::vector<Obstacle> obstacles{};  ///< in the order of every step's contacts; may be empty
    /// Pressure of all contacts at a step, (n) Pa, 0 inside; empty if nothing can touch.
    std::function<std::vector<double>(const sim::Step&)> contact_pressure_Pa{};
    double tolerance = 1e-4;
    double peak_memory_MB = 0;
    std::vector<std::pair<std::string, std::string>> settings{};  ///< further settings listed in the report: name,
                                                                  ///< value
    Timing timing{};
    /// (regions), true for meshed space whose elements drive an actuator: its edges are drawn. May be empty.
    std::vector<bool> region_actuates{};
    std::vector<MeasuredPath> measured{};  ///< of markers of the result; may be empty
    std::string measured_as = "measured";  ///< label of these; "wanted" for goal positions
};

/// A robot's run as report data: everything except timing, memory and measured markers. All arguments must outlive it.
[[nodiscard]] Simulation simulation_of(const robot::Robot& robot, const sim::Model& model,
                                       const sim::Trajectory& trajectory);

/// Checks that sizes and indices agree; the error names the field.
[[nodiscard]] Status check(const Simulation& simulation);

/// True if anything could touch: there is an obstacle, or the robot came near itself.
[[nodiscard]] bool has_contact(const sim::Trajectory& result);

/// Which regions' elements drive an actuator.
[[nodiscard]] std::vector<bool> regions_that_actuate(const sim::Model& model);

/// The material's own colour or, without one, that of the palette.
[[nodiscard]] Colour colour_of(const Simulation& simulation, int material);

}  // namespace pliant::report

// Input of a print: bodies from robot files, 3MF files, surfaces and tet meshes.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "printing/prepare/make_job.hpp"
#include "printing/slice/body.hpp"
#include "robot/description/robot.hpp"

namespace pliant::prepare {

/// Bodies in micrometres, at their drawn positions, and the resin of each material.
struct Drawing {
    std::string name;
    std::vector<slice::Body> bodies;
    std::vector<job::MaterialStack> stacks;  ///< instead of bodies: existing layer images
    std::vector<std::pair<std::string, std::string>> resin_of_material;
    std::map<std::string, std::pair<double, double>> exposure_of_material;  ///< seconds, of the first layers second; 0:
                                                                            ///< not given
    std::map<std::string, std::string> colour_of_material{};                ///< "#rrggbb", of those that have one
    std::vector<std::string> warnings;
    std::vector<std::string> notes{};  ///< overlaps of drawn bodies
    /// Of materials that stand for a body with an exposure of its own: the material that the body is made of. What is
    /// said of that one holds for these too, unless they are named themselves.
    std::map<std::string, std::string> made_of{};
    int items = 1;  ///< of the 3MF file with most of them
};

/// One robot file (.toml), with `assignments` as given by --set; or any number of
///   FILE.3mf            bodies of the materials that the file names
///   FILE.vtk|vtu|msh    a tet mesh: each region is a body of the material of its name
///   MATERIAL=FILE       a surface, a STEP file or any of these, all of one material
///   MATERIAL=STACK      a folder or zip file of layer images; then all inputs are stacks, each of its own material
/// Lengths without a unit are millimetres. A material is printed in the resin of its name.
[[nodiscard]] Result<Drawing> read_drawing(const std::vector<std::string>& inputs,
                                           const std::vector<std::string>& assignments, Progress& progress);

/// The bodies of a robot. Errors: those of its geometry.
[[nodiscard]] Result<Drawing> drawing_of(const robot::Robot& robot, Progress& progress);

/// True if a body is of this material, or graded into it.
[[nodiscard]] bool has_body_of(const Drawing& drawing, const std::string& material);

/// MATERIAL=RESIN: sets the resin of a material, and of those made of it that are not named. Errors: no such material.
[[nodiscard]] Status set_resins(const std::vector<std::string>& choices, Drawing& drawing);

}  // namespace pliant::prepare

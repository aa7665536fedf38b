// Implementation data of the library's value types.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "pliant/linearisation.hpp"
#include "pliant/simulation.hpp"
#include "robot/description/robot.hpp"
#include "simulation/linearisation/parameters.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant {

struct Robot::Data {
    robot::Robot robot;
    std::string text;                  ///< of the robot file
    std::optional<std::string> base;   ///< texts of the robots that it stands on, if any
    std::filesystem::path file;        ///< the robot file or, for a text, the file it stands for
    std::vector<std::string> changes;  ///< overrides applied to the text
    bool has_file = false;             ///< the text was read from the file

    /// Identifies the robot by everything that defines it: the origin of checkpoints.
    [[nodiscard]] std::string origin() const;
    /// Throws if a file that the robot was read from lies in a folder that results would replace.
    void check_outside(const std::filesystem::path& folder) const;
};

struct Model::Data {
    robot::Scene scene;
    std::shared_ptr<const Robot::Data> robot;
    std::optional<mesh::TetMesh> given_mesh{};  ///< m, if supplied by the caller
};

struct State::Data {
    std::shared_ptr<const Model::Data> model;
    sim::RobotState robot;
};

namespace library {

[[nodiscard]] std::vector<Point> points_of(std::span<const Vec3> points);
[[nodiscard]] std::vector<double> list_of(const Eigen::VectorXd& numbers);
[[nodiscard]] std::vector<Parameter> parameters_of(const std::vector<sim::Parameter>& all);
/// The points as one array of x, y and z.
[[nodiscard]] std::span<const double> numbers_of(std::span<const Vec3> points);
/// Converts to public Inputs. Precondition: as many drives as the model has.
[[nodiscard]] Inputs inputs_of(const sim::Model& model, const sim::Inputs& inputs);
/// Converts from public Inputs. Throws if the drives do not match the model, or are not finite.
[[nodiscard]] sim::Inputs inputs_for(const sim::Model& model, const Inputs& inputs);
[[nodiscard]] Observation observation_of(const sim::Step& step);
[[nodiscard]] StepResult result_of(const sim::Step& step);
/// Reads the robot again with further overrides, which take precedence.
[[nodiscard]] Result<robot::Robot> read_again(const Robot::Data& robot, const std::vector<std::string>& more);
/// In metres. Throws if it is not a valid mesh.
[[nodiscard]] mesh::TetMesh tet_mesh(const Mesh& given);

}  // namespace library
}  // namespace pliant

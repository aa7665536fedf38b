// What stands behind the values of the library.
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
    std::filesystem::path file;        ///< that it is of, or, of a text, that it would be of
    std::vector<std::string> changes;  ///< of the text
    bool has_file = false;             ///< the text is that of the file

    /// Everything that says what it is: of what a checkpoint is.
    [[nodiscard]] std::string origin() const;
};

struct Model::Data {
    robot::Scene scene;
    std::shared_ptr<const Robot::Data> robot;
    std::optional<mesh::TetMesh> given_mesh{};  ///< m, where a program has made it
};

struct State::Data {
    std::shared_ptr<const Model::Data> model;
    sim::RobotState robot;
};

namespace library {

[[nodiscard]] std::vector<Point> points_of(std::span<const Vec3> points);
[[nodiscard]] std::vector<double> list_of(const Eigen::VectorXd& numbers);
[[nodiscard]] std::vector<Parameter> parameters_of(const std::vector<sim::Parameter>& all);
/// x, y and z of each.
[[nodiscard]] std::span<const double> numbers_of(std::span<const Vec3> points);
/// As in Inputs and back. Precondition: as many as the model has.
[[nodiscard]] Inputs inputs_of(const sim::Model& model, const sim::Inputs& inputs);
/// Throws where the drives are not those of the model, or not finite.
[[nodiscard]] sim::Inputs inputs_for(const sim::Model& model, const Inputs& inputs);
[[nodiscard]] Observation observation_of(const sim::Step& step);
[[nodiscard]] StepResult result_of(const sim::Step& step);
/// With further changes, which count after its own.
[[nodiscard]] Result<robot::Robot> read_again(const Robot::Data& robot, const std::vector<std::string>& more);
/// In metres. Throws where it is no mesh.
[[nodiscard]] mesh::TetMesh tet_mesh(const Mesh& given);

}  // namespace library
}  // namespace pliant

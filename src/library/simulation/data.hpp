// What stands behind the values of the library.
#pragma once

#include <memory>
#include <string>

#include "pliant/simulation.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant {

struct Robot::Data {
    robot::Robot robot;
    std::string origin;  ///< the text, and everything that changes it: of what a checkpoint is
};

struct Model::Data {
    robot::Scene scene;
    std::string origin;  ///< the robot's
};

struct State::Data {
    std::shared_ptr<const Model::Data> model;
    sim::RobotState robot;
};

namespace library {

[[nodiscard]] std::vector<Point> points_of(std::span<const Vec3> points);
/// As in Inputs and back. Precondition: as many as the model has.
[[nodiscard]] Inputs inputs_of(const sim::Model& model, const sim::Inputs& inputs);
/// Throws where the drives are not those of the model, or not finite.
[[nodiscard]] sim::Inputs inputs_for(const sim::Model& model, const Inputs& inputs);
[[nodiscard]] Observation observation_of(const sim::Step& step);

}  // namespace library
}  // namespace pliant

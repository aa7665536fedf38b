// The robot with other parameter values: read again from its file, on the existing mesh.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "robot/description/robot.hpp"
#include "simulation/identify/unknown.hpp"
#include "simulation/model/model.hpp"

namespace pliant::sim::identify {

/// Reads the robot with these assignments, as of `--set`, in addition to its own.
using ReadRobot = std::function<Result<robot::Robot>(const std::vector<std::string>& assignments)>;

/// A robot with given values of its unknowns.
struct Variant {
    robot::Program program;
    sim::Model model;
};

class Source {
public:
    /// `mesh`: of robot::build_mesh(), in metres. No unknown changes it.
    Source(ReadRobot read, mesh::TetMesh mesh) : read_(std::move(read)), mesh_(std::move(mesh)) {}
    [[nodiscard]] Result<std::unique_ptr<Variant>> with(std::span<const Unknown> unknowns,
                                                        std::span<const double> values) const;
    [[nodiscard]] Result<robot::Robot> robot() const { return read_({}); }

private:
    ReadRobot read_;
    mesh::TetMesh mesh_;
};

}  // namespace pliant::sim::identify

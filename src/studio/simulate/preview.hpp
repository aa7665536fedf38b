// The same robot on linear tets: fast enough for interaction, but too stiff for accurate results.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::studio {

class Preview {
public:
    /// From a model of quadratic tets. Null if impossible: the tets are linear already, or something cannot be attached
    /// without mid-edge nodes.
    [[nodiscard]] static std::unique_ptr<const Preview> of(const robot::Robot& robot, const sim::Model& fine);

    [[nodiscard]] const robot::Robot& robot() const { return robot_; }
    [[nodiscard]] const sim::Model& model() const { return model_; }
    /// (nodes of the fine model) positions for corner positions `corners` (nodes of this model): mid-edge nodes are
    /// displaced by the mean of their ends, so that the strain is that of the linear tets.
    [[nodiscard]] sim::NodePositions lifted(const sim::NodePositions& corners) const;

private:
    Preview(robot::Robot robot, sim::Model model, const mesh::TetMesh& fine, const std::vector<int>& corner);
    robot::Robot robot_;
    sim::Model model_;
    std::vector<Vec3> rest_m_;              ///< (nodes of the fine model)
    std::vector<std::array<int, 2>> ends_;  ///< (nodes of the fine model) the two nodes here that it lies between; the
                                            ///< same twice at a corner
};

}  // namespace pliant::studio

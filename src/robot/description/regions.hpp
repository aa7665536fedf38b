// The regions of a robot's mesh: bodies first, then the air of chambers, then gaps.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robot/description/robot.hpp"

namespace pliant::robot {

struct Region {
    enum class Use { body, chamber, gap };
    Use use = Use::body;
    std::size_t index = 0;  ///< into Robot::bodies, chambers or gaps
    std::string_view kind;  ///< "body", "chamber", "gap"
    std::string_view name;
    const Geometry* geometry = nullptr;
    int line = 0;
    bool has_elements = true;  ///< has a material, or is a target-shape element of the thesis' actuators; else it is
                               ///< empty
};

/// In the order of the mesh's regions; the robot must outlive the result. A chamber whose wall is a surface file or a
/// cavity of the bodies has no region.
[[nodiscard]] std::vector<Region> regions_of(const Robot& robot);

/// Young's modulus of the softest body at small strains, Pa; infinity where there is no body.
[[nodiscard]] double softest_Pa(const Robot& robot);

}  // namespace pliant::robot

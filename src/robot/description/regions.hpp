// The regions of a robot's mesh: first the bodies, then the air of chambers, then gaps.
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
    bool has_elements = true;  ///< carries a material, or a target shape of the thesis' actuators; else it is cut out
};

/// In the order of the mesh's regions; the robot must outlive it. A chamber whose wall is a surface file or a cavity of
/// the bodies has none.
[[nodiscard]] std::vector<Region> regions_of(const Robot& robot);

/// Young's modulus of the softest body at small strains, Pa; infinity where there is no body.
[[nodiscard]] double softest_Pa(const Robot& robot);

}  // namespace pliant::robot

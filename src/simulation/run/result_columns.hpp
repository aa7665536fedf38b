// Columns of the table of steps (steps.csv): a thing called NAME has one column NAME_ENDING for each ending of its
// kind. And the first columns of the tables of the inverse and of the workspace.
#pragma once

#include <array>
#include <string_view>

namespace pliant::sim::columns {

inline constexpr std::array<std::string_view, 3> cable = {"length_ratio", "length_mm", "tension_N"};
inline constexpr std::array<std::string_view, 3> chamber = {"volume_ratio", "volume_mm3", "pressure_kPa"};
inline constexpr std::array<std::string_view, 2> spring = {"length_mm", "force_N"};
/// Of a support or an obstacle.
inline constexpr std::array<std::string_view, 3> force = {"force_x_N", "force_y_N", "force_z_N"};
inline constexpr std::array<std::string_view, 10> object = {"x_mm", "y_mm", "z_mm",      "qw",        "qx",
                                                            "qy",   "qz",   "force_x_N", "force_y_N", "force_z_N"};
/// Of every joint.
inline constexpr std::array<std::string_view, 6> joint = {"force_x_N",   "force_y_N",   "force_z_N",
                                                          "torque_x_Nm", "torque_y_Nm", "torque_z_Nm"};
/// And of a joint that turns or slides.
inline constexpr std::array<std::string_view, 2> turning = {"angle_deg", "effort_Nm"};
inline constexpr std::array<std::string_view, 2> sliding = {"position_mm", "effort_N"};

/// Of waypoints.csv and workspace.csv, whatever the robot is. A ratio that is steered has its actuator's name there.
inline constexpr std::array<std::string_view, 3> waypoint = {"index", "time", "reached"};
inline constexpr std::array<std::string_view, 2> workspace = {"piece", "found"};

}  // namespace pliant::sim::columns

// The meaning of a column of measurements: one scalar of the robot at each instant.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/gradient/measure.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim::identify {

struct Channel {
    enum class Kind {
        plain,    ///< the first measure itself
        between,  ///< of three points (9 measures): the angle at the second
        to_axis,  ///< of two points (6 measures): the angle between the line from first to second and an axis
    };
    std::string column;  ///< "tip_x_mm"
    std::string unit;    ///< "mm"; "" of a ratio
    double factor = 1;   ///< from SI to that unit
    Kind kind = Kind::plain;
    std::vector<sim::Measure> measures;
    std::size_t axis = 0;  ///< of Kind::to_axis

    /// Value in the column's unit, computed from its measures.
    [[nodiscard]] double value(std::span<const double> of_measures) const;
    /// Derivative of the value with respect to each measure. All are 0 for an angle of 0 or 180 degrees, which is not
    /// differentiable.
    [[nodiscard]] std::vector<double> slopes(std::span<const double> of_measures) const;
};

/// Columns as in markers.csv and steps.csv (docs/reference/results.md), and angles: A-B-C_angle_deg at B between the
/// directions to A and C, A-B_angle_x_deg between the direction from A to B and the x axis (or y, z).
[[nodiscard]] std::vector<Channel> plain_channels(const sim::Description& robot);
/// Further columns of steps.csv, of sensors, objects and joints, which are no channels.
[[nodiscard]] std::vector<std::string> other_columns(const sim::Description& robot);
/// Empty if the column is none of plain_channels() and no angle.
[[nodiscard]] std::optional<Channel> find_channel(const sim::Description& robot, std::string_view column);

}  // namespace pliant::sim::identify

// Where in the robot file an error of a body, a chamber or its mesh belongs.
#pragma once

#include <string_view>

#include "base/core/error.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Location of a thing in the robot file.
[[nodiscard]] inline Diagnostic place(const Robot& robot, int line, std::string_view kind, std::string_view name) {
    return {robot.file.string(), line, name.empty() ? std::string(kind) : fmt::format("{} \"{}\"", kind, name), ""};
}

/// The error with its location.
[[nodiscard]] inline Error at(Diagnostic place, const Error& error) {
    place.text = error.message;
    return error_of(error.cause, {std::move(place)});
}

}  // namespace pliant::robot

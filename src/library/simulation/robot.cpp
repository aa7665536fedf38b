#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "base/core/files.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "robot/file/robot_file.hpp"

namespace pliant {

Robot::Robot(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

namespace {

std::string origin_of(std::string_view toml, const std::vector<std::string>& changes) {
    return fmt::format("{}\n{}", fmt::join(changes, "\n"), toml);
}

}  // namespace

Robot Robot::load(const std::filesystem::path& file, const std::vector<std::string>& changes) {
    auto robot = library::value_of(robot::load_robot(file, changes));
    const std::string text = library::value_of(read_file(file));
    return Robot(std::make_shared<const Data>(Data{std::move(robot), origin_of(text, changes)}));
}

Robot Robot::parse(std::string_view toml, const std::filesystem::path& folder,
                   const std::vector<std::string>& changes) {
    return Robot(std::make_shared<const Data>(
        Data{library::value_of(robot::parse_robot(toml, folder / "robot text", changes)), origin_of(toml, changes)}));
}

const std::string& Robot::name() const {
    return data_->robot.name;
}
double Robot::duration() const {
    return data_->robot.program.duration;
}
int Robot::steps() const {
    return data_->robot.program.steps;
}

}  // namespace pliant

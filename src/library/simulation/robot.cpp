#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "base/core/files.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "robot/file/robot_document.hpp"
#include "robot/file/robot_file.hpp"

namespace pliant {

Robot::Robot(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

std::string Robot::Data::origin() const {
    const std::string files = library::value_of(robot::digest_of_named_files(text, file, changes));
    return fmt::format("{}\n{}{}{}", fmt::join(changes, "\n"), text, base ? "\nstands on\n" + *base : "",
                       files.empty() ? "" : "\nwith files " + files);
}

Result<robot::Robot> library::read_again(const Robot::Data& robot, const std::vector<std::string>& more) {
    std::vector<std::string> all = robot.changes;
    all.insert(all.end(), more.begin(), more.end());
    return robot::parse_robot(robot.text, robot.file, all);
}

void Robot::Data::check_outside(const std::filesystem::path& folder) const {
    if (!has_file) return;
    for (const std::filesystem::path& input : robot::files_of(file, changes))
        library::check(pliant::check_outside(input, folder));
}

Robot Robot::load(const std::filesystem::path& file, const std::vector<std::string>& changes) {
    auto robot = library::value_of(robot::load_robot(file, changes));
    std::string text = library::value_of(read_file(file));
    auto base = library::value_of(robot::base_text(text, file));
    return Robot(
        std::make_shared<const Data>(Data{std::move(robot), std::move(text), std::move(base), file, changes, true}));
}

Robot Robot::parse(std::string_view toml, const std::filesystem::path& folder,
                   const std::vector<std::string>& changes) {
    const std::filesystem::path file = folder / "robot text";
    auto robot = library::value_of(robot::parse_robot(toml, file, changes));
    auto base = library::value_of(robot::base_text(toml, file));
    return Robot(
        std::make_shared<const Data>(Data{std::move(robot), std::string(toml), std::move(base), file, changes, false}));
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
std::string Robot::text(const std::filesystem::path& folder) const {
    return library::value_of(robot::robot_text(data_->text, data_->file, data_->changes, folder));
}

}  // namespace pliant

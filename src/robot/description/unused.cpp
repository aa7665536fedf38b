#include "robot/description/unused.hpp"

#include <fmt/format.h>

#include "base/core/text.hpp"

namespace pliant::robot {

std::vector<std::string> unused_materials(const Robot& robot) {
    std::vector<bool> used(robot.materials.size(), false);
    for (const BodySpec& body : robot.bodies) {
        used[static_cast<std::size_t>(body.material)] = true;
        if (body.blend) used[static_cast<std::size_t>(body.blend->material)] = true;
    }
    std::vector<std::string> names;
    for (std::size_t m = 0; m < used.size(); ++m)
        if (used[m]) names.push_back(robot.materials[m].name);
    std::vector<std::string> notes;
    for (std::size_t m = 0; m < used.size(); ++m) {
        if (used[m]) continue;
        const std::string near = nearest_name(robot.materials[m].name, names);
        notes.push_back(fmt::format("no body uses material \"{}\"{}", robot.materials[m].name,
                                    near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
    }
    return notes;
}

}  // namespace pliant::robot

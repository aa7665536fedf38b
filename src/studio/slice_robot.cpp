#include "studio/slice_robot.hpp"

#include "robot/robot.hpp"
#include "studio/scene.hpp"

namespace pliant::studio {
namespace {

/// Of the job's materials; one that was made for a body's own light has the colour of a body.
std::vector<std::string> colours_of(const job::Manifest& manifest, const robot::Robot& robot) {
    std::vector<std::string> colours;
    for (const job::Material& material : manifest.materials) {
        for (std::size_t m = 0; m < robot.materials.size(); ++m) {
            const std::string& name = robot.materials[m].name;
            if (material.name == name || material.name.starts_with(name + " of ")) {
                colours.push_back(colour_of(robot, m));
                break;
            }
        }
    }
    return colours;
}

}  // namespace

Result<std::vector<std::string>> slice_robot(const SliceOrder& wanted, const std::filesystem::path& job,
                                             Progress& progress) {
    const Result<robot::Robot> robot = robot::parse_robot(wanted.robot_text, wanted.robot_file);
    if (!robot) return tl::unexpected(robot.error());
    Result<prepare::Drawing> drawing = prepare::drawing_of(*robot, progress);
    if (!drawing) return tl::unexpected(drawing.error());
    const auto made = prepare::slice_job(wanted.order, wanted.printer, std::move(*drawing), job, progress);
    if (!made) return tl::unexpected(made.error());
    return colours_of(made->manifest, *robot);
}

}  // namespace pliant::studio

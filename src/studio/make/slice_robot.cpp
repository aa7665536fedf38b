#include "studio/make/slice_robot.hpp"

#include <string>

#include "presentation/draw/colour.hpp"
#include "presentation/scene/scene.hpp"
#include "printing/prepare/estimate.hpp"
#include "robot/file/robot_file.hpp"

namespace pliant::studio {
namespace {

/// A material created for a body's own exposure has the colour of the original. "": the robot has no such material.
std::string colour_of_material(const std::string& name, const robot::Robot& robot) {
    for (std::size_t m = 0; m < robot.materials.size(); ++m) {
        const std::string& known = robot.materials[m].name;
        if (name == known || name.starts_with(known + " of ")) return report::hex(view::colour_of(robot, m));
    }
    return "";
}

/// Colours of the job's materials; those printed together have the colour of the first.
std::vector<std::string> colours_by_robot(const job::Manifest& manifest, const robot::Robot& robot) {
    std::vector<std::string> colours;
    for (std::size_t m = 0; m < manifest.materials.size(); ++m) {
        const job::Material& material = manifest.materials[m];
        const std::string own =
            colour_of_material(material.parts.empty() ? material.name : material.parts.front().name, robot);
        colours.push_back(own.empty() ? report::hex(report::palette(static_cast<int>(m))) : own);
    }
    return colours;
}

/// With the files beside the robot's named as in its project: a page knows no folders of this computer.
Error by_project_names(Error error, const SliceOrder& wanted) {
    if (!wanted.robot_file.has_parent_path()) return error;
    const std::string folder = wanted.robot_file.parent_path().string() + "/";
    for (std::size_t at = 0; (at = error.message.find(folder, at)) != std::string::npos;)
        error.message.erase(at, folder.size());
    return error;
}

}  // namespace

Result<std::vector<std::string>> slice_robot(const SliceOrder& wanted, const std::filesystem::path& job,
                                             Progress& progress, JobUnderWay& seen) {
    const Result<robot::Robot> robot = robot::parse_robot(wanted.robot_text, wanted.robot_file);
    if (!robot) return tl::unexpected(by_project_names(robot.error(), wanted));
    Result<prepare::Drawing> drawing = prepare::drawing_of(*robot, progress);
    if (!drawing) return tl::unexpected(by_project_names(drawing.error(), wanted));
    seen.clear();
    const auto watch = [&](const job::Manifest& so_far, int count, const std::vector<job::EncodedImage>& images) {
        seen.add(so_far, count, images, colours_by_robot(so_far, *robot));
    };
    const auto made = prepare::slice_job(wanted.order, wanted.printer, std::move(*drawing), job, progress, watch);
    if (!made) return tl::unexpected(made.error());
    return colours_by_robot(made->manifest, *robot);
}

Result<plan::Plan> estimate_robot(const SliceOrder& wanted) {
    Result<robot::Robot> robot = robot::parse_robot(wanted.robot_text, wanted.robot_file);
    if (!robot) return tl::unexpected(by_project_names(robot.error(), wanted));
    Progress silent;
    Result<prepare::Drawing> drawing = prepare::drawing_of(*robot, silent);
    if (!drawing) return tl::unexpected(by_project_names(drawing.error(), wanted));
    return prepare::estimate(wanted.order, wanted.printer.printer, std::move(*drawing));
}

}  // namespace pliant::studio

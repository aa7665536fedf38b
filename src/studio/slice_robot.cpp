#include "studio/slice_robot.hpp"

#include <fmt/format.h>

#include "prepare/slice_job.hpp"
#include "robot/robot.hpp"
#include "studio/scene.hpp"

namespace pliant::studio {
namespace {

prepare::Order order_of(const SliceOrder& wanted) {
    prepare::Order order;
    order.inputs = {wanted.robot_file.filename().string()};
    if (wanted.layer_um > 0) order.layer = fmt::format("{} um", wanted.layer_um);
    order.copies = wanted.copies;
    order.turn = wanted.turn_deg;
    order.version = wanted.version;
    return order;
}

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
    Result<machine::Printer> printer = machine::parse_printer(wanted.printer_text, wanted.printer_name);
    if (!printer) return tl::unexpected(printer.error());
    const Result<robot::Robot> robot = robot::parse_robot(wanted.robot_text, wanted.robot_file);
    if (!robot) return tl::unexpected(robot.error());
    Result<prepare::Drawing> drawing = prepare::drawing_of(*robot, progress);
    if (!drawing) return tl::unexpected(drawing.error());
    if (!printer->projector.mask.empty())
        drawing->warnings.emplace_back("the projector's mask is left out here; pliant slice applies it");
    const prepare::PrinterFile file{std::move(*printer), wanted.printer_text};
    const auto made = prepare::slice_job(order_of(wanted), file, std::move(*drawing), job, progress);
    if (!made) return tl::unexpected(made.error());
    return colours_of(made->manifest, *robot);
}

}  // namespace pliant::studio

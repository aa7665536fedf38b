#include "studio/slice_robot.hpp"

#include <algorithm>
#include <map>

#include "job/make_job.hpp"
#include "job/settings_record.hpp"
#include "plan/check.hpp"
#include "plan/plan.hpp"
#include "robot/build.hpp"
#include "slice/arrange.hpp"
#include "slice/place.hpp"
#include "studio/scene.hpp"

namespace pliant::studio {
namespace {

constexpr double gap_between_copies_um = 2000;

Result<std::vector<slice::Body>> bodies_of(const robot::Robot& robot, Progress& progress) {
    Result<std::vector<robot::BodySurface>> surfaces = robot::body_surfaces(robot, progress);
    if (!surfaces) return tl::unexpected(surfaces.error());
    std::vector<slice::Body> bodies;
    for (robot::BodySurface& body : *surfaces)
        bodies.push_back({robot.materials[static_cast<std::size_t>(body.material)].name,
                          mesh::scaled(std::move(body.surface_m), 1e6), body.body});
    return bodies;
}

/// Exposures come from the printer file; for a resin that it does not know, the longest ones it has are taken.
job::Material exposed(const robot::MaterialSpec& material, const machine::Printer& printer,
                      std::vector<std::string>& warnings) {
    job::Material entry;
    entry.name = material.name;
    entry.resin = material.resin;
    if (const machine::Resin* known = printer.find_resin(material.resin)) {
        entry.exposure_s = known->exposure_s;
        entry.bottom_exposure_s = known->bottom_exposure_s;
        return entry;
    }
    for (const machine::Resin& other : printer.resins) {
        entry.exposure_s = std::max(entry.exposure_s, other.exposure_s);
        entry.bottom_exposure_s = std::max(entry.bottom_exposure_s, other.bottom_exposure_s);
    }
    warnings.push_back(fmt::format("resin \"{}\" is not in the printer file: exposures of {} s and {} s are assumed",
                                   material.resin, entry.exposure_s, entry.bottom_exposure_s));
    return entry;
}

job::JobSettings settings_of(const SliceOrder& order, const robot::Robot& robot, const machine::Printer& printer,
                             std::vector<std::string>& warnings) {
    job::JobSettings settings;
    settings.name = robot.name;
    settings.pliant_version = order.version;
    for (const machine::Resin& resin : printer.resins)
        settings.bottom_layers = std::max(settings.bottom_layers, resin.bottom_layers);
    const machine::Projector& p = printer.projector;
    settings.slicing.raster = {p.width_px, p.height_px,    p.pixel_um,    p.mirror_x,
                               p.mirror_y, p.rotation_deg, p.offset_x_um, p.offset_y_um};
    if (!p.grey.empty()) settings.light.grey = slice::grey_values(p.grey);
    if (!p.mask.empty()) warnings.push_back("the projector's mask is left out here; pliant slice applies it");
    settings.copies = order.copies;
    settings.slicing.layer_um = order.layer_um > 0 ? order.layer_um : printer.layer_um;
    for (const robot::MaterialSpec& material : robot.materials) {
        settings.materials.push_back(exposed(material, printer, warnings));
        const machine::Resin* resin = printer.find_resin(material.resin);
        if (resin == nullptr || (resin->xy_compensation_um == 0 && resin->elephant_foot_um == 0)) continue;
        settings.slicing.compensation[material.name] = {static_cast<double>(resin->xy_compensation_um),
                                                        static_cast<double>(resin->elephant_foot_um),
                                                        resin->elephant_foot_layers};
    }
    return settings;
}

Status arrange(const SliceOrder& order, const slice::Raster& raster, std::vector<slice::Body>& bodies,
               std::vector<std::string>& warnings) {
    if (order.turn_deg.size() == 3) {
        const Vec3 degrees{order.turn_deg[0], order.turn_deg[1], order.turn_deg[2]};
        if (Status status = slice::turn(bodies, degrees); !status) return status;
    }
    if (Status status = slice::repeat(bodies, order.copies, gap_between_copies_um, raster); !status) return status;
    const Result<std::vector<std::string>> placed = slice::place_on_platform(bodies, raster);
    if (!placed) return tl::unexpected(placed.error());
    warnings.insert(warnings.end(), placed->begin(), placed->end());
    return {};
}

Status finish(const SliceOrder& order, const job::JobSettings& settings, job::MadeJob& made,
              const machine::Printer& printer, job::Writer& writer) {
    const Result<plan::Plan> plan = plan::make_plan(made.manifest, printer);
    if (!plan) return tl::unexpected(plan.error());
    const std::string gcode = plan::write_gcode(*plan, made.manifest, printer);
    Status status = plan::check_gcode(gcode, printer);
    if (status) status = writer.add_file("printer.toml", order.printer_text);
    const job::Request request{{order.robot_file.filename().string()}, {}, order.turn_deg, "2 mm"};
    if (status) status = writer.add_file("settings.json", job::settings_json(settings, request));
    if (status) status = writer.add_file("plan.json", plan::plan_json(*plan));
    if (status) status = writer.add_file("job.gcode", gcode);
    if (status) status = writer.finish(made.manifest);
    return status;
}

}  // namespace

Result<std::vector<std::string>> slice_robot(const SliceOrder& order, const std::filesystem::path& job,
                                             Progress& progress) {
    const Result<machine::Printer> printer = machine::parse_printer(order.printer_text, order.printer_name);
    if (!printer) return tl::unexpected(printer.error());
    const Result<robot::Robot> robot = robot::parse_robot(order.robot_text, order.robot_file);
    if (!robot) return tl::unexpected(robot.error());
    Result<std::vector<slice::Body>> bodies = bodies_of(*robot, progress);
    if (!bodies) return tl::unexpected(bodies.error());
    std::vector<std::string> warnings;
    const job::JobSettings settings = settings_of(order, *robot, *printer, warnings);
    if (Status s = arrange(order, settings.slicing.raster, *bodies, warnings); !s) return tl::unexpected(s.error());
    Result<job::Writer> writer = job::Writer::create(job);
    if (!writer) return tl::unexpected(writer.error());
    Result<job::MadeJob> made = job::slice_to_job(*bodies, settings, *writer, progress);
    if (!made) return tl::unexpected(made.error());
    auto& all = made->manifest.warnings;
    all.insert(all.begin(), warnings.begin(), warnings.end());
    if (Status s = finish(order, settings, *made, *printer, *writer); !s) return tl::unexpected(s.error());
    std::vector<std::string> colours;
    for (const job::Material& material : made->manifest.materials) {
        for (std::size_t m = 0; m < robot->materials.size(); ++m) {
            if (robot->materials[m].name == material.name) colours.push_back(colour_of(*robot, m));
        }
    }
    return colours;
}

}  // namespace pliant::studio

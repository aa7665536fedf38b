// pliant slice: layer images, plan and G-code of a robot for one printer, in one job file.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "command.hpp"
#include "core/files.hpp"
#include "core/units.hpp"
#include "job/make_job.hpp"
#include "job/png.hpp"
#include "job/settings_record.hpp"
#include "machine/printer.hpp"
#include "plan/check.hpp"
#include "plan/plan.hpp"
#include "report/job_picture.hpp"
#include "slice/arrange.hpp"
#include "slice/place.hpp"
#include "slice_input.hpp"

namespace pliant::app {
namespace {

struct Options {
    std::vector<std::string> inputs;
    std::string printer;
    std::string layer;
    std::string job;
    std::string picture;
    std::vector<std::string> assignments, resins, interlocks;
    int copies = 1;
    std::string spacing = "2 mm";
    std::vector<double> turn;
    std::string least_feature;
    bool no_anti_alias = false;
    double threshold = 0.5;
    Output output;
};

/// Exposures come from the printer file; for a resin that it does not know, the longest ones it has are taken.
std::vector<job::Material> with_exposures(const Drawing& drawing, const machine::Printer& printer,
                                          std::vector<std::string>& warnings) {
    std::vector<job::Material> materials;
    for (const auto& [material, resin] : drawing.resin_of_material) {
        const auto same_name = [&name = material](const job::Material& known) { return known.name == name; };
        if (std::any_of(materials.begin(), materials.end(), same_name)) continue;
        job::Material entry;
        entry.name = material;
        entry.resin = resin;
        if (const machine::Resin* known = printer.find_resin(resin)) {
            entry.exposure_s = known->exposure_s;
            entry.bottom_exposure_s = known->bottom_exposure_s;
        } else {
            for (const machine::Resin& other : printer.resins) {
                entry.exposure_s = std::max(entry.exposure_s, other.exposure_s);
                entry.bottom_exposure_s = std::max(entry.bottom_exposure_s, other.bottom_exposure_s);
            }
            warnings.push_back(fmt::format(
                "resin \"{}\" is not in the printer file: exposures of {} s and {} s (first layers) are assumed", resin,
                entry.exposure_s, entry.bottom_exposure_s));
        }
        materials.push_back(std::move(entry));
    }
    return materials;
}

Result<int> layer_height_um(const Options& options, const machine::Printer& printer) {
    if (options.layer.empty()) return printer.layer_um;
    const Result<double> height = parse_quantity(options.layer, Dimension::length);
    if (!height) return input_error("--layer: {}", height.error().message);
    const double um = std::round(*height * 1e6);
    if (um < 1 || um > 1000 || std::fabs(um - *height * 1e6) > 1e-6)
        return input_error("--layer {}: a whole number of micrometres from 1 to 1000 is needed", options.layer);
    return static_cast<int>(um);
}

/// Of every material, as the resin that it is printed in asks for.
std::map<std::string, slice::Compensation> compensations(const Drawing& drawing, const machine::Printer& printer) {
    std::map<std::string, slice::Compensation> result;
    for (const auto& [material, name] : drawing.resin_of_material) {
        const machine::Resin* resin = printer.find_resin(name);
        if (resin == nullptr || (resin->xy_compensation_um == 0 && resin->elephant_foot_um == 0)) continue;
        result[material] = {static_cast<double>(resin->xy_compensation_um),
                            static_cast<double>(resin->elephant_foot_um), resin->elephant_foot_layers};
    }
    return result;
}

/// A whole number without anything around it; -1 for anything else.
int plain_number(const std::string& text) {
    int number = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() ? number : -1;
}

/// FIRST+SECOND=DEPTH or FIRST+SECOND=DEPTH,LAYERS.
Result<slice::Teeth> read_teeth(const std::string& text) {
    const std::size_t equals = text.rfind('='), plus = text.find('+');
    if (equals == std::string::npos || plus == std::string::npos || plus > equals)
        return input_error("--interlock {}: write MATERIAL+MATERIAL=PIXELS or MATERIAL+MATERIAL=PIXELS,LAYERS", text);
    const std::string numbers = text.substr(equals + 1);
    const std::size_t comma = std::min(numbers.find(','), numbers.size());
    slice::Teeth teeth{text.substr(0, plus), text.substr(plus + 1, equals - plus - 1), 0, 1};
    teeth.depth_px = plain_number(numbers.substr(0, comma));
    if (comma < numbers.size()) teeth.layers = plain_number(numbers.substr(comma + 1));
    if (teeth.depth_px < 0 || teeth.layers < 0)
        return input_error("--interlock {}: \"{}\" must be whole numbers, as in 4 or 4,2", text, numbers);
    return teeth;
}

Status set_teeth(const Options& options, const Drawing& drawing, slice::Settings& slicing) {
    if (!options.interlocks.empty() && !drawing.stacks.empty())
        return input_error("--interlock: layer images are printed as they are");
    for (const std::string& text : options.interlocks) {
        Result<slice::Teeth> teeth = read_teeth(text);
        if (!teeth) return tl::unexpected(teeth.error());
        slicing.teeth.push_back(std::move(*teeth));
    }
    return {};
}

int bottom_layers(const machine::Printer& printer) {
    int layers = 0;
    for (const machine::Resin& resin : printer.resins) layers = std::max(layers, resin.bottom_layers);
    return layers;
}

void print_summary(const Options& options, const job::Manifest& manifest, const plan::Plan& plan) {
    if (options.output.quiet) return;
    fmt::print("{}: {} layers of {} um, {} x {} px of {:.6g} um\n", options.job, manifest.layers.size(),
               manifest.layers.empty() ? 0 : manifest.layers.front().thickness_um, manifest.width_px,
               manifest.height_px, manifest.pixel_um);
    for (const job::Material& material : manifest.materials) {
        fmt::print("material {}: resin {}, {:.1f} mm^3\n", material.name, material.resin, material.model_volume_mm3);
    }
    for (const std::string& warning : plan.warnings) fmt::print("warning: {}\n", warning);
    for (const std::string& warning : manifest.warnings) fmt::print("warning: {}\n", warning);
    fmt::print("{} swaps, {} in all\n", plan.swaps, plan::clock_text(plan.seconds.total));
}

slice::Raster raster_of(const machine::Projector& p) {
    return {p.width_px, p.height_px, p.pixel_um, p.mirror_x, p.mirror_y, p.rotation_deg, p.offset_x_um, p.offset_y_um};
}

/// The mask lies beside the printer file and has the projector's size.
Result<slice::LightCorrection> light_of(const machine::Projector& projector, const std::filesystem::path& printer) {
    slice::LightCorrection light;
    if (!projector.grey.empty()) light.grey = slice::grey_values(projector.grey);
    if (projector.mask.empty()) return light;
    const std::filesystem::path path = printer.parent_path() / projector.mask;
    const Result<std::string> png = read_file(path);
    if (!png) return tl::unexpected(png.error());
    Result<slice::Image> mask = job::decode_png(*png, {projector.width_px, projector.height_px}, path.string());
    if (!mask) return tl::unexpected(mask.error());
    light.mask = std::move(*mask);
    return light;
}

/// Turns the part, lays out its copies and stands them on the platform.
Status arrange(const Options& options, const slice::Raster& raster, Drawing& drawing) {
    if (!options.turn.empty()) {
        const Vec3 degrees{options.turn[0], options.turn[1], options.turn[2]};
        if (Status status = slice::turn(drawing.bodies, degrees); !status) return status;
    }
    const Result<double> spacing = parse_quantity(options.spacing, Dimension::length);
    if (!spacing) return input_error("--spacing: {}", spacing.error().message);
    if (Status status = slice::repeat(drawing.bodies, options.copies, *spacing * 1e6, raster); !status) return status;
    const Result<std::vector<std::string>> warnings = slice::place_on_platform(drawing.bodies, raster);
    if (!warnings) return tl::unexpected(warnings.error());
    drawing.warnings.insert(drawing.warnings.end(), warnings->begin(), warnings->end());
    return {};
}

Status draw_picture(const Options& options) {
    const Result<job::Archive> archive = job::Archive::open(options.job);
    if (!archive) return tl::unexpected(archive.error());
    const Result<std::string> png = report::job_picture(*archive);
    if (!png) return tl::unexpected(png.error());
    return write_file(options.picture, *png);
}

Status set_least_feature(const Options& options, job::JobSettings& settings) {
    constexpr double most_m = 0.01;
    if (options.least_feature.empty()) return {};
    const Result<double> least = parse_quantity(options.least_feature, Dimension::length);
    if (!least) return input_error("--least-feature: {}", least.error().message);
    if (!(*least > 0 && *least <= most_m))
        return input_error("--least-feature {}: must be above 0 and at most 10 mm", options.least_feature);
    settings.least_feature_um = *least * 1e6;
    return {};
}

Status slice(const Options& options) {
    const auto progress = terminal_progress(options.output);
    const Result<machine::Printer> printer = machine::load_printer(options.printer);
    if (!printer) return tl::unexpected(printer.error());
    const Result<std::string> printer_text = read_file(options.printer);
    if (!printer_text) return tl::unexpected(printer_text.error());
    const Result<int> layer_um = layer_height_um(options, *printer);
    if (!layer_um) return tl::unexpected(layer_um.error());
    Result<Drawing> drawing = read_drawing(options.inputs, options.assignments, *progress);
    if (!drawing) return tl::unexpected(drawing.error());
    if (Status status = set_resins(options.resins, *drawing); !status) return status;

    job::JobSettings settings;
    settings.name = drawing->name;
    settings.pliant_version = PLIANT_VERSION;
    settings.bottom_layers = bottom_layers(*printer);
    settings.slicing.raster = raster_of(printer->projector);
    Result<slice::LightCorrection> light = light_of(printer->projector, options.printer);
    if (!light) return tl::unexpected(light.error());
    settings.light = std::move(*light);
    settings.copies = options.copies;
    settings.slicing.layer_um = *layer_um;
    settings.materials = with_exposures(*drawing, *printer, drawing->warnings);
    settings.slicing.compensation = compensations(*drawing, *printer);
    if (!drawing->stacks.empty() && !settings.slicing.compensation.empty()) {
        settings.slicing.compensation.clear();
        drawing->warnings.push_back("xy_compensation and elephant_foot: layer images are printed as they are");
    }
    if (Status status = set_teeth(options, *drawing, settings.slicing); !status) return status;
    if (Status status = set_least_feature(options, settings); !status) return status;
    settings.slicing.rules.anti_alias = !options.no_anti_alias;
    settings.slicing.rules.threshold = options.threshold;
    if (drawing->stacks.empty()) {
        if (Status status = arrange(options, settings.slicing.raster, *drawing); !status) return status;
    } else if (options.copies != 1 || !options.turn.empty()) {
        return input_error("--copies, --turn: layer images are printed as they are");
    }

    Result<job::Writer> writer = job::Writer::create(options.job);
    if (!writer) return tl::unexpected(writer.error());
    Result<job::MadeJob> made = drawing->stacks.empty()
                                    ? job::slice_to_job(drawing->bodies, settings, *writer, *progress)
                                    : job::stacks_to_job(drawing->stacks, settings, *writer, *progress);
    if (!made) return tl::unexpected(made.error());
    made->manifest.warnings.insert(made->manifest.warnings.begin(), drawing->warnings.begin(), drawing->warnings.end());
    const Result<plan::Plan> plan = plan::make_plan(made->manifest, *printer);
    if (!plan) return tl::unexpected(plan.error());
    const std::string gcode = plan::write_gcode(*plan, made->manifest, *printer);
    Status status = plan::check_gcode(gcode, *printer);
    if (status) status = writer->add_file("printer.toml", *printer_text);
    const job::Request request{options.inputs, options.assignments, options.turn, options.spacing};
    if (status) status = writer->add_file("settings.json", job::settings_json(settings, request));
    if (status) status = writer->add_file("plan.json", plan::plan_json(*plan));
    if (status) status = writer->add_file("job.gcode", gcode);
    if (status) status = writer->finish(made->manifest);
    if (status && !options.picture.empty()) status = draw_picture(options);
    if (status) print_summary(options, made->manifest, *plan);
    return status;
}

}  // namespace

void add_slice(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("slice", "make the job of a robot for a printer: images, plan, G-code");
    command
        ->add_option("inputs", options->inputs,
                     "a robot file; or any of FILE.3mf, FILE.vtk (regions are materials), MATERIAL=FILE or "
                     "folder or zip of layer images")
        ->required();
    command->add_option("--printer", options->printer, "printer file (TOML)")->required();
    command->add_option("-o,--output", options->job, "job file to write (.zip)")->required();
    command->add_option("--picture", options->picture, "PNG file: the part from the front, and some layers");
    command->add_option("--layer", options->layer, "layer height, as in \"50 um\"; the printer file's where not given");
    command->add_option("--resin", options->resins, "MATERIAL=RESIN: what a material is printed in")
        ->type_name("MATERIAL=RESIN")
        ->allow_extra_args(false);
    command
        ->add_option("--interlock", options->interlocks,
                     "MATERIAL+MATERIAL=PIXELS[,LAYERS]: teeth so deep, changing sides every so many layers")
        ->type_name("A+B=PIXELS[,LAYERS]")
        ->allow_extra_args(false);
    command->add_option("--least-feature", options->least_feature,
                        "warn of walls and tips narrower than this, as in \"0.3 mm\"");
    command->add_option("--copies", options->copies, "how many of the part, side by side");
    command->add_option("--spacing", options->spacing, "between copies, as in \"2 mm\"")->capture_default_str();
    command->add_option("--turn", options->turn, "X Y Z: degrees about each axis, one after the other")->expected(3);
    command->add_flag("--no-anti-alias", options->no_anti_alias, "pixels are full or dark");
    command->add_option("--threshold", options->threshold, "without anti-aliasing: least coverage of a full pixel")
        ->capture_default_str();
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key of the robot file")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, false);
    command->footer(
        "Example: pliant slice examples/cable_gripper/gripper.toml --printer examples/printers/tower.toml -o "
        "gripper.zip");
    command->callback([options, &status] {
        const Status result = slice(*options);
        status = result ? exit_done : report(result.error());
    });
}

}  // namespace pliant::app

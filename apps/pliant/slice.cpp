// pliant slice: layer images, plan and G-code of a robot for one printer, in one job file.
#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "base/core/json.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "overcure.hpp"
#include "presentation/print_report/job_picture.hpp"
#include "printed.hpp"
#include "printing/job/image_volumes.hpp"
#include "printing/job/png.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/plan/plan.hpp"
#include "printing/prepare/slice_job.hpp"

namespace pliant::app {
namespace {

struct SliceOptions {
    prepare::Order order;
    std::string printer, job, picture, paint;
    bool spaced_alone = false;  ///< --spacing without --copies
    Output output;
};

/// "50 um", or "25 to 100 um" for layers of different heights.
std::string heights_text(const job::Manifest& manifest) {
    int least = 0, most = 0;
    for (const job::Layer& layer : manifest.layers) {
        least = least == 0 ? layer.thickness_um : std::min(least, layer.thickness_um);
        most = std::max(most, layer.thickness_um);
    }
    return least == most ? fmt::format("{} um", least) : fmt::format("{} to {} um", least, most);
}

/// Drawn volumes of materials that are exposed together, as in ", exposed together: a 12.0, b 3.0 mm^3".
std::string parts_text(const job::Material& material) {
    std::string text;
    for (const job::MaterialPart& part : material.parts)
        text +=
            fmt::format("{} {} {:.1f}", text.empty() ? ", exposed together:" : ",", part.name, part.model_volume_mm3);
    return text.empty() ? text : text + " mm^3";
}

/// What the images hold of a material where it differs from the drawing: parts that are hollow, supports.
std::string images_text(double held_mm3, double drawn_mm3) {
    constexpr double noticeable = 0.01;
    return std::abs(held_mm3 - drawn_mm3) > noticeable * drawn_mm3
               ? fmt::format(" drawn, {:.1f} mm^3 in the images", held_mm3)
               : "";
}

void print_job(const SliceOptions& options, const job::Manifest& manifest, const plan::Plan& plan,
               const std::vector<std::string>& notes) {
    if (options.output.quiet) return;
    fmt::print("{}: {} of {}, {} x {} px of {:.6g} um\n", options.job, counted(manifest.layers.size(), "layer"),
               heights_text(manifest), manifest.width_px, manifest.height_px, manifest.pixel_um);
    const std::vector<double> held_mm3 = job::image_volumes_mm3(manifest);
    for (std::size_t m = 0; m < manifest.materials.size(); ++m) {
        const job::Material& material = manifest.materials[m];
        fmt::print("material {}: resin {}, {:.1f} mm^3{}{}\n", material.name, material.resin, material.model_volume_mm3,
                   images_text(held_mm3[m], material.model_volume_mm3), parts_text(material));
    }
    for (const std::string& note : notes) fmt::print("{}\n", note);
    for (const std::string& warning : plan.warnings) fmt::print("warning: {}\n", warning);
    for (const std::string& warning : manifest.warnings) fmt::print("warning: {}\n", warning);
    fmt::print("{}, {} total\n", counted(static_cast<std::size_t>(plan.swaps), "swap"),
               plan::clock_text(plan.seconds.total));
}

/// The plan is that of `pliant plan --json`.
void print_job_json(const SliceOptions& options, const job::Manifest& manifest, const plan::Plan& plan,
                    const std::vector<std::string>& notes) {
    nlohmann::json materials = nlohmann::json::array();
    for (const job::Material& m : manifest.materials)
        materials.push_back({{"name", m.name},
                             {"resin", m.resin},
                             {"model_volume_mm3", m.model_volume_mm3},
                             {"exposure_s", m.exposure_s}});
    const nlohmann::json json = {{"job", options.job},
                                 {"name", manifest.name},
                                 {"layers", manifest.layers.size()},
                                 {"width_px", manifest.width_px},
                                 {"height_px", manifest.height_px},
                                 {"pixel_um", manifest.pixel_um},
                                 {"materials", materials},
                                 {"notes", notes},
                                 {"warnings", manifest.warnings},
                                 {"plan", parse_json(plan::plan_json(plan))}};
    print_json(json);
}

Status draw_picture(const SliceOptions& options) {
    const Result<job::Archive> archive = job::Archive::open(options.job);
    if (!archive) return tl::unexpected(archive.error());
    const Result<std::string> png = report::job_picture(*archive);
    if (!png) return tl::unexpected(png.error());
    return write_file(options.picture, *png);
}

/// Adds warnings that depend on the finished images.
Status add_overcure(const std::string& file, const machine::Printer& printer, plan::Plan& plan, Progress& progress) {
    const Result<job::Archive> archive = job::Archive::open(file);
    if (!archive) return tl::unexpected(archive.error());
    const Result<std::vector<std::string>> warnings = overcure_warnings(*archive, plan, printer, progress);
    if (!warnings && warnings.error().cause == Cause::cancelled)
        return tl::unexpected(
            Error{Cause::cancelled,
                  fmt::format("cancelled: {} is whole, but overcure was not looked for; \"pliant plan\" does", file)});
    if (!warnings) return tl::unexpected(warnings.error());
    plan.warnings.insert(plan.warnings.end(), warnings->begin(), warnings->end());
    return {};
}

Result<prepare::PrinterFile> with_mask(const std::string& file) {
    Result<PrinterText> read = app::read_printer_file(file);
    if (!read) return tl::unexpected(read.error());
    Result<std::optional<job::Image>> mask = operate::load_mask(read->printer.projector, file);
    if (!mask) return tl::unexpected(mask.error());
    return prepare::PrinterFile{std::move(read->printer), std::move(read->text), std::move(*mask)};
}

/// The table itself is stored in the order, so that the job can keep it.
Status read_paint(const std::string& file, prepare::Order& order) {
    if (file.empty()) return {};
    constexpr std::uintmax_t largest = 64 << 20;
    Result<std::string> text = read_file(file, largest);
    if (!text) return tl::unexpected(text.error());
    if (text->empty()) return input_error("--support-paint {}: is empty", file);
    order.support_paint = std::move(*text);
    order.support_paint_file = file;
    return {};
}

Status slice(SliceOptions& options) {
    if (options.spaced_alone) return input_error("--spacing: needs --copies");
    Status named = check_ending("-o", options.job, "a job", ".zip");
    if (named) named = check_ending("--picture", options.picture, "a picture", ".png");
    if (named) named = check_file_places({options.job, options.picture});
    if (named) named = prepare::check_job_name(options.job, options.order.inputs, options.printer);
    if (named) named = read_paint(options.paint, options.order);
    if (!named) return named;
    auto progress = terminal_progress(options.output);
    const Result<prepare::PrinterFile> printer = with_mask(options.printer);
    if (!printer) return tl::unexpected(printer.error());
    on_signal(OnSignal::leave);  // no output is written while reading and meshing
    const prepare::Order& order = options.order;
    for (const std::string& input : order.inputs) {
        if (lower_extension(input) != ".toml") continue;
        if (Status status = expect(FileKind::robot, input); !status) return status;
    }
    Result<prepare::Drawing> drawing = prepare::read_drawing(order.inputs, order.assignments, *progress);
    if (!drawing) return tl::unexpected(drawing.error());
    on_signal(OnSignal::ask_twice);
    auto made = prepare::slice_job(order, *printer, std::move(*drawing), options.job, *progress);
    if (!made) return tl::unexpected(made.error());
    on_signal(OnSignal::ask);  // the job is there
    Status status;
    if (!options.output.quiet || options.output.json)
        status = add_overcure(options.job, printer->printer, made->plan, *progress);
    if (!status) return status;
    if (!options.picture.empty()) status = draw_picture(options);
    progress.reset();
    if (!status) return status;
    if (options.output.json)
        print_job_json(options, made->manifest, made->plan, made->notes);
    else
        print_job(options, made->manifest, made->plan, made->notes);
    return status;
}

void add_slice_options(CLI::App& command, SliceOptions& options) {
    prepare::Order& order = options.order;
    command
        .add_option("inputs", order.inputs,
                    "a robot file; or any of FILE.3mf, FILE.vtk (regions are materials), MATERIAL=FILE or "
                    "folder or zip of layer images")
        ->required();
    command.add_option("--printer", options.printer, "printer file (TOML)")->required();
    command.add_option("-o,--output", options.job, "job file to write (.zip)")->required();
    command.add_option("--picture", options.picture,
                       "PNG file for a picture: the part from the front, and some layers");
    command.add_option("--layer", order.layer, "layer height, as in \"50 um\" (default: that of the printer file)");
    command.add_option(
        "--least-layer", order.least_layer,
        "adaptive layers: minimum height, where the surface is flat; --layer is the maximum, where it is steep");
    const auto each = [&](const char* name, std::vector<std::string>& values, const char* type, const char* text) {
        command.add_option(name, values, text)->type_name(type)->allow_extra_args(false);
    };
    each("--resin", order.resins, "MATERIAL=RESIN", "resin that a material is printed in");
    command.add_flag("--any-vat", order.any_vat,
                     "fill a resin that no vat of the printer holds into a free vat before the print");
    each("--exposure", order.exposures, "MATERIAL[:FIRST-LAST]=TIME[,BOTTOM]",
         "exposure of a material, and of its bottom layers; or of some layers");
    each("--interlock", order.interlocks, "A+B=PIXELS[,LAYERS]",
         "interlock two materials by teeth PIXELS deep that change sides every LAYERS layers");
    each("--overlap", order.overlaps, "A+B=PIXELS[,LAYERS]",
         "A also exposes B by PIXELS px sideways and LAYERS layers up and down where they meet");
    command.add_option("--least-feature", order.least_feature,
                       "warn of walls and tips narrower than this, as in \"0.3 mm\"");
    command.add_option("--copies", order.copies, "number of copies, side by side");
    command.add_option("--spacing", order.spacing, "distance between copies, as in \"2 mm\"")->capture_default_str();
    command.add_option("--turn", order.turn, "X Y Z: rotation in degrees about each axis, in this order")
        ->expected(3)
        ->allow_extra_args(false);
    command.add_option("--scale", order.scale, "scale factor of the part, 0.001 to 1000")->capture_default_str();
    command.add_option("--at", order.at, "X Y: position of the part's centre, in mm from the centre of the platform")
        ->expected(2)
        ->allow_extra_args(false);
    command.add_flag("--no-anti-alias", order.no_anti_alias, "no anti-aliasing: each pixel is fully lit or dark");
    command.add_option("--threshold", order.threshold, "without anti-aliasing: minimum coverage of a lit pixel")
        ->capture_default_str();
    command.add_option("--support", order.support, "supports in this material under islands and overhangs");
    command.add_option("--support-angle", order.support_angle,
                       "overhang angle in degrees below which undersides are supported (45); 0: islands only");
    command.add_option("--support-spacing", order.support_spacing, "maximum distance between tips (\"3 mm\")");
    command.add_option("--support-tip", order.support_tip, "diameter of a tip where it touches the part (\"0.4 mm\")");
    command.add_option("--support-pillar", order.support_pillar, "diameter of a pillar (\"1 mm\")");
    command.add_option("--support-paint", options.paint,
                       "CSV of supports painted by hand: places where they are enforced or blocked");
    command.add_option("--lift", order.lift, "height of the part above the platform, on supports");
    command.add_option("--raft", order.raft, "thickness of the raft under the supports");
    command.add_option("--hollow", order.hollow, "hollow the part, leaving walls of this thickness, as in \"2 mm\"");
    command.add_option("--drain", order.drain, "diameter of the drain holes of a hollow part");
    each("--set", order.assignments, "KEY=VALUE", "change any key of the robot file");
    add_output_options(command, options.output, true);
}

}  // namespace

void add_slice(CLI::App& app, int& status) {
    auto options = std::make_shared<SliceOptions>();
    CLI::App* command =
        app.add_subcommand("slice", "slice a robot for a printer: layer images, plan and G-code in one job file");
    options->order.version = PLIANT_VERSION;
    add_slice_options(*command, *options);
    command->footer(
        "Example: pliant slice examples/cable_gripper/gripper.toml "
        "--printer examples/printers/tower.toml -o gripper.zip");
    on_call(*command, status, [options, command] {
        options->spaced_alone = command->count("--spacing") > 0 && command->count("--copies") == 0;
        return slice(*options);
    });
}

}  // namespace pliant::app

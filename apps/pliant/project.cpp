// pliant project: the projector alone: displays, test patterns, calibration by measurements.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "printed.hpp"
#include "printing/host/projector_patterns.hpp"
#include "printing/job/png.hpp"
#include "printing/machine/printer.hpp"
#include "printing/screen/projector.hpp"

namespace pliant::app {
namespace {

struct ProjectOptions {
    std::string where = "0";
    std::string printer, pattern, image, readings, save;
    std::vector<double> measured_mm;
    std::vector<int> size_px, points = {5, 3};
    int square_px = 1;
    double seconds = 0;  ///< 0: not given, until Ctrl-C
    double gamma = 1;
    bool list = false, release = false;
    Output output;
};

struct Setting {
    std::optional<machine::Printer> printer;
    host::PatternOptions pattern;
};

/// Size and scale from the printer file, or as given.
Result<Setting> read_setting(const ProjectOptions& options) {
    Setting setting;
    if (!options.printer.empty()) {
        Result<machine::Printer> printer = read_printer(options.printer);
        if (!printer) return tl::unexpected(printer.error());
        setting.printer = std::move(*printer);
        const machine::Projector& p = setting.printer->projector;
        setting.pattern.width_px = p.width_px;
        setting.pattern.height_px = p.height_px;
        setting.pattern.pixel_um = p.pixel_um;
    } else if (options.size_px.size() == 2) {
        setting.pattern.width_px = options.size_px[0];
        setting.pattern.height_px = options.size_px[1];
    }
    setting.pattern.square_px = options.square_px;
    setting.pattern.columns = options.points[0];
    setting.pattern.rows = options.points[1];
    return setting;
}

Status list_displays(const Output& output) {
    const auto displays = host::list_displays();
    if (!displays) return tl::unexpected(displays.error());
    if (output.json) {
        nlohmann::json list = nlohmann::json::array();
        for (const host::PanelInfo& d : *displays)
            list.push_back({{"number", d.number},
                            {"name", d.name},
                            {"width_px", d.width_px},
                            {"height_px", d.height_px},
                            {"refresh_hz", d.refresh_hz}});
        print_json(nlohmann::json{{"displays", list}});
        return {};
    }
    for (const host::PanelInfo& d : *displays) {
        const std::string rate = d.refresh_hz > 0 ? fmt::format("{:g} Hz", d.refresh_hz) : "unknown refresh rate";
        fmt::print("display {}: {} x {} px, {}, {}\n", d.number, d.width_px, d.height_px, rate, d.name);
    }
    return {};
}

Status release(const ProjectOptions& options) {
    const std::optional<int> display = host::display_number(options.where);
    if (!display)
        return input_error("--release: \"{}\" is not a display; displays are numbers (--list)", options.where);
    const Result<bool> released = host::release_display(*display);
    if (!released) return tl::unexpected(released.error());
    if (options.output.json && options.pattern.empty() && options.image.empty())
        print_json(nlohmann::json{{"released", *released}});
    else if (!options.output.quiet && !options.output.json)
        fmt::print("{}\n", *released ? "released" : "it was not held");
    return {};
}

/// Converts measured distances to the printer file's pixel size.
Status calibrate_size(const ProjectOptions& options, const Setting& setting) {
    const auto& p = setting.pattern;
    if (p.width_px == 0) return input_error("--measured: give --printer, or --size");
    const auto size = host::pixel_size(p.width_px, p.height_px, options.measured_mm[0], options.measured_mm[1]);
    if (!size) return tl::unexpected(size.error());
    if (options.output.json) {
        print_json(nlohmann::json{{"x_um", size->x_um},
                                  {"y_um", size->y_um},
                                  {"pixel_um", size->pixel_um},
                                  {"off_percent", size->off_percent}});
        return {};
    }
    fmt::print("x {:.3f} um, y {:.3f} um per pixel: they differ by {:.2f} %\n", size->x_um, size->y_um,
               size->off_percent);
    if (p.pixel_um > 0)
        fmt::print("the printer file says {:.3f} um: parts come out {:+.2f} % in size\n", p.pixel_um,
                   100 * (size->pixel_um / p.pixel_um - 1));
    fmt::print("set in its [projector]:\npixel = \"{:.3f} um\"\n", size->pixel_um);
    constexpr double far_off = 0.2;  // of the size in the printer file
    if (p.pixel_um > 0 && std::abs(size->pixel_um / p.pixel_um - 1) > far_off)
        fmt::print(stderr, "warning: that is far from the printer file's {:.3f} um; are the distances in mm?\n",
                   p.pixel_um);
    if (std::abs(size->off_percent) > 0.2)
        fmt::print(stderr, "warning: pixels are not square to 0.2 %: square the projector to the vat floor first\n");
    return {};
}

Status make_mask(const ProjectOptions& options, const Setting& setting) {
    const auto& p = setting.pattern;
    if (p.width_px == 0) return input_error("--mask-from: give --printer, or --size");
    if (options.save.empty()) return input_error("--mask-from: give -o, the file for the mask (.png)");
    if (!(options.gamma >= 0.2 && options.gamma <= 5))
        return input_error("--gamma {:g}: must be 0.2 to 5", options.gamma);
    const Result<std::string> text = read_file(options.readings, 1 << 20);
    if (!text) return tl::unexpected(text.error());
    const auto table = host::parse_light_table(*text, options.readings);
    if (!table) return tl::unexpected(table.error());
    const host::LightMask mask = host::light_mask(*table, p.width_px, p.height_px, options.gamma);
    if (Status status = write_file(options.save, job::encode_png(mask.mask)); !status) return status;
    if (options.output.json) {
        print_json(nlohmann::json{{"mask", options.save}, {"least_share", mask.least}});
        return {};
    }
    fmt::print("{}: {} x {} px; every pixel gets {:.1f} % of the light at the brightest point\n", options.save,
               p.width_px, p.height_px, 100 * mask.least);
    fmt::print("put it next to the printer file, and set in its [projector]:\nmask = \"{}\"\n",
               std::filesystem::path(options.save).filename().string());
    return {};
}

Result<job::Image> read_image(const std::string& file) {
    const Result<std::string> bytes = read_file(file, std::uintmax_t{1} << 30);
    if (!bytes) return tl::unexpected(bytes.error());
    const auto size = job::any_png_size(*bytes, file);
    if (!size) return tl::unexpected(size.error());
    return job::decode_any_png(*bytes, *size, file);
}

Result<job::Image> wanted_image(const ProjectOptions& options, const host::PatternOptions& pattern) {
    if (!options.image.empty()) return read_image(options.image);
    return host::test_pattern(options.pattern, pattern);
}

/// Runs until the time is over or Ctrl-C is pressed. The projector itself ends an exposure of limited time.
Status light(const ProjectOptions& options, Setting setting) {
    host::ScreenOptions screen;
    screen.width_px = setting.pattern.width_px;
    screen.height_px = setting.pattern.height_px;
    if (setting.printer) screen.longest_light_s = setting.printer->limits.exposure_s;
    if (options.seconds == 0) screen.longest_light_s = 86400;
    auto projector = host::ScreenProjector::open(options.where, screen);
    if (!projector) return tl::unexpected(projector.error());
    const host::PanelInfo& panel = projector->panel();
    setting.pattern.width_px = panel.width_px;
    setting.pattern.height_px = panel.height_px;
    const Result<job::Image> image = wanted_image(options, setting.pattern);
    if (!image) return tl::unexpected(image.error());
    const auto progress = terminal_progress(options.output);
    const Status lit = options.seconds > 0 ? projector->show_for(*image, options.seconds) : projector->show(*image);
    if (!lit) return lit;
    if (!options.output.quiet && !options.output.json)
        fmt::print("{} x {} px at {:g} Hz ({}), {}; Ctrl-C turns it black\n", panel.width_px, panel.height_px,
                   panel.refresh_hz, panel.name,
                   options.seconds > 0 ? fmt::format("{:g} s", std::min(options.seconds, screen.longest_light_s))
                                       : "until ended");
    std::fflush(stdout);
    const auto begin = std::chrono::steady_clock::now();
    const auto end = begin + std::chrono::duration<double>(
                                 std::min(options.seconds > 0 ? options.seconds : 86400, screen.longest_light_s));
    while (!progress->cancelled() && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (progress->cancelled()) {
        if (Status status = projector->black(); !status) return status;
    } else if (const auto finished = projector->finish(); !finished) {
        return tl::unexpected(finished.error());
    }
    const auto& measured = projector->last_light();
    if (options.output.json && measured)
        print_json(nlohmann::json{
            {"on_s", measured->on_s}, {"frames", measured->frames}, {"longest_frame_s", measured->longest_frame_s}});
    else if (!options.output.quiet && measured)
        fmt::print("on for {:.4f} s, {} frames, the longest {:.1f} ms\n", measured->on_s, measured->frames,
                   1000 * measured->longest_frame_s);
    return {};
}

Status save_pattern(const ProjectOptions& options, const Setting& setting) {
    if (setting.pattern.width_px == 0) return input_error("-o: give --printer, or --size");
    const Result<job::Image> image = wanted_image(options, setting.pattern);
    if (!image) return tl::unexpected(image.error());
    return write_file(options.save, job::encode_png(*image));
}

Status run_project(const ProjectOptions& options, bool given_seconds) {
    if (options.list) return list_displays(options.output);
    if (options.release && options.pattern.empty() && options.image.empty()) return release(options);
    if (given_seconds && !(options.seconds > 0 && options.seconds <= 86400))
        return input_error("--seconds {:g}: must be above 0, at most a day", options.seconds);
    const Result<Setting> setting = read_setting(options);
    if (!setting) return tl::unexpected(setting.error());
    if (!options.measured_mm.empty()) return calibrate_size(options, *setting);
    if (!options.readings.empty()) return make_mask(options, *setting);
    if (options.pattern.empty() == options.image.empty())
        return input_error("give --pattern or --image (or --list, --release, --measured, --mask-from)");
    if (!options.save.empty()) return save_pattern(options, *setting);
    Status status = light(options, *setting);
    if (options.release && status) status = release(options);
    return status;
}

}  // namespace

void add_project(CLI::App& app, int& status) {
    auto options = std::make_shared<ProjectOptions>();
    CLI::App* command =
        app.add_subcommand("project", "show test patterns and images on the projector, and calibrate it");
    command->add_option("projector", options->where, "number of a display (0), or a folder for the images");
    command->add_flag("--list", options->list, "list the displays");
    command->add_option("--printer", options->printer, "printer file; the display must have its resolution");
    command->add_option("--size", options->size_px, "WIDTH HEIGHT in pixels, in place of a printer file")
        ->expected(2)
        ->allow_extra_args(false);
    command->add_option("--pattern", options->pattern, "white, black, checkerboard, grid, border, ramp or points");
    command->add_option("--square", options->square_px, "pixels per square of the checkerboard; 1 if not given");
    command->add_option("--points", options->points, "COLUMNS ROWS of the pattern points; 5 3 if not given")
        ->expected(2)
        ->allow_extra_args(false);
    command->add_option("--image", options->image, "image file (.png) in the resolution of the display");
    const CLI::Option* seconds =
        command->add_option("--seconds", options->seconds, "duration; until Ctrl-C if not given");
    command->add_flag("--release", options->release, "release the display, which otherwise stays black");
    command
        ->add_option("--measured", options->measured_mm,
                     "X Y: measured width and height of the rectangle in pattern border, in mm")
        ->expected(2)
        ->allow_extra_args(false);
    command->add_option("--mask-from", options->readings, "table of light readings, to make a mask from");
    command->add_option("--gamma", options->gamma, "gamma of the projector, for the mask; 1 if not given");
    command->add_option("-o,--output", options->save, "write the pattern or the mask to a file (.png)");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant project 1 --printer examples/printers/tower.toml --pattern grid");
    on_call(*command, status, [options, seconds] { return run_project(*options, seconds->count() > 0); });
}

}  // namespace pliant::app

// The job of halves.hpp as a file, for tests that print it with the program itself.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "base/core/files.hpp"
#include "halves.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::app {

struct SmallJob {
    std::string printer_text;
    machine::Printer printer;  ///< with a projector of a few pixels
    job::Manifest manifest;
    std::filesystem::path file;
};

/// Replaces the value of the line in `table` that begins with `key = `. Errors: there is no such line.
inline Status set_key(std::string& text, const std::string& table, const std::string& key, const std::string& value) {
    const std::size_t begin = text.find("\n[" + table + "]"), at = text.find("\n" + key + " = ", begin);
    if (begin == std::string::npos || at == std::string::npos)
        return input_error("the printer file has changed: no {} in [{}]", key, table);
    text.replace(at, text.find('\n', at + 1) - at, "\n" + key + " = " + value);
    return {};
}

/// Writes FOLDER/halves.zip for the machine with the printer file `text`. `look.soft_resin` and `look.rigid_resin` must
/// be resins of it.
inline Result<SmallJob> write_small_job(const std::filesystem::path& folder, std::string text,
                                        const halves::Look& look) {
    Status fits = set_key(text, "projector", "width", std::to_string(halves::width_px));
    if (fits) fits = set_key(text, "projector", "height", std::to_string(halves::height_px));
    if (fits) fits = set_key(text, "projector", "pixel", fmt::format("\"{} um\"", halves::pixel_um));
    if (!fits) return tl::unexpected(fits.error());
    auto printer = machine::parse_printer(text, "printer.toml");
    if (!printer) return tl::unexpected(printer.error());
    SmallJob made{text, std::move(*printer), halves::job(look), folder / "halves.zip"};
    auto writer = job::Writer::create(made.file);
    if (!writer) return tl::unexpected(writer.error());
    for (std::size_t layer = 0; layer < made.manifest.layers.size(); ++layer) {
        for (const job::LayerImage& image : made.manifest.layers[layer].images) {
            const auto shown = halves::image(static_cast<int>(layer), image.material);
            if (Status added = writer->add_image(image.file, *shown); !added) return tl::unexpected(added.error());
        }
    }
    const auto plan = plan::make_plan(made.manifest, made.printer);
    if (!plan) return tl::unexpected(plan.error());
    Status done = writer->add_file("printer.toml", text);
    if (done) done = writer->add_file("job.gcode", plan::write_gcode(*plan, made.manifest, made.printer));
    if (done) done = writer->finish(made.manifest);
    if (!done) return tl::unexpected(done.error());
    return made;
}

}  // namespace pliant::app

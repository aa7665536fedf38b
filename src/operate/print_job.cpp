#include "operate/print_job.hpp"

#include <fmt/format.h>

#include "core/files.hpp"

namespace pliant::operate {
namespace {

std::vector<host::Refill> refills_of(const plan::Plan& plan) {
    std::vector<host::Refill> refills;
    for (const plan::RefillBefore& refill : plan.refills) {
        refills.push_back({refill.layer, fmt::format("refill the vat of slot {} with {}", refill.slot, refill.resin)});
    }
    return refills;
}

}  // namespace

Result<ReadyJob> load_job(const std::filesystem::path& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    Result<job::Archive> opened = job::Archive::open(path);
    if (!opened) return tl::unexpected(opened.error());
    auto archive = std::make_shared<job::Archive>(std::move(*opened));
    const Result<std::string> text = archive->file("printer.toml");
    if (!text) return input_error("{}: {}; slice the robot again with --printer", path.string(), text.error().message);
    const Result<machine::Printer> printer = machine::parse_printer(*text, path / "printer.toml");
    if (!printer) return tl::unexpected(printer.error());
    Result<std::string> gcode = archive->file("job.gcode");
    if (!gcode) return tl::unexpected(gcode.error());
    const job::Manifest& manifest = archive->manifest();
    Result<plan::Plan> plan = plan::make_plan(manifest, *printer);
    if (!plan) return tl::unexpected(plan.error());

    host::PrintJob job;
    job.name = manifest.name;
    job.digest = host::job_digest(*bytes);
    job.gcode = std::move(*gcode);
    job.images = [archive](int layer, int material) { return image_of(*archive, layer, material); };
    for (const job::Material& material : manifest.materials) job.materials.push_back(material.name);
    job.layers = static_cast<int>(manifest.layers.size());
    job.refills = refills_of(*plan);
    job.journal = path.string() + ".journal";
    machine::Printer filled = plan::filled_printer(*plan, manifest, *printer);
    return ReadyJob{std::move(archive), std::move(filled), std::move(*plan), std::move(job)};
}

Result<job::Image> image_of(const job::Archive& archive, int layer, int material) {
    const auto& layers = archive.manifest().layers;
    if (layer >= 0 && layer < static_cast<int>(layers.size())) {
        for (const job::LayerImage& image : layers[static_cast<std::size_t>(layer)].images) {
            if (image.material == material) return archive.image(image.file);
        }
    }
    return input_error("layer {} has no image of material {}", layer, material);
}

}  // namespace pliant::operate

#include "operate/print_job.hpp"

#include <fmt/format.h>

#include "core/files.hpp"
#include "operate/job_file.hpp"

namespace pliant::operate {
namespace {

std::vector<host::Refill> refills_of(const plan::Plan& plan) {
    std::vector<host::Refill> refills;
    for (const plan::RefillBefore& refill : plan.refills) {
        refills.push_back(
            {refill.layer, refill.slot, fmt::format("refill the vat of slot {} with {}", refill.slot, refill.resin)});
    }
    return refills;
}

}  // namespace

Result<ReadyJob> load_job(const std::filesystem::path& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    Result<OpenJob> open = open_job(path);
    if (!open) return tl::unexpected(open.error());
    const machine::Printer& printer = open->printer;
    auto archive = std::make_shared<job::Archive>(std::move(open->archive));
    Result<std::string> gcode = archive->file("job.gcode");
    if (!gcode) return tl::unexpected(gcode.error());
    const job::Manifest& manifest = archive->manifest();
    Result<plan::Plan> plan = plan::make_plan(manifest, printer);
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
    machine::Printer filled = plan::filled_printer(*plan, manifest, printer);
    return ReadyJob{std::move(archive), std::move(filled), std::move(*plan), std::move(job)};
}

}  // namespace pliant::operate

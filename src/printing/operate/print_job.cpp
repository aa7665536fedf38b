#include "printing/operate/print_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/core/files.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/proved_job.hpp"

namespace pliant::operate {
namespace {

/// Operator tasks before layers. The host prompts once per layer: all tasks there are combined into one text.
std::vector<host::Refill> refills_of(const plan::Plan& plan) {
    std::vector<host::Refill> refills;
    for (const plan::RefillBefore& refill : plan.refills) {
        refills.push_back(
            {refill.layer, refill.slot, fmt::format("refill the vat of slot {} with {}", refill.slot, refill.resin)});
    }
    for (const plan::CareBefore& care : plan.solution.care) {
        if (care.layer > 0) refills.push_back({care.layer, 0, std::string(machine::care_text(care.care)), care.care});
    }
    std::stable_sort(refills.begin(), refills.end(), [](auto& a, auto& b) { return a.layer < b.layer; });
    std::map<int, std::string> texts;
    for (const host::Refill& refill : refills) {
        std::string& text = texts[refill.layer];
        text += (text.empty() ? "" : "; ") + refill.text;
    }
    for (host::Refill& refill : refills) refill.text = texts[refill.layer];
    return refills;
}

}  // namespace

Result<ReadyJob> load_job(const std::filesystem::path& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    Result<ProvedJob> proved = prove_job(path);
    if (!proved) return tl::unexpected(proved.error());
    auto archive = std::make_shared<job::Archive>(std::move(proved->archive));
    const job::Manifest& manifest = archive->manifest();

    host::PrintJob job;
    job.name = manifest.name;
    job.digest = host::job_digest(*bytes);
    job.gcode = std::move(proved->gcode);
    job.images = [archive](int layer, int material) { return image_of(*archive, layer, material); };
    for (const job::Material& material : manifest.materials) {
        job.materials.push_back(material.name);
        job.exposures_s.push_back(material.exposure_s);
    }
    job.layers = static_cast<int>(manifest.layers.size());
    job.refills = refills_of(proved->plan);
    for (const std::string& line : plan::vat_lines(proved->plan)) job.vats += (job.vats.empty() ? "" : "; ") + line;
    job.journal = path.string() + ".journal";
    machine::Printer filled = plan::filled_printer(proved->plan, manifest, std::move(proved->printer));
    return ReadyJob{std::move(archive), std::move(filled), std::move(proved->plan), std::move(job),
                    std::move(proved->warnings)};
}

}  // namespace pliant::operate

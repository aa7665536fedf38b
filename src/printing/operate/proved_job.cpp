#include "printing/operate/proved_job.hpp"

#include <algorithm>
#include <utility>

#include "base/core/text.hpp"
#include "printing/job/verify.hpp"
#include "printing/machine/image_room.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/plan/proof.hpp"

namespace pliant::operate {
namespace {

/// Reading an entry verifies its hash.
Status check_fingerprints(const job::Archive& archive, Progress& progress) {
    const auto& all = archive.manifest().sha256;
    double read = 0;
    for (const auto& [file, hash] : all) {
        progress.advance("fingerprints", read++ / static_cast<double>(all.size()));
        if (progress.cancelled()) return cancelled();
        if (const auto bytes = archive.file(file); !bytes) return tl::unexpected(bytes.error());
    }
    return {};
}

Status check_pixels(const OpenJob& job, const std::string& path, Progress& progress) {
    const machine::Projector& projector = job.printer.projector;
    const bool corrected = !projector.grey.empty() || !projector.mask.empty();
    const job::PlatformEdge edge = machine::platform_edge(job.printer);
    return job::verify_images(job.archive, corrected, path, &edge, &progress);
}

}  // namespace

Result<ProvedJob> prove_job(const std::filesystem::path& path, Pixels pixels, const machine::Printer* other,
                            Progress* progress) {
    Progress silent;
    Progress& told = progress != nullptr ? *progress : silent;
    const std::string where = path.string();
    Result<OpenJob> open = open_job(path);
    if (!open) return tl::unexpected(open.error());
    const job::Manifest& manifest = open->archive.manifest();
    if (std::all_of(manifest.layers.begin(), manifest.layers.end(), [](auto& layer) { return layer.images.empty(); }))
        return input_error("{}: the job prints nothing: none of its layers has an image", where);
    const bool sealed = !manifest.sha256.empty();
    if (Status status = check_fingerprints(open->archive, told); !status) return tl::unexpected(status.error());
    if (const auto mask = mask_of(open->archive, open->printer.projector); !mask) return tl::unexpected(mask.error());
    if (other != nullptr) {
        const std::vector<std::string> keys = machine::other_images(open->printer.projector, other->projector);
        if (!keys.empty())
            return input_error("{}: was sliced for another {} of the projector; slice it again for {}", where,
                               join_names(keys), other->name);
        open->printer = *other;
    }
    Result<std::string> gcode = open->archive.file("job.gcode");
    if (!gcode) return tl::unexpected(gcode.error());
    Result<plan::Plan> plan = plan::make_plan(manifest, open->printer);
    if (!plan) return input_error("{}: {}", where, plan.error().message);
    if (Status status = plan::prove_program(*gcode, *plan, manifest, open->printer); !status)
        return input_error("{}: {}", where, status.error().message);
    if (!sealed || pixels == Pixels::areas) {
        if (Status status = check_pixels(*open, where, told); !status) return tl::unexpected(status.error());
    }
    ProvedJob proved{std::move(open->archive), std::move(open->printer), std::move(*plan), std::move(*gcode), {}};
    if (!sealed)
        proved.warnings.push_back(
            "the job has no fingerprints (format 1, of an older Pliant): that nobody has changed it since it was "
            "sliced cannot be proved; slice it again");
    return proved;
}

}  // namespace pliant::operate

// A job archive with the machine that it was made for.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::operate {

struct OpenJob {
    job::Archive archive;
    machine::Printer printer;  ///< from the job's own printer.toml
};

/// The projector's mask, from a file beside the printer file `printer_path`; nullopt if the printer has none.
[[nodiscard]] Result<std::optional<job::Image>> load_mask(const machine::Projector& projector,
                                                          const std::filesystem::path& printer_path);
/// The same from the job. Errors: the job has none although its printer names one.
[[nodiscard]] Result<std::optional<job::Image>> mask_of(const job::Archive& archive,
                                                        const machine::Projector& projector);

[[nodiscard]] Result<OpenJob> open_job(const std::filesystem::path& path);

/// The image of a layer and a material (indices into the manifest).
[[nodiscard]] Result<job::Image> image_of(const job::Archive& archive, int layer, int material);
/// The same into an image that is there, whose memory is used again: for many layers.
[[nodiscard]] Status image_of(const job::Archive& archive, int layer, int material, job::Image& into);

}  // namespace pliant::operate

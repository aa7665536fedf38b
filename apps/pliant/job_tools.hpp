// What slice, plan and print share: a job archive with the machine it was made for.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/error.hpp"
#include "job/job.hpp"
#include "machine/printer.hpp"

namespace pliant::app {

struct OpenJob {
    job::Archive archive;
    machine::Printer printer;  ///< from the job's own printer.toml
};

/// What a job calls the projector's mask, whatever its name beside the printer file.
inline constexpr const char* mask_entry = "mask.png";

/// The mask that the projector names, beside the printer file `printer_path`; nullopt where it names none.
[[nodiscard]] Result<std::optional<job::Image>> load_mask(const machine::Projector& projector,
                                                          const std::filesystem::path& printer_path);
/// The same from the job. Errors: the job has none though its printer names one.
[[nodiscard]] Result<std::optional<job::Image>> mask_of(const OpenJob& job);

[[nodiscard]] Result<OpenJob> open_job(const std::filesystem::path& path);

/// The image of a layer and a material (indices into the manifest).
[[nodiscard]] Result<job::Image> image_of(const job::Archive& archive, int layer, int material);

}  // namespace pliant::app

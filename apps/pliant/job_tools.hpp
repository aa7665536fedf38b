// What slice, plan and print share: a job archive with the machine it was made for.
#pragma once

#include <filesystem>
#include <string>

#include "core/error.hpp"
#include "job/job.hpp"
#include "machine/printer.hpp"

namespace pliant::app {

struct OpenJob {
    job::Archive archive;
    machine::Printer printer;  ///< from the job's own printer.toml
};

[[nodiscard]] Result<OpenJob> open_job(const std::filesystem::path& path);

/// The image of a layer and a material (indices into the manifest).
[[nodiscard]] Result<job::Image> image_of(const job::Archive& archive, int layer, int material);

}  // namespace pliant::app

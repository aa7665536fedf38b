// Exports a job's images in other programs' formats: one stack per material, with every layer present.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "printing/job/job.hpp"

namespace pliant::job {

enum class Format {
    sl1,      ///< config.ini, prusaslicer.ini and NAME00000.png: one zip file per material
    nanodlp,  ///< 1.png, ..., plate.json and others: one zip file per material
    zip,      ///< 1.png, 2.png, ...: one zip file per material
    vats      ///< one folder with subfolders vat_a, vat_b, ...: vata_layer_0000.png, ...
};

/// "sl1", "nanodlp", "zip" or "vats"; the error lists them.
[[nodiscard]] Result<Format> format_from(const std::string& name);

/// What the format cannot say about this job, a line for each material: exposures.
[[nodiscard]] std::vector<std::string> exposure_notes(const Manifest& manifest, Format format);

/// That the layers differ in height, if the format does not say so; "": it has nothing to say.
[[nodiscard]] std::string height_note(const Manifest& manifest, Format format);

/// Writes into `folder`, which is created if missing: NAME_MATERIAL.sl1, .nanodlp or .zip for each material; `vats`
/// instead replaces `folder` itself by the vat folders (only if it is empty or an earlier export). Returns the files
/// written. Equal jobs give equal bytes. Errors: the job's images, more than 26 materials (vats), the disk,
/// cancellation; then no file is partial, and those of earlier materials stay.
[[nodiscard]] Result<std::vector<std::filesystem::path>> export_job(const Archive& archive, Format format,
                                                                    const std::filesystem::path& folder,
                                                                    Progress& progress);

}  // namespace pliant::job

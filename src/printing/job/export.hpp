// A job's images as other programs take them: one stack per material, with every layer present.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "printing/job/job.hpp"

namespace pliant::job {

enum class Format {
    sl1,      ///< config.ini, prusaslicer.ini and NAME00000.png: one zip file per material
    nanodlp,  ///< 1.png, ..., plate.json and others: one zip file per material
    zip,      ///< 1.png, 2.png, ...: one zip file per material
    vats      ///< one folder with folders vat_a, vat_b, ...: vata_layer_0000.png, ...
};

/// "sl1", "nanodlp", "zip" or "vats"; the error lists them.
[[nodiscard]] Result<Format> format_from(const std::string& name);

/// Writes into `folder`, which is made if it is not there: NAME_MATERIAL.sl1, .nanodlp or .zip for each material, or
/// the folders of its vats in place of `folder` itself (replaced only if it is empty or was exported before). Returns
/// what was written. Equal jobs give equal bytes. Errors: the job's images, more than 26 materials (vats), the disk.
[[nodiscard]] Result<std::vector<std::filesystem::path>> export_job(const Archive& archive, Format format,
                                                                    const std::filesystem::path& folder);

}  // namespace pliant::job

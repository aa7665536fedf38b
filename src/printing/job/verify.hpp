// The check that opening a job leaves out: its pixels.
#pragma once

#include "base/core/progress.hpp"
#include "printing/job/job.hpp"
#include "printing/job/platform_edge.hpp"

namespace pliant::job {

/// Decodes every image. Its area must be the manifest's, unless `corrected` says that images hold greys calibrated for
/// a projector; and no two images of a layer may light the same pixel, except for the shared area in the manifest,
/// or anything beside the platform, if its `edge` is given (else null).
/// `progress`, if not null, is told about layers, and can cancel. Errors name archive, layer and image.
[[nodiscard]] Status verify_images(const Archive& archive, bool corrected, const std::string& path,
                                   const PlatformEdge* edge = nullptr, Progress* progress = nullptr);

}  // namespace pliant::job

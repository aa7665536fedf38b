// Findings of the checks as manifest entries, each with a small picture.
#pragma once

#include <functional>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/slice/inspect.hpp"
#include "printing/slice/thin.hpp"

namespace pliant::job {

/// Maximum number of each kind, the largest first.
inline constexpr std::size_t most_findings = 20;

/// Islands, traps, cups and thin features, largest first within each kind.
[[nodiscard]] std::vector<Finding> listed(const slice::Findings& findings, const std::vector<slice::ThinSpot>& thin,
                                          const slice::Raster& raster);

/// A square of 240 pixels around the finding (smaller if the image is): the layer below dark grey, the finding's first
/// layer light grey, the connected component of the finding (solid or void) white.
[[nodiscard]] EncodedImage picture(const Finding& finding, const slice::ComposedLayer& layer,
                                   const slice::ComposedLayer& below, const slice::Raster& raster);

/// Adds a picture of each finding to `writer` as findings/00_island.png and so on. `layer` returns a layer again.
[[nodiscard]] Status add_pictures(std::vector<Finding>& findings, const slice::Raster& raster,
                                  const std::function<Result<slice::ComposedLayer>(int)>& layer, Writer& writer);

}  // namespace pliant::job

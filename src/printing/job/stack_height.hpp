// How high the layers of other programs' image stacks are.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::job {

/// The text of a file that stands beside the images, by its name.
using SideText = std::function<Result<std::string>(const std::string&)>;

/// The layer height, in micrometres, that the files beside the images of a stack give: of .sl1 (config.ini,
/// prusaslicer.ini), NanoDLP (slicer.json, profile.json), both kinds of .cws (slice.conf, NAME.slicing) and UVtools
/// (manifest.uvtools). nullopt: none of them is there or names one. Errors, which name file and key: a height that is
/// no number above 0 and below 10 mm, slices of several heights, `text`'s.
[[nodiscard]] Result<std::optional<double>> stated_layer_um(const std::vector<std::string>& names,
                                                            const SideText& text);

}  // namespace pliant::job

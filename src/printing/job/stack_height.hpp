// Layer height and pixel size of image stacks from other programs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::job {

/// Returns the text of a file beside the images, by name.
using SideText = std::function<Result<std::string>(const std::string&)>;

/// The layer height, in micrometres, from the files beside the images of a stack: .sl1 (config.ini, prusaslicer.ini),
/// NanoDLP (slicer.json, profile.json), both kinds of .cws (slice.conf, NAME.slicing) and UVtools (manifest.uvtools).
/// nullopt: none of them exists or gives one. Errors, which name file and key: a height that is not a number between 0
/// and 10 mm, slices of several heights, those of `text`.
[[nodiscard]] Result<std::optional<double>> stated_layer_um(const std::vector<std::string>& names,
                                                            const SideText& text);

/// The height of the first layer where the files give one of its own: initial_layer_height of prusaslicer.ini. nullopt:
/// they do not. Errors as above.
[[nodiscard]] Result<std::optional<double>> stated_first_layer_um(const std::vector<std::string>& names,
                                                                  const SideText& text);

/// Edges of a pixel, in micrometres.
struct PixelSize {
    double x_um = 0, y_um = 0;
};

/// The size of a pixel, from the size of the display and its pixels in the same files: prusaslicer.ini, slicer.json,
/// NAME.slicing, manifest.uvtools. nullopt: none of them says. Errors: those of `text`.
[[nodiscard]] Result<std::optional<PixelSize>> stated_pixel(const std::vector<std::string>& names,
                                                            const SideText& text);

}  // namespace pliant::job

// The metadata files beside the images in other programs' formats.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "printing/job/image_areas.hpp"
#include "printing/job/job.hpp"

namespace pliant::job {

using NamedText = std::pair<std::string, std::string>;  ///< entry and content

/// Exposures and areas of the images of one material.
struct StackFacts {
    const Manifest& manifest;
    int material = 0;
    std::string image_prefix;      ///< prefix of the image names
    std::vector<double> area_mm2;  ///< per layer
    double layer_um = 0;           ///< of the lowest layer
    std::vector<double> light_s;   ///< per layer; for a dark one the material's default

    [[nodiscard]] const Material& of() const { return manifest.materials[static_cast<std::size_t>(material)]; }
    [[nodiscard]] double volume_mm3() const;
    /// Of the first layer, for which an .sl1 file has its own exposure.
    [[nodiscard]] double first_light_s() const;
    /// Layers above the bottom ones whose exposure is between theirs and that of the rest. If the part ends before the
    /// fade does, the number that it would have.
    [[nodiscard]] int fading_layers() const;
};

/// From the material's images and the job's layers.
[[nodiscard]] StackFacts facts_of(const Manifest& manifest, int material, const std::string& image_prefix);

/// Per layer, what an .sl1 file says: the exposure of the first layer, falling to that of all others over the fading
/// layers that follow it.
[[nodiscard]] std::vector<double> sl1_lights_s(const StackFacts& stack);
/// What a .nanodlp file says: the exposure of the bottom layers, falling to that of all others over the fading layers.
[[nodiscard]] std::vector<double> nanodlp_lights_s(const StackFacts& stack);
/// Lit layers whose exposure is not what a file says.
[[nodiscard]] int layers_of_other_light(const StackFacts& stack, const std::vector<double>& said_s);

[[nodiscard]] std::vector<NamedText> sl1_texts(const StackFacts& stack);
/// `areas`: per layer image.
[[nodiscard]] std::vector<NamedText> nanodlp_texts(const StackFacts& stack, const std::vector<ImageAreas>& areas);
/// The files that UVtools reads beside a zip file's images. Precondition: layers of equal height.
[[nodiscard]] std::vector<NamedText> zip_texts(const StackFacts& stack);

}  // namespace pliant::job

// The files beside the images in other programs' formats.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "printing/job/image_areas.hpp"
#include "printing/job/job.hpp"

namespace pliant::job {

using NamedText = std::pair<std::string, std::string>;  ///< entry and content

/// What the images of one material light up.
struct StackFacts {
    const Manifest& manifest;
    int material = 0;
    std::string image_prefix;      ///< of the images' names
    std::vector<double> area_mm2;  ///< per layer
    double layer_um = 0;           ///< of the lowest layer
    std::vector<double> light_s;   ///< per layer; of a dark one what its material says

    [[nodiscard]] const Material& of() const { return manifest.materials[static_cast<std::size_t>(material)]; }
    [[nodiscard]] double volume_mm3() const;
    /// Of the first layer, which every format has an exposure for.
    [[nodiscard]] double first_light_s() const;
    /// Layers above the bottom ones whose light lies between that of the first and that of all others.
    [[nodiscard]] int fading_layers() const;
};

/// Of the material's images and the job's layers.
[[nodiscard]] StackFacts facts_of(const Manifest& manifest, int material, const std::string& image_prefix);

[[nodiscard]] std::vector<NamedText> sl1_texts(const StackFacts& stack);
/// `areas`: of every layer's image.
[[nodiscard]] std::vector<NamedText> nanodlp_texts(const StackFacts& stack, const std::vector<ImageAreas>& areas);
/// What UVtools reads beside a zip file's images. Precondition: layers of one height.
[[nodiscard]] std::vector<NamedText> zip_texts(const StackFacts& stack);

}  // namespace pliant::job

// The files beside the images in other programs' formats.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "job/job.hpp"

namespace pliant::job {

using NamedText = std::pair<std::string, std::string>;  ///< entry and content

/// What the images of one material light up.
struct StackFacts {
    const Manifest& manifest;
    int material = 0;
    std::string image_prefix;      ///< of the images' names
    std::vector<double> area_mm2;  ///< per layer
    double layer_um = 0;           ///< of the lowest layer

    [[nodiscard]] double total_area_mm2() const;
    [[nodiscard]] double volume_mm3() const;
};

[[nodiscard]] std::vector<NamedText> sl1_texts(const StackFacts& stack);
[[nodiscard]] std::vector<NamedText> nanodlp_texts(const StackFacts& stack);

}  // namespace pliant::job

// How long each layer of a material is lit.
#pragma once

#include <string>
#include <vector>

#include "printing/job/job.hpp"

namespace pliant::job {

/// Seconds that somebody asked for, for layers [first, last].
struct ExposureSpan {
    int first = 0, last = 0;
    double seconds = 0;

    bool operator==(const ExposureSpan&) const = default;
};

/// From a material's exposures to those of its layers. `bottom_layers` from the platform get the bottom exposure, the
/// `transition_layers` above them evenly less, all others the exposure. Where `penetration_um` (Dp of Jacobs' working
/// curve) is known, an exposure is meant for a layer of `layer_um`: one of h gets exp((h - layer_um) / Dp) times as
/// much, so that it cures as much deeper as it is thicker. Spans come last and are taken as they are.
struct ExposureRule {
    int bottom_layers = 0;
    int transition_layers = 0;
    double penetration_um = 0;  ///< 0: the same light for all thicknesses
    int layer_um = 50;
    std::vector<ExposureSpan> spans{};

    bool operator==(const ExposureRule&) const = default;
};

/// Refuses transition layers that are not 0 to 10000, spans that are not layers in order, or not above 0 and at most
/// 3600 s. The message starts with `where`.
[[nodiscard]] Status check(const ExposureRule& rule, const std::string& where);

/// Of layer `k`, `thickness_um` thick.
[[nodiscard]] double exposure_s(const Material& material, const ExposureRule& rule, int k, int thickness_um);

}  // namespace pliant::job

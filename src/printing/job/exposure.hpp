// The exposure time of each layer of a material.
#pragma once

#include <string>
#include <vector>

#include "printing/job/job.hpp"

namespace pliant::job {

/// Exposure set by the user, in seconds, for layers [first, last].
struct ExposureSpan {
    int first = 0, last = 0;
    double seconds = 0;

    bool operator==(const ExposureSpan&) const = default;
};

/// Layer exposures from a material's exposures. The first `bottom_layers` get the bottom exposure, the
/// `transition_layers` above them decrease linearly to the normal exposure of all others. If `penetration_um` (Dp of
/// Jacobs' working curve) is known, an exposure applies to a layer of `layer_um`, and one of height h gets exp((h -
/// layer_um) / Dp) times as much, so that the cure depth grows by as much as the height. Spans are applied last,
/// unchanged.
struct ExposureRule {
    int bottom_layers = 0;
    int transition_layers = 0;
    double penetration_um = 0;  ///< 0: the same exposure at all heights
    int layer_um = 50;
    std::vector<ExposureSpan> spans{};

    bool operator==(const ExposureRule&) const = default;
};

inline constexpr double shortest_exposure_s = 0.001;  // G-code has milliseconds
inline constexpr double longest_exposure_s = 3600;

/// Errors: transition layers outside 0 to 10000, spans with layers out of order or exposures not above 0 and at most
/// the longest. The message starts with `where`.
[[nodiscard]] Status check(const ExposureRule& rule, const std::string& where);

/// For layer `k` of height `thickness_um`.
[[nodiscard]] double exposure_s(const Material& material, const ExposureRule& rule, int k, int thickness_um);

}  // namespace pliant::job

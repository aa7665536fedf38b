#include "printing/job/exposure.hpp"

#include <cmath>

namespace pliant::job {

Status check(const ExposureRule& rule, const std::string& where) {
    if (rule.transition_layers < 0 || rule.transition_layers > 10000)
        return input_error("{}: {} transition layers: must be 0 to 10000", where, rule.transition_layers);
    for (const ExposureSpan& span : rule.spans) {
        if (span.first < 0 || span.last < span.first)
            return input_error("{}: exposure of layers {} to {}: they count from 0 upwards", where, span.first,
                               span.last);
        if (!(span.seconds > 0 && span.seconds <= longest_exposure_s))
            return input_error("{}: exposure of {} s: must be above 0 and at most {} s", where, span.seconds,
                               longest_exposure_s);
    }
    return {};
}

double exposure_s(const Material& material, const ExposureRule& rule, int k, int thickness_um) {
    double seconds = material.exposure_s;
    const int above = k - rule.bottom_layers;
    if (above < 0) {
        seconds = material.bottom_exposure_s;
    } else if (above < rule.transition_layers) {
        const double share = static_cast<double>(above + 1) / (rule.transition_layers + 1);
        seconds += (material.bottom_exposure_s - material.exposure_s) * (1 - share);
    }
    if (rule.penetration_um > 0) seconds *= std::exp((thickness_um - rule.layer_um) / rule.penetration_um);
    for (const ExposureSpan& span : rule.spans) {
        if (span.first <= k && k <= span.last) seconds = span.seconds;
    }
    // Whole milliseconds, as in G-code.
    return std::round(seconds * 1000) / 1000;
}

}  // namespace pliant::job

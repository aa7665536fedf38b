// Possible deviations of a print, by name, so that reports can be searched and intended deviations accepted.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::twin {

struct Finding {
    enum class Kind {
        missing,        ///< required by an image, but liquid
        foreign,        ///< cured in another resin than the image's
        stray,          ///< cured without any image requiring it
        dose,           ///< exposed longer or shorter than in the manifest
        light,          ///< exposure that cured nothing attached to the part
        height,         ///< a layer that is not in the job, or of another thickness
        image,          ///< an image that differs from its description in the manifest
        volume,         ///< a material's volume differs from the drawn one
        overcure,       ///< cured deeper below an underside than allowed
        contamination,  ///< a vat with too much foreign resin
        cleaning,       ///< a swap with too little cleaning
        platform,       ///< cured beside the platform
        fault,          ///< a fault to be injected did not occur: the print proves nothing about it
        interlock,      ///< a forbidden action
    };
    Kind kind = Kind::missing;
    std::string text;
    bool accepted = false;
};

[[nodiscard]] std::string_view finding_name(Finding::Kind kind);

/// Only intended deviations can be accepted: overcure, volume, contamination and cleaning. The others mean that the
/// print is not the job.
[[nodiscard]] bool can_be_accepted(Finding::Kind kind);

/// The kind of that name. Errors: unknown, or cannot be accepted; the message names those that can.
[[nodiscard]] Result<Finding::Kind> accepted_finding(std::string_view name);

/// The kinds of those names. Errors: as above, for the first invalid one.
[[nodiscard]] Result<std::vector<Finding::Kind>> accepted_findings(std::span<const std::string> names);

}  // namespace pliant::twin

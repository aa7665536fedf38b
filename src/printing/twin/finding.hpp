// What can be wrong with a print, by name: so that a report can be searched, and a finding be accepted by whoever means
// it.
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
        missing,        ///< asked for by an image, and liquid
        foreign,        ///< cured in another resin than the image's
        stray,          ///< cured though no image asks for it
        dose,           ///< lit longer or shorter than the manifest says
        light,          ///< light that cured nothing that holds on to the part
        height,         ///< a layer that the job has not, or of another thickness
        image,          ///< an image that is not the one which the manifest describes
        volume,         ///< a material's volume is not the drawn one
        overcure,       ///< cured deeper below an underside than the drawing allows
        contamination,  ///< a vat with too much foreign resin
        cleaning,       ///< a swap with too little of it
        interlock,      ///< something forbidden
    };
    Kind kind = Kind::missing;
    std::string text;
    bool accepted = false;
};

[[nodiscard]] std::string_view finding_name(Finding::Kind kind);

/// Only what a job may mean can be accepted: overcure, volume, contamination and cleaning. The others say that the
/// print is not the job.
[[nodiscard]] bool can_be_accepted(Finding::Kind kind);

/// The kind of that name. Errors: there is none, or it cannot be accepted; the message names those that can.
[[nodiscard]] Result<Finding::Kind> accepted_finding(std::string_view name);

/// The kinds of those names. Errors: as above, for the first.
[[nodiscard]] Result<std::vector<Finding::Kind>> accepted_findings(std::span<const std::string> names);

}  // namespace pliant::twin

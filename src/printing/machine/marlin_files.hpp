// Marlin's own example of its two configuration files, changed to what a machine needs: ready to be compiled.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/firmware.hpp"
#include "printing/machine/marlin_release.hpp"

namespace pliant::machine {

/// A file and where it was read, for messages.
struct MarlinFile {
    std::string path, text;
};

struct ConfiguredMarlin {
    std::string configuration, configuration_adv;  ///< the files' new texts
    std::string record;  ///< a line per setting: where it stands, what it was, what it is, why
    int changed = 0;     ///< settings that are not as they were
    int added = 0;       ///< pins that the files did not name
    std::string author;  ///< STRING_CONFIG_H_AUTHOR, if it is not Marlin's own "(none, default config)"
};

/// Sets, enables or disables each setting in all places that have it; everything else stays as it is. A pin (…_PIN with
/// a number) that neither file names goes to the end of Configuration.h, where it precedes the board's own.
/// Errors: a file without its version (not Marlin's), of another release, or without a setting of the list.
[[nodiscard]] Result<ConfiguredMarlin> configure_marlin(const std::vector<FirmwareSetting>& settings,
                                                        MarlinRelease release, const MarlinFile& configuration,
                                                        const MarlinFile& configuration_adv);

}  // namespace pliant::machine

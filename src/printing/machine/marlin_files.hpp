// Adapts Marlin's example configuration files to a machine: ready to compile.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/firmware.hpp"
#include "printing/machine/marlin_release.hpp"

namespace pliant::machine {

/// A file and its path, for messages.
struct MarlinFile {
    std::string path, text;
};

struct ConfiguredMarlin {
    std::string configuration, configuration_adv;  ///< the new contents
    std::string record;                            ///< one line per setting: its place, old value, new value, reason
    int changed = 0;                               ///< number of settings changed
    int added = 0;                                 ///< number of pins that the files did not define
    std::string author;  ///< STRING_CONFIG_H_AUTHOR, if it is not Marlin's own "(none, default config)"
};

/// Sets, enables or disables each setting in all its places; everything else is preserved. A pin (…_PIN with a number)
/// that neither file defines goes to the end of Configuration.h, where it precedes the board's own.
/// Errors: a file without version (not Marlin's), of another release, or without a setting of the list.
[[nodiscard]] Result<ConfiguredMarlin> configure_marlin(const std::vector<FirmwareSetting>& settings,
                                                        MarlinRelease release, const MarlinFile& configuration,
                                                        const MarlinFile& configuration_adv);

}  // namespace pliant::machine

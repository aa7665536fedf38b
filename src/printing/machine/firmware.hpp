// Build settings of Marlin 2.1 for a machine, from its printer file. firmware/README.md explains the machine's side;
// names are those of Configuration.h and Configuration_adv.h of the release in the printer file.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

struct FirmwareSetting {
    std::string name;    ///< as in Marlin's configuration, upper case
    std::string value;   ///< "on" defines it, "off" removes it
    std::string reason;  ///< one line
};

/// In order, in groups whose first setting has a reason. Errors: a machine that a RAMPS 1.4 with Marlin 2.1 cannot
/// drive: a classic dialect, more motors than five outputs or than free sockets, an axis of unknown drive, more than
/// 40,000 steps a second.
[[nodiscard]] Result<std::vector<FirmwareSetting>> firmware_settings(const Printer& printer);

/// The settings as a file config.ini, which Marlin's build reads. 2.1.1 and 2.1.2 share the same list.
[[nodiscard]] Result<std::string> firmware_ini(const Printer& printer);

}  // namespace pliant::machine

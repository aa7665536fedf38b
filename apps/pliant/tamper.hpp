// Jobs as forgers, slips and bad disks leave them: any job archive, taken apart, changed in one way, put together
// again. For tests.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::app::tamper {

/// A job taken apart.
struct Parts {
    job::Manifest manifest;
    std::map<std::string, std::string> entries;  ///< all but the manifest
    std::vector<std::string> gcode;              ///< lines of job.gcode, which is not in `entries`
    machine::Printer printer;                    ///< as read; a change of it goes into entries["printer.toml"]
};

/// What a change leaves for the proof to go by, where the forger has remade all fingerprints.
enum class Kind {
    meaning,  ///< what the program or the job says is wrong
    pixels,   ///< pixels alone, with their areas corrected: only a fingerprint can tell
    areas     ///< pixels whose areas do not fit: only a fingerprint or a look at every pixel (check) can tell
};

struct Tampering {
    std::string name;
    Kind kind = Kind::meaning;
    /// False: there is nothing of the sort in this job.
    std::function<bool(Parts&)> change;
};

/// All that we know of.
[[nodiscard]] std::vector<Tampering> tamperings();

[[nodiscard]] Parts take_apart(const std::filesystem::path& job);
/// `remade`: with the fingerprints of what is there now, as a forger would.
void put_together(const Parts& parts, bool remade, const std::filesystem::path& job);

}  // namespace pliant::app::tamper

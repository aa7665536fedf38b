// Tampered or damaged jobs for tests: takes a job archive apart, changes it in one way, and reassembles it.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::app::tamper {

/// The contents of a job.
struct Parts {
    job::Manifest manifest;
    std::map<std::string, std::string> entries;  ///< all entries except the manifest
    std::vector<std::string> gcode;              ///< lines of job.gcode, which is not in `entries`
    machine::Printer printer;                    ///< as read; to change it, change entries["printer.toml"]
};

/// How a change can be detected if all checksums have been recomputed.
enum class Kind {
    meaning,  ///< from the content of the program or the job
    pixels,   ///< pixels alone, with areas adjusted: only by a checksum
    areas     ///< pixels with wrong areas: only by a checksum or a check of every pixel
};

struct Tampering {
    std::string name;
    Kind kind = Kind::meaning;
    /// False: not applicable to this job.
    std::function<bool(Parts&)> change;
};

/// All known kinds of tampering.
[[nodiscard]] std::vector<Tampering> tamperings();

[[nodiscard]] Parts take_apart(const std::filesystem::path& job);
/// `remade`: with checksums recomputed for the changed contents, as a forger would.
void put_together(const Parts& parts, bool remade, const std::filesystem::path& job);

}  // namespace pliant::app::tamper

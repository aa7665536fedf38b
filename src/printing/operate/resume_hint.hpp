// What to tell a person about resuming a print.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/operate/port_station.hpp"

namespace pliant::operate {

/// How a print was started, as far as its resumption needs the same.
struct PrintCall {
    std::string job;  ///< as it was typed
    PortOptions port;
    std::string journal;  ///< "": beside the job
    std::string after_layer, report;
    bool resumed = false;
};

/// A command line that resumes the print, word for word, for a shell.
[[nodiscard]] std::string resume_command(const PrintCall& call);

/// Number of the last record of a journal that belongs to this job on this printer and holds an interrupted print;
/// nothing otherwise, and nothing while a host prints with it. Opens no file that is not there.
[[nodiscard]] std::optional<long> interrupted_at(const std::filesystem::path& journal, const std::string& digest,
                                                 const std::string& printer);

/// What that print has asked a person to do before its next exposure, such as to fill a vat; likewise.
[[nodiscard]] std::vector<std::string> asked_before(const ReadyJob& ready);

/// Errors: host::check_way_on() of that print; ok if the journal cannot be read.
[[nodiscard]] Status check_resumable(const ReadyJob& ready);

/// Errors: there is no such file.
[[nodiscard]] Status expect_journal(const std::filesystem::path& journal, const std::string& job);

}  // namespace pliant::operate

// File names of print journals in the project folder, and of their jobs.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pliant::studio {

/// JOB.zip.virtual.journal: for prints on the virtual printer; real machines do not use it.
[[nodiscard]] std::filesystem::path virtual_journal(const std::filesystem::path& job);

/// JOB.zip for JOB.zip.journal, JOB.zip.virtual.journal, and either as renamed by keep_journal().
[[nodiscard]] std::string job_of_journal(std::string_view journal);
[[nodiscard]] bool is_virtual_journal(std::string_view journal);

/// Preserves the journal of a finished print before a new one starts: it is renamed to JOB.zip.DATE.journal (end of the
/// print, UTC), and remains in the print history. If it cannot be renamed, or the name exists, it is left alone.
void keep_journal(const std::filesystem::path& journal);

}  // namespace pliant::studio

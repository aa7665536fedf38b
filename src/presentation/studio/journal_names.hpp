// How the journals of prints are called in the project folder, and the jobs that they are of.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pliant::studio {

/// JOB.zip.virtual.journal: of prints on the virtual printer; a real machine knows nothing of them.
[[nodiscard]] std::filesystem::path virtual_journal(const std::filesystem::path& job);

/// JOB.zip of JOB.zip.journal, JOB.zip.virtual.journal, and of either as keep_journal() names it.
[[nodiscard]] std::string job_of_journal(std::string_view journal);
[[nodiscard]] bool is_virtual_journal(std::string_view journal);

/// Before a new print takes the place of one that is over: its journal becomes JOB.zip.DATE.journal (when it ended,
/// UTC), and stays in the print history. What cannot be renamed, or is there already, is left alone.
void keep_journal(const std::filesystem::path& journal);

}  // namespace pliant::studio

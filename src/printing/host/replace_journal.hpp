// Writes the journal of a print that kept it elsewhere, as one on the virtual printer does, to a file.
#pragma once

#include <filesystem>
#include <string_view>

#include "base/core/error.hpp"

namespace pliant::host {

/// Whether replace_journal() would be refused now: ask before the print. Errors: another host holds the file; it is not
/// a journal, or a damaged one; its print was interrupted, and what it proves would be lost.
[[nodiscard]] Status may_replace_journal(const std::filesystem::path& path);

/// Replaces the file by `text`, holding its lock. Devices and pipes are written to. Errors: as above; the disk.
[[nodiscard]] Status replace_journal(const std::filesystem::path& path, std::string_view text);

}  // namespace pliant::host

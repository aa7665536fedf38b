#include "studio/print/journal_names.hpp"

#include <fmt/chrono.h>

#include <chrono>
#include <regex>

namespace pliant::studio {
namespace {

constexpr std::string_view ending = ".journal", of_virtual = ".virtual";

std::string without(std::string_view text, std::string_view end) {
    return std::string(text.ends_with(end) ? text.substr(0, text.size() - end.size()) : text);
}

/// Removes the date inserted by keep_journal().
std::string undated(const std::string& text) {
    static const std::regex date(R"(\.\d{4}-\d{2}-\d{2}_\d{6}$)");
    return std::regex_replace(text, date, "");
}

}  // namespace

std::filesystem::path virtual_journal(const std::filesystem::path& job) {
    return job.string() + std::string(of_virtual) + std::string(ending);
}

std::string job_of_journal(std::string_view journal) {
    return without(undated(without(journal, ending)), of_virtual);
}

bool is_virtual_journal(std::string_view journal) {
    return undated(without(journal, ending)).ends_with(of_virtual);
}

void keep_journal(const std::filesystem::path& journal) {
    std::error_code error;
    if (!std::filesystem::exists(journal, error) || std::filesystem::file_size(journal, error) == 0) return;
    const auto written = std::filesystem::last_write_time(journal, error);
    if (error) return;
    const auto ended = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::file_clock::to_sys(written));
    const std::filesystem::path kept = fmt::format("{}.{:%Y-%m-%d_%H%M%S}{}", without(journal.string(), ending),
                                                   fmt::gmtime(std::chrono::system_clock::to_time_t(ended)), ending);
    if (!std::filesystem::exists(kept, error)) std::filesystem::rename(journal, kept, error);
}

}  // namespace pliant::studio

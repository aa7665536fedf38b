#include "studio/server/help_pages.hpp"

#include <array>
#include <optional>
#include <utility>

#include "base/core/files.hpp"

namespace pliant::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "/help/";

/// MIME type; files of other types are not served.
std::string_view type_of(const fs::path& file) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 16> types{{
        {".html", "text/html; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".json", "application/json"},
        {".txt", "text/plain; charset=utf-8"},
        {".toml", "text/plain; charset=utf-8"},
        {".csv", "text/plain; charset=utf-8"},
        {".ini", "text/plain; charset=utf-8"},
        {".cpp", "text/plain; charset=utf-8"},
        {".py", "text/plain; charset=utf-8"},
        {".png", "image/png"},
        {".gif", "image/gif"},
        {".svg", "image/svg+xml"},
        {".ico", "image/x-icon"},
        {".woff2", "font/woff2"},
        {".woff", "font/woff"},
    }};
    const std::string ending = file.extension().string();
    for (const auto& [known, type] : types) {
        if (ending == known) return type;
    }
    return "";
}

/// The path below the folder; empty if a part of it could lead outside.
std::optional<fs::path> below(std::string_view path) {
    if (path.find('\\') != std::string_view::npos || path.find('\0') != std::string_view::npos) return std::nullopt;
    fs::path file;
    while (true) {
        const std::size_t end = std::min(path.find('/'), path.size());
        const std::string_view part = path.substr(0, end);
        if (part.empty() || part == "." || part == "..") return std::nullopt;
        file /= part;
        if (end == path.size()) return file;
        path.remove_prefix(end + 1);
    }
}

Response missing_pages() {
    Response response{404, "text/plain; charset=utf-8"};
    response.body =
        "The documentation is not installed beside this program. On Debian it is in the package pliant-doc; "
        "in the source, tools/site makes it.\n";
    return response;
}

}  // namespace

fs::path find_help_pages(const fs::path& program_folder) {
    std::error_code error;
    for (const fs::path& folder : {program_folder / "../share/doc/pliant/html", fs::path(PLIANT_SITE_BUILT)}) {
        if (!folder.empty() && fs::is_regular_file(folder / "index.html", error)) return folder;
    }
    return {};
}

Response help_page(const fs::path& folder, std::string_view path) {
    if (folder.empty()) return missing_pages();
    if (path == "/help") {
        Response response{302, "text/plain"};
        response.location = prefix;
        return response;
    }
    if (!path.starts_with(prefix)) return error_response(404, "not found");
    path.remove_prefix(prefix.size());
    const std::optional<fs::path> file = path.empty() ? fs::path("index.html") : below(path);
    if (!file || type_of(*file).empty()) return error_response(404, "not found");
    const Result<std::string> bytes = read_file(folder / *file, 64U << 20);
    if (!bytes) return error_response(404, "not found");
    return {200, std::string(type_of(*file)), *bytes};
}

}  // namespace pliant::studio

// The documentation as HTML pages, served under /help/ if it is installed or built.
#pragma once

#include <filesystem>
#include <string_view>

#include "studio/base/http.hpp"

namespace pliant::studio {

/// The folder of the pages: below the prefix that the program is installed into (`share/doc/pliant/html`, relative to
/// the program's folder), or where the build of this program put them. Empty: there are none.
[[nodiscard]] std::filesystem::path find_help_pages(const std::filesystem::path& program_folder);

/// The file of `folder` for a path such as "/help/reference/robot.html"; "/help" redirects to "/help/", which is the
/// first page. Links inside the folder are followed: it belongs to the installation. Errors: 404 if there is no such
/// file, if a part of the path is empty, "." or "..", and, with a sentence for people, if there are no pages.
[[nodiscard]] Response help_page(const std::filesystem::path& folder, std::string_view path);

}  // namespace pliant::studio

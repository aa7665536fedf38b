// The documentation as pages, served under /help/ where it is installed or built.
#pragma once

#include <filesystem>
#include <string_view>

#include "presentation/studio/http.hpp"

namespace pliant::studio {

/// The folder of the pages: below the prefix that the program is installed into (`share/doc/pliant/html`, seen from the
/// program's folder), or where the build of this program put them. Empty: there are none.
[[nodiscard]] std::filesystem::path find_help_pages(const std::filesystem::path& program_folder);

/// The file of `folder` that a path such as "/help/reference/robot.html" names; "/help" leads to "/help/", which is the
/// first page. Links of the folder are followed: it is the installation's own. Errors: 404 where there is no such file,
/// where a part of the path is empty, "." or "..", and, with a sentence for people, where there are no pages.
[[nodiscard]] Response help_page(const std::filesystem::path& folder, std::string_view path);

}  // namespace pliant::studio

// What is compiled into the program for the studio, so that it opens from anywhere: example robots, and the page.
#pragma once

#include <span>
#include <string_view>

#include "base/core/embedded_file.hpp"

namespace pliant::studio {

[[nodiscard]] std::span<const EmbeddedFile> example_robots();

/// A file of the page, compressed with gzip.
struct PageFile {
    std::string_view path;  ///< "/", "/assets/main-x.js"
    std::string_view type;
    std::string_view bytes;
    bool packed = true;
};
[[nodiscard]] std::span<const PageFile> page_files();

}  // namespace pliant::studio

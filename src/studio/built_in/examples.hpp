// Robots and printers that are compiled into the program, so that the studio opens from anywhere.
#pragma once

#include <span>
#include <string_view>

namespace pliant::studio {

struct BuiltInFile {
    std::string_view name;  ///< "gripper"
    std::string_view text;
};

[[nodiscard]] std::span<const BuiltInFile> example_robots();
[[nodiscard]] std::span<const BuiltInFile> example_printers();

/// The file of that name, or nullptr.
[[nodiscard]] const BuiltInFile* find_file(std::span<const BuiltInFile> files, std::string_view name);

/// A file of the page, compressed with gzip.
struct PageFile {
    std::string_view path;  ///< "/", "/assets/main-x.js"
    std::string_view type;
    std::string_view bytes;
    bool packed = true;
};
[[nodiscard]] std::span<const PageFile> page_files();

}  // namespace pliant::studio

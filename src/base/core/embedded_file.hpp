// Text files that are compiled into the program: materials, printers, example robots.
#pragma once

#include <span>
#include <string_view>

namespace pliant {

struct EmbeddedFile {
    std::string_view name;  ///< without folder and extension: "tower8", "ecoflex-00-30"
    std::string_view text;
};

/// The file of that name, or nullptr.
[[nodiscard]] inline const EmbeddedFile* find_file(std::span<const EmbeddedFile> files, std::string_view name) {
    for (const EmbeddedFile& file : files) {
        if (file.name == name) return &file;
    }
    return nullptr;
}

}  // namespace pliant

#include "studio/built_in/examples.hpp"

namespace pliant::studio {

const BuiltInFile* find_file(std::span<const BuiltInFile> files, std::string_view name) {
    for (const BuiltInFile& file : files) {
        if (file.name == name) return &file;
    }
    return nullptr;
}

}  // namespace pliant::studio

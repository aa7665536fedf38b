#include "loop/study/command_files.hpp"

#include <variant>

#include "base/core/config.hpp"
#include "base/core/files.hpp"

namespace pliant::study {

namespace fs = std::filesystem;

std::vector<fs::path> files_of(const std::string& word, const fs::path& folder) {
    std::vector<fs::path> files{folder / word};
    if (const std::size_t sign = word.find('='); sign != std::string::npos)
        files.push_back(folder / word.substr(sign + 1));
    std::erase_if(files, [](const fs::path& file) {
        std::error_code error;
        return !fs::is_regular_file(file, error);
    });
    for (std::size_t k = 0, count = files.size(); k < count; ++k) {
        if (lower_extension(files[k]) != ".toml") continue;
        const Result<config::Document> document = config::load(files[k]);
        if (!document) continue;  // the command tells what is wrong with it
        for (const auto& [key, value] : std::get<config::Table>(document->root.data)) {
            const auto* name = key == "robot" ? std::get_if<std::string>(&value.data) : nullptr;
            if (name != nullptr) files.push_back(files[k].parent_path() / *name);
        }
    }
    return files;
}

}  // namespace pliant::study

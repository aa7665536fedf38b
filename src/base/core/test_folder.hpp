// A temporary folder for one test, deleted at its end.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace pliant::test {

class Folder {
public:
    explicit Folder(const std::string& name = "test") {
        std::string pattern = (std::filesystem::temp_directory_path() / ("pliant_" + name + "_XXXXXX")).string();
        if (::mkdtemp(pattern.data()) == nullptr) std::abort();  // no place for temporary files
        path_ = pattern;
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

}  // namespace pliant::test

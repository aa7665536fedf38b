// Paths from a page, and those in its robot file: no accepted path is outside the project's folder.
#include <algorithm>
#include <filesystem>
#include <string>

#include "input.hpp"
#include "studio/requests/project_folder.hpp"

namespace {

namespace fs = std::filesystem;

/// A folder with a symbolic link that leads out of it.
const pliant::studio::ProjectFolder& project() {
    static const fs::path root = [] {
        std::string pattern = (fs::temp_directory_path() / "pliant_fuzz_XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) __builtin_trap();
        const fs::path made = fs::path(pattern) / "project";
        fs::create_directories(made / "parts");
        fs::create_directory_symlink("..", made / "out");
        return made;
    }();
    static const auto folder = pliant::studio::ProjectFolder::open(root);
    if (!folder) __builtin_trap();
    return *folder;
}

bool is_inside(const fs::path& path) {
    const fs::path& root = project().path();
    const fs::path real = fs::weakly_canonical(path);
    return std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first == root.end();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text = as_text(data, size);
    const auto path = project().resolve(text);
    if (path && (!is_inside(*path) || path->string().find('\0') != std::string::npos)) __builtin_trap();
    (void)project().texts_leading_outside(text, project().path() / "robot.toml");
    return 0;
}

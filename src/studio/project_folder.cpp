#include "studio/project_folder.hpp"

#include <algorithm>
#include <system_error>

#include "robot/robot.hpp"

namespace pliant::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_path = 400, most_files = 500;
constexpr int deepest = 2;

bool is_listed(const fs::path& path) {
    const std::string extension = path.extension().string();
    return extension == ".toml" || extension == ".zip";
}

void list(const fs::path& folder, const fs::path& root, int depth, std::vector<std::string>& files) {
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        if (files.size() >= most_files) return;
        const fs::path& path = it->path();
        if (path.filename().string().starts_with('.') || it->is_symlink(error)) continue;
        if (it->is_directory(error)) {
            if (depth < deepest) list(path, root, depth + 1, files);
        } else if (it->is_regular_file(error) && is_listed(path)) {
            files.push_back(path.lexically_relative(root).generic_string());
        }
    }
}

}  // namespace

Result<ProjectFolder> ProjectFolder::open(const fs::path& folder) {
    std::error_code error;
    fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
    if (error || !fs::is_directory(root, error)) return input_error("{}: not a folder", folder.string());
    return ProjectFolder(std::move(root));
}

Result<fs::path> ProjectFolder::resolve(std::string_view relative) const {
    const auto refused = [&](const char* why) {
        return input_error("\"{}\": {}; a path within the project folder is needed, as in \"parts/finger.toml\"",
                           relative.substr(0, longest_path), why);
    };
    const auto bad = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\'; };
    if (relative.empty() || relative.size() > longest_path) return refused("empty or too long");
    if (std::any_of(relative.begin(), relative.end(), bad)) return refused("holds a character that no name may have");
    const fs::path path{std::string(relative)};
    if (path.is_absolute()) return refused("absolute");
    for (const fs::path& part : path) {
        if (part == ".." || part == "." || part.empty()) return refused("leads elsewhere");
    }
    fs::path full = root_ / path;
    if (!holds(full)) return refused("leads outside");
    return full;
}

bool ProjectFolder::holds(const fs::path& path) const {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(path, error);
    if (error) return false;
    const auto [end, _] = std::mismatch(root_.begin(), root_.end(), real.begin(), real.end());
    return end == root_.end();
}

std::vector<std::string> ProjectFolder::files() const {
    std::vector<std::string> files;
    list(root_, root_, 0, files);
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<fs::path> files_of(const robot::Robot& robot) {
    std::vector<fs::path> files;
    const auto add_geometry = [&](const auto& geometry) {
        if (const auto* file = std::get_if<robot::SurfaceFile>(&geometry)) files.push_back(file->path);
    };
    const auto add_selector = [&](const robot::Selector& selector) {
        if (const auto* surface = std::get_if<robot::SurfaceSelector>(&selector)) files.push_back(surface->path);
    };
    if (robot.mesh.file) files.push_back(*robot.mesh.file);
    for (const auto& body : robot.bodies) add_geometry(body.geometry);
    for (const auto& chamber : robot.chambers) add_geometry(chamber.air);
    for (const auto& gap : robot.gaps) add_geometry(gap.space);
    for (const auto& obstacle : robot.obstacles) add_geometry(obstacle.shape);
    for (const auto& fixed : robot.fixed) add_selector(fixed.selector);
    for (const auto& plate : robot.plates) add_selector(plate.selector);
    return files;
}

}  // namespace pliant::studio

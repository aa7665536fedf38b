#include "studio/requests/project_folder.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <system_error>

#include "base/core/config.hpp"
#include "base/core/files.hpp"

namespace pliant::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_path = 400, longest_name = 255, most_files = 500;
constexpr int deepest_folder = 2;

bool is_robot_or_job(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return extension == ".toml" || extension == ".zip";
}

bool is_journal(const fs::path& path) {
    return path.extension() == ".journal";
}

void list(const fs::path& folder, const fs::path& root, int depth, bool (*is_listed)(const fs::path&),
          std::vector<std::string>& files) {
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        if (files.size() >= most_files) return;
        const fs::path& path = it->path();
        if (path.filename().string().starts_with('.') || it->is_symlink(error)) continue;
        if (it->is_directory(error)) {
            if (depth < deepest_folder) list(path, root, depth + 1, is_listed, files);
        } else if (it->is_regular_file(error) && is_listed(path)) {
            files.push_back(path.lexically_relative(root).generic_string());
        }
    }
}

template <class Visit>
void visit_texts(const config::Value& value, const Visit& visit) {
    if (const auto* text = std::get_if<std::string>(&value.data)) visit(*text);
    if (const auto* array = std::get_if<config::Array>(&value.data)) {
        for (const config::Value& entry : *array) visit_texts(entry, visit);
    }
    if (const auto* table = std::get_if<config::Table>(&value.data)) {
        for (const config::Entry& entry : *table) visit_texts(entry.second, visit);
    }
}

/// A text of a document that may be a path.
struct Named {
    std::string text;
    std::string shown;  ///< as the document itself would name it, also if it stands in a file on which that is based
    fs::path path;
};
using Visit = std::function<void(const Named&)>;
using MayRead = std::function<bool(const Named&)>;

/// The file of `robot = "FILE.toml"`; null without that key.
const std::string* base_of(const config::Document& document) {
    for (const auto& [key, value] : std::get<config::Table>(document.root.data)) {
        if (key == "robot") return std::get_if<std::string>(&value.data);
    }
    return nullptr;
}

/// Where the texts of a robot file lead as paths.
struct Folder {
    fs::path path;
    fs::path shown;  ///< as the document itself would name it

    [[nodiscard]] Named named(const std::string& text) const {
        return {text, shown.empty() ? text : (shown / text).generic_string(), path / text};
    }
};

/// All texts of a robot file; `folder` is that of the file in which all of them are read.
void names_in(const config::Document& document, const Folder& folder, const Visit& visit) {
    const bool is_based = base_of(document) != nullptr;
    const auto visit_text = [&](const std::string& text) { visit(folder.named(text)); };
    const auto visit_assignment = [&](const std::string& text) {
        visit_texts(config::assigned_value(text), visit_text);
    };
    for (const auto& [key, value] : std::get<config::Table>(document.root.data)) {
        if (is_based && key == "robot") continue;
        if (is_based && key == "set")
            visit_texts(value, visit_assignment);
        else
            visit_texts(value, visit_text);
    }
}

/// All texts of the document and of the files on which it is based, one after the other, as far as they may be read.
/// What a file changes of the one on which it is based is read as if it stood in the last of them, so that a path in it
/// is relative to the folder of that one.
void visit_names(const config::Document& document, const MayRead& may_read, const Visit& visit) {
    std::vector<config::Document> files = {document};
    Folder folder{document.file.parent_path(), {}};
    std::error_code ignored;
    std::set<fs::path> seen = {fs::weakly_canonical(document.file, ignored)};
    while (const std::string* name = base_of(files.back())) {
        const Named base = folder.named(*name);
        visit(base);
        folder = {base.path.parent_path(), folder.shown / fs::path(*name).parent_path()};
        if (!may_read(base) || !fs::is_regular_file(base.path, ignored)) break;
        if (!seen.insert(fs::weakly_canonical(base.path, ignored)).second) break;
        Result<config::Document> below = config::load(base.path);
        if (!below) break;
        files.push_back(std::move(*below));
    }
    for (const config::Document& file : files) names_in(file, folder, visit);
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
    list(root_, root_, 0, is_robot_or_job, files);
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<std::string> ProjectFolder::journals() const {
    std::vector<std::string> files;
    list(root_, root_, 0, is_journal, files);
    std::sort(files.begin(), files.end());
    return files;
}

bool ProjectFolder::leads_outside(const std::string& text, const fs::path& path) const {
    const bool a_name = text.find('/') == std::string::npos && text != "..";
    if (a_name && text.size() > longest_name) return false;  // too long for a file name
    return !holds(path);
}

std::vector<std::string> ProjectFolder::texts_leading_outside(std::string_view toml, const fs::path& file) const {
    std::vector<std::string> outside;
    const Result<config::Document> document = config::parse(toml, file);
    if (!document) return outside;
    visit_names(
        *document, [](const Named&) { return true; },
        [&](const Named& named) {
            if (leads_outside(named.text, named.path)) outside.push_back(named.shown);
        });
    return outside;
}

Status ProjectFolder::check_texts(std::string_view toml, const fs::path& file,
                                  std::span<const std::string> known) const {
    const Result<config::Document> document = config::parse(toml, file);
    if (!document) return {};  // from which nothing is read
    const auto is_allowed = [&](const Named& named) {
        return std::find(known.begin(), known.end(), named.shown) != known.end() ||
               !leads_outside(named.text, named.path);
    };
    std::string outside;
    visit_names(*document, is_allowed, [&](const Named& named) {
        if (outside.empty() && !is_allowed(named)) outside = named.shown;
    });
    if (outside.empty()) return {};
    return input_error("\"{}\" lies outside of the project folder {}", outside, root_.string());
}

std::string ProjectFolder::stamps_of(std::string_view toml, const fs::path& file) const {
    std::string stamps;
    const Result<config::Document> document = config::parse(toml, file);
    if (!document) return stamps;
    visit_names(
        *document, [](const Named&) { return true; },
        [&](const Named& named) {
            std::error_code error;
            if (named.text.empty() || named.text.size() > longest_path) return;
            if (!fs::is_regular_file(named.path, error)) return;
            const auto size = fs::file_size(named.path, error);
            const auto changed = fs::last_write_time(named.path, error).time_since_epoch().count();
            if (!error) stamps += "\n" + named.shown + " " + std::to_string(size) + " " + std::to_string(changed);
        });
    return stamps;
}

}  // namespace pliant::studio

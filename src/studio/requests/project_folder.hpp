// The folder that the studio may read and write: pages have no access outside it.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::studio {

class ProjectFolder {
public:
    /// Errors: no such folder.
    [[nodiscard]] static Result<ProjectFolder> open(const std::filesystem::path& folder);

    [[nodiscard]] const std::filesystem::path& path() const { return root_; }
    /// Resolves a relative path sent by a page, with '/'. Errors: empty, absolute, "." or ".." among its parts,
    /// backslashes or control characters, or a symbolic link in it that leads outside.
    [[nodiscard]] Result<std::filesystem::path> resolve(std::string_view relative) const;
    /// True if the path, with links resolved, is inside the folder.
    [[nodiscard]] bool holds(const std::filesystem::path& path) const;
    /// Robot files and jobs (.toml, .zip), relative, sorted; two levels deep, at most 500, without hidden ones.
    [[nodiscard]] std::vector<std::string> files() const;
    /// Journals of prints (.journal), listed likewise.
    [[nodiscard]] std::vector<std::string> journals() const;
    /// The strings in a robot file's text that, taken as paths, lead outside: checked before any file that it names is
    /// read. Also those of the files on which it is based (robot = "FILE.toml") and of what it changes in them; such a
    /// path is relative to the folder of that file, and is told as `file` would name it. Empty for an invalid document.
    /// To be called with the user's own file only: the files on which it is based are read wherever they lie.
    [[nodiscard]] std::vector<std::string> texts_leading_outside(std::string_view toml,
                                                                 const std::filesystem::path& file) const;
    /// Error: one of them is not among `known`, those that the user's own file named. Reads nothing outside but those.
    [[nodiscard]] Status check_texts(std::string_view toml, const std::filesystem::path& file,
                                     std::span<const std::string> known = {}) const;
    /// A fingerprint that changes when a file that the document, beside `file`, names changes, or one on which it is
    /// based, or one that this names: "" if it names none. Call it with a checked document.
    [[nodiscard]] std::string stamps_of(std::string_view toml, const std::filesystem::path& file) const;

    /// Held from the reading of a file to its writing: of two changes at once the later one begins with what the former
    /// has written.
    [[nodiscard]] std::mutex& one_change_at_a_time() const { return *changes_; }

private:
    [[nodiscard]] bool leads_outside(const std::string& text, const std::filesystem::path& path) const;
    explicit ProjectFolder(std::filesystem::path root) : root_(std::move(root)) {}
    std::filesystem::path root_;                                            ///< canonical
    std::shared_ptr<std::mutex> changes_ = std::make_shared<std::mutex>();  ///< of all copies
};

}  // namespace pliant::studio

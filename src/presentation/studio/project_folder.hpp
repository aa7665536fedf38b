// The folder that the studio may read and write: nothing a page asks for lies outside of it.
#pragma once

#include <filesystem>
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
    /// A relative path as a page writes it, with '/'. Errors: empty, absolute, "." or ".." among its parts, backslashes
    /// or control characters, or a symbolic link on the way that leads outside.
    [[nodiscard]] Result<std::filesystem::path> resolve(std::string_view relative) const;
    /// True if the path, links followed, lies in the folder.
    [[nodiscard]] bool holds(const std::filesystem::path& path) const;
    /// Robot files and jobs (.toml, .zip), relative, sorted; two levels deep, at most 500, hidden ones left out.
    [[nodiscard]] std::vector<std::string> files() const;
    /// Journals of prints (.journal), listed likewise.
    [[nodiscard]] std::vector<std::string> journals() const;
    /// The text values of a TOML document that, taken as paths beside `file`, lead outside: found before anything is
    /// read that the document names. A document with mistakes has none.
    [[nodiscard]] std::vector<std::string> texts_leading_outside(std::string_view toml,
                                                                 const std::filesystem::path& file) const;
    /// Something that changes when a file changes that the document, beside `file`, names: "" where it names none.
    [[nodiscard]] std::string stamps_of(std::string_view toml, const std::filesystem::path& file) const;

private:
    explicit ProjectFolder(std::filesystem::path root) : root_(std::move(root)) {}
    std::filesystem::path root_;  ///< canonical
};

}  // namespace pliant::studio

#include "studio/files/received_file.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "base/core/letters.hpp"
#include "studio/base/access.hpp"

namespace pliant::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_file_name = 120;
constexpr std::array<std::string_view, 12> endings = {".stl", ".obj", ".ply", ".off",  ".3mf", ".step",
                                                      ".stp", ".vtk", ".vtu", ".mesh", ".msh", ".inp"};

/// A temporary file that is deleted with this object, unless it was kept.
class Aside {
public:
    explicit Aside(fs::path path) : path_(std::move(path)) {}
    ~Aside() {
        std::error_code ignored;
        if (!path_.empty()) fs::remove(path_, ignored);
    }
    Aside(const Aside&) = delete;
    Aside& operator=(const Aside&) = delete;
    [[nodiscard]] const fs::path& path() const { return path_; }
    Status keep_as(const fs::path& name) {
        std::error_code error;
        fs::rename(path_, name, error);
        if (error) return failure("{}: cannot be written: {}", name.filename().string(), error.message());
        path_.clear();
        return {};
    }

private:
    fs::path path_;
};

Error too_large(const std::string& name, long long largest) {
    return {Cause::input,
            fmt::format("{}: larger than {} MB; copy it into the project folder yourself", name, largest >> 20)};
}

Status write_received(const fs::path& path, const std::string& name, long long length, const ReadMore& more,
                      long long largest) {
    if (length > largest) return tl::unexpected(too_large(name, largest));
    std::ofstream file(path, std::ios::binary);
    std::array<char, 1 << 16> piece{};
    for (long long had = 0;;) {
        if (length >= 0 && had >= length) break;
        const auto most = length >= 0 ? std::min<long long>(length - had, piece.size()) : piece.size();
        const long long got = more(piece.data(), static_cast<std::size_t>(most));
        if (got < 0 || (got == 0 && length >= 0)) return failure("{}: the connection was lost", name);
        if (got == 0) break;
        had += got;
        if (had > largest) return tl::unexpected(too_large(name, largest));
        file.write(piece.data(), got);
        if (!file) return failure("{}: cannot be written: is the disk full?", name);
    }
    file.close();
    return file ? Status{} : failure("{}: cannot be written: is the disk full?", name);
}

bool same_bytes(const fs::path& a, const fs::path& b) {
    std::error_code error;
    if (!fs::is_regular_file(b, error) || fs::file_size(a, error) != fs::file_size(b, error) || error) return false;
    std::ifstream one(a, std::ios::binary), other(b, std::ios::binary);
    return std::equal(std::istreambuf_iterator<char>(one), std::istreambuf_iterator<char>(),
                      std::istreambuf_iterator<char>(other), std::istreambuf_iterator<char>());
}

/// The reader names the temporary path: replace it by the file's own name.
Error renamed(Error error, const std::string& path, const std::string& name) {
    for (std::size_t at = error.message.find(path); at != std::string::npos; at = error.message.find(path, at))
        error.message.replace(at, path.size(), name);
    error.problems.clear();
    if (!error.message.starts_with(name)) error.message = name + ": " + error.message;
    return error;
}

}  // namespace

Status check_geometry_name(std::string_view name) {
    const auto bad = [](char c) {
        return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '/' || c == '\\' || c == '"' || c == ':';
    };
    if (name.empty() || name.size() > longest_file_name || name.front() == '.' || std::ranges::any_of(name, bad))
        return input_error("\"{}\": a plain name of at most 120 bytes is needed, as in \"finger.stl\"",
                           name.substr(0, longest_file_name));
    const std::string low = lower_case(name);
    if (std::ranges::any_of(endings, [&](std::string_view e) { return low.ends_with(e) && low.size() > e.size(); }))
        return {};
    return input_error(
        "\"{}\": is not geometry that Pliant reads by its ending; surfaces (.stl, .obj, .ply, .off), solids (.step, "
        ".stp, .3mf) and tet meshes (.vtk, .vtu, .msh, .mesh, .inp) are",
        name);
}

Result<ReceivedGeometry> receive_geometry(const ProjectFolder& folder, const std::string& name, bool replace,
                                          long long length, const ReadMore& more, long long largest) {
    if (Status fits = check_geometry_name(name); !fits) return tl::unexpected(fits.error());
    const Result<fs::path> path = folder.resolve(name);
    if (!path) return tl::unexpected(path.error());
    Aside aside(folder.path() / fmt::format(".{}.partial", random_key()));
    if (Status status = write_received(aside.path(), name, length, more, largest); !status)
        return tl::unexpected(status.error());
    Result<GeometryContent> content = geometry_content(aside.path());
    if (!content) return tl::unexpected(renamed(content.error(), aside.path().string(), name));
    for (std::string& note : content->notes) {
        const std::size_t at = note.find(aside.path().string());
        if (at != std::string::npos) note.replace(at, aside.path().string().size(), name);
    }
    std::error_code none;
    const bool taken = fs::exists(fs::symlink_status(*path, none));
    if (taken && same_bytes(aside.path(), *path)) return ReceivedGeometry{Received::same_as_there, std::move(*content)};
    if (taken && (!replace || !fs::is_regular_file(*path, none)))
        return ReceivedGeometry{Received::name_is_taken, std::move(*content)};
    if (Status status = aside.keep_as(*path); !status) return tl::unexpected(status.error());
    return ReceivedGeometry{Received::written, std::move(*content)};
}

}  // namespace pliant::studio

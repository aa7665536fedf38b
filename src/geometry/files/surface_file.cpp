#include "geometry/files/surface_file.hpp"

#include <algorithm>

#include "base/core/files.hpp"
#include "geometry/files/measurable.hpp"
#include "geometry/files/surface_mending.hpp"
#include "geometry/files/text_scanner.hpp"

namespace pliant::mesh {
namespace {

/// OBJ has no signature: recognised by a text whose first line that is neither blank nor a comment begins with one of
/// its keywords.
bool looks_like_obj(std::string_view bytes) {
    const std::string_view head = bytes.substr(0, 65536);
    if (head.find('\0') != std::string_view::npos) return false;
    TextScanner scan(head, "");
    while (!scan.at_end()) {
        const std::string_view word = scan.word_of_line();
        const bool comment = word.starts_with('#');
        if (!word.empty() && !comment) {
            static constexpr std::string_view keywords[] = {"v", "vn", "vt", "f", "g", "o", "s", "usemtl", "mtllib"};
            return std::find(std::begin(keywords), std::end(keywords), word) != std::end(keywords);
        }
        scan.rest_of_line();
    }
    return false;
}

bool looks_like_ply(std::string_view bytes) {
    return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

Result<SurfaceFile> parse_any(std::string_view bytes, const std::string& name) {
    if (looks_like_ply(bytes)) return parse_ply(bytes, name);
    if (looks_like_off(bytes)) return parse_off(bytes, name);
    if (looks_like_obj(bytes)) return parse_obj(bytes, name);
    if (looks_like_stl(bytes)) return parse_stl(bytes, name);
    return input_error("{}: is not a surface that Pliant reads (.stl, .obj, .ply or .off, by content)", name);
}

}  // namespace

bool looks_like_surface(std::string_view bytes) {
    bytes = without_mark(bytes);
    return looks_like_ply(bytes) || looks_like_off(bytes) || looks_like_obj(bytes) || looks_like_stl(bytes);
}

Result<SurfaceFile> parse_surface(std::string_view bytes, const std::string& name) {
    if (bytes.empty()) return input_error("{}: the file is empty", name);
    Result<SurfaceFile> file = parse_any(without_mark(bytes), name);
    if (!file) return file;
    const auto& points = file->mesh.points;
    const auto far = std::find_if_not(points.begin(), points.end(), is_measurable);
    if (far != points.end())
        return input_error("{}: a vertex lies at ({:g}, {:g}, {:g}): {}", name, far->x, far->y, far->z, too_far);
    mend_surface(*file, name);
    return file;
}

Result<SurfaceFile> read_surface(const std::filesystem::path& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_surface(*bytes, path.string());
}

}  // namespace pliant::mesh

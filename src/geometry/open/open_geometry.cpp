#include "geometry/open/open_geometry.hpp"

#include <fstream>
#include <string>
#include <utility>

#include "base/core/files.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_format.hpp"
#include "geometry/mesher/step_file.hpp"

namespace pliant::mesh {
namespace {

constexpr std::size_t head_bytes = 65536;  // enough for the readers to recognise a format

template <class T>
Result<Geometry> as_geometry(Result<T> content) {
    if (!content) return tl::unexpected(content.error());
    return Geometry(std::move(*content));
}

}  // namespace

GeometryKind geometry_kind(std::string_view bytes) {
    if (threemf::looks_like_zip(bytes)) return GeometryKind::threemf;
    if (looks_like_step(bytes)) return GeometryKind::step;
    if (looks_like_tet_mesh(bytes)) return GeometryKind::tets;
    if (looks_like_surface(bytes)) return GeometryKind::surface;
    return GeometryKind::unknown;
}

GeometryKind geometry_kind_of(const std::filesystem::path& path) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none)) return GeometryKind::unknown;  // a pipe can be read only once
    std::string head(head_bytes, '\0');
    std::ifstream stream(path, std::ios::binary);
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount())));
    return head.empty() ? GeometryKind::unknown : geometry_kind(head);
}

Result<Geometry> open_geometry(const std::filesystem::path& path) {
    // These two are read elsewhere, or later: the first bytes are enough.
    const GeometryKind kind = geometry_kind_of(path);
    if (kind == GeometryKind::threemf) return as_geometry(threemf::read_3mf(path));
    if (kind == GeometryKind::step) return Geometry(StepPath{path});
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    const std::string name = path.string();
    if (looks_like_tet_mesh(*bytes)) return as_geometry(parse_tet_mesh(*bytes, name));
    if (looks_like_surface(*bytes)) return as_geometry(parse_surface(*bytes, name));
    if (bytes->empty()) return input_error("{}: the file is empty", name);
    return input_error(
        "{}: is not geometry that Pliant reads "
        "(surfaces: .stl, .obj, .ply or .off; solids: .step, .3mf; tet meshes: {}; by content)",
        name, tet_format_list);
}

}  // namespace pliant::mesh

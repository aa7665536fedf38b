#include "geometry/files/tet_writer.hpp"

#include <algorithm>
#include <array>

#include "base/core/files.hpp"
#include "geometry/files/vtu_writer.hpp"

namespace pliant::mesh {
namespace {

Status write_mesh_vtu(const std::filesystem::path& path, const TetMesh& mesh) {
    VtuData data;
    data.cells.push_back({"region", 1, std::vector<std::int32_t>(mesh.region.begin(), mesh.region.end())});
    data.region_names = mesh.region_names;
    return write_vtu(path, mesh, mesh.points, data);
}

using Path = std::filesystem::path;

struct Format {
    std::string_view ending;
    Status (*write)(const Path&, const TetMesh&, Encoding);
    bool has_text_form = false;
};

constexpr std::array<Format, 5> formats{{
    {".vtk", [](const Path& p, const TetMesh& m, Encoding e) { return write_file(p, vtk_bytes(m, e)); }, true},
    {".vtu", [](const Path& p, const TetMesh& m, Encoding) { return write_mesh_vtu(p, m); }},
    {".msh", [](const Path& p, const TetMesh& m, Encoding e) { return write_file(p, msh_bytes(m, e)); }, true},
    {".mesh", [](const Path& p, const TetMesh& m, Encoding) { return write_file(p, medit_text(m)); }},
    {".inp", [](const Path& p, const TetMesh& m, Encoding) { return write_file(p, inp_text(m)); }},
}};

Result<Format> format_of(const Path& path) {
    const auto* const found = std::ranges::find(formats, lower_extension(path), &Format::ending);
    if (found != formats.end()) return *found;
    return input_error("{}: unknown kind of mesh file; write {}", path.string(), tet_writer_list);
}

}  // namespace

Status check_tet_ending(const Path& path, Encoding encoding) {
    const Result<Format> format = format_of(path);
    if (!format) return tl::unexpected(format.error());
    if (encoding == Encoding::binary || format->has_text_form) return {};
    return input_error("{}: only .vtk and .msh have a text form beside the binary one", path.string());
}

Status write_tet_mesh(const Path& path, const TetMesh& mesh, Encoding encoding) {
    const Result<Format> format = format_of(path);
    return format ? format->write(path, mesh, encoding) : tl::unexpected(format.error());
}

}  // namespace pliant::mesh

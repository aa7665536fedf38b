#include "mesh/tet_file.hpp"

#include <fmt/format.h>

#include "core/files.hpp"
#include "mesh/vtu_writer.hpp"

namespace pliant::mesh {
namespace {

constexpr std::string_view vtk_mark = "# vtk";
constexpr std::string_view msh_mark = "$MeshFormat";

bool looks_like_vtu(std::string_view bytes) {
    const std::string_view head = bytes.substr(0, 4096);
    return head.find("<VTKFile") != std::string_view::npos;
}

/// Names in legacy VTK files are words without commas: blanks and a few signs become %XX.
std::string percent_encoded(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const bool plain = c > ' ' && c < 127 && c != '%' && c != '"' && c != ',';
        out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

/// Title and data type. The names of the regions stand in the title, because Gmsh and others stumble over a field
/// before the points; only names too long for a title (256 characters) are written as a field.
std::string vtk_head(const TetMesh& mesh) {
    constexpr std::size_t longest_title = 255;
    std::vector<std::string> names;
    for (const std::string& name : mesh.region_names) names.push_back(percent_encoded(name));
    const std::string title = fmt::format("{}{}", vtk_title_mark, fmt::join(names, ","));
    const bool fits = title.size() <= longest_title;
    std::string text = fmt::format("# vtk DataFile Version 3.0\n{}\nASCII\nDATASET UNSTRUCTURED_GRID\n",
                                   fits ? title : std::string("pliant tet mesh"));
    if (!fits)
        text += fmt::format("FIELD FieldData 1\nregion_names 1 {} string\n{}\n", names.size(), fmt::join(names, "\n"));
    return text;
}

}  // namespace

Result<TetMesh> parse_tet_mesh(std::string_view bytes, const std::string& name) {
    if (bytes.starts_with(vtk_mark)) return parse_vtk(bytes, name);
    if (bytes.starts_with(msh_mark)) return parse_msh(bytes, name);
    if (looks_like_vtu(bytes)) return parse_vtu(bytes, name);
    return input_error("{}: is no tet mesh that Pliant reads (.vtk, .vtu or .msh, by content)", name);
}

Result<TetMesh> read_tet_mesh(const std::filesystem::path& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_tet_mesh(*bytes, path.string());
}

bool looks_like_tet_mesh(std::string_view bytes) {
    return bytes.starts_with(vtk_mark) || bytes.starts_with(msh_mark) || looks_like_vtu(bytes);
}

std::string vtk_text(const TetMesh& mesh) {
    std::string text = vtk_head(mesh);
    fmt::format_to(std::back_inserter(text), "POINTS {} double\n", mesh.points.size());
    for (const Vec3& p : mesh.points) fmt::format_to(std::back_inserter(text), "{} {} {}\n", p.x, p.y, p.z);
    const auto width = static_cast<std::size_t>(mesh.nodes_per_tet());
    fmt::format_to(std::back_inserter(text), "CELLS {} {}\n", mesh.tet_count(), mesh.tet_count() * (width + 1));
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        fmt::format_to(std::back_inserter(text), "{} {}\n", width, fmt::join(mesh.tet(t), " "));
    }
    fmt::format_to(std::back_inserter(text), "CELL_TYPES {}\n", mesh.tet_count());
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) text += mesh.order == 2 ? "24\n" : "10\n";
    fmt::format_to(std::back_inserter(text), "CELL_DATA {}\nSCALARS region int 1\nLOOKUP_TABLE default\n",
                   mesh.tet_count());
    for (const int region : mesh.region) fmt::format_to(std::back_inserter(text), "{}\n", region);
    return text;
}

Status write_tet_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
    if (path.extension() == ".vtk") return write_file(path, vtk_text(mesh));
    if (path.extension() == ".vtu") {
        VtuData data;
        data.cells.push_back({"region", 1, std::vector<std::int32_t>(mesh.region.begin(), mesh.region.end())});
        data.region_names = mesh.region_names;
        return write_vtu(path, mesh, mesh.points, data);
    }
    return input_error("{}: unknown kind of mesh file; write .vtk or .vtu", path.string());
}

}  // namespace pliant::mesh

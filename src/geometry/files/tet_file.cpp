#include "geometry/files/tet_file.hpp"

#include "base/core/files.hpp"
#include "geometry/files/tet_format.hpp"
#include "geometry/files/text_scanner.hpp"

namespace pliant::mesh {
namespace {

tl::unexpected<Error> unknown_format(const std::string& name) {
    return input_error("{}: is not a tet mesh that Pliant reads ({}, by content)", name, tet_format_list);
}

/// TetGen writes two files; this finds the other one.
Result<TetMesh> read_tetgen_pair(const std::filesystem::path& path, const std::string& bytes, TetFormat format) {
    const bool has_nodes = format == TetFormat::tetgen_nodes;
    std::filesystem::path other = path;
    other.replace_extension(has_nodes ? ".ele" : ".node");
    const Result<std::string> rest = read_file(other);
    if (!rest)
        return input_error("{}: holds the {} of a TetGen mesh; the {} are missing: {}", path.string(),
                           has_nodes ? "points" : "tetrahedra", has_nodes ? "tetrahedra" : "points",
                           rest.error().message);
    const std::string_view here = without_mark(bytes), there = without_mark(*rest);
    if (has_nodes) return parse_tetgen(here, path.string(), there, other.string());
    return parse_tetgen(there, other.string(), here, path.string());
}

}  // namespace

Result<TetMesh> parse_tet_mesh(std::string_view bytes, const std::string& name) {
    bytes = without_mark(bytes);
    const std::optional<TetFormat> format = tet_format(bytes);
    if (!format) return unknown_format(name);
    switch (*format) {
        case TetFormat::vtk:
            return parse_vtk(bytes, name);
        case TetFormat::vtu:
            return parse_vtu(bytes, name);
        case TetFormat::msh:
            return parse_msh(bytes, name);
        case TetFormat::medit:
            return parse_medit(bytes, name);
        case TetFormat::inp:
            return parse_inp(bytes, name);
        case TetFormat::gid:
            return parse_gid(bytes, name);
        case TetFormat::tetgen_nodes:
        case TetFormat::tetgen_tets:
            break;
    }
    return input_error("{}: is one of the two files of a TetGen mesh (.node and .ele); both are needed", name);
}

Result<TetMesh> read_tet_mesh(const std::filesystem::path& path) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    const std::optional<TetFormat> format = tet_format(*bytes);
    if (format == TetFormat::tetgen_nodes || format == TetFormat::tetgen_tets)
        return read_tetgen_pair(path, *bytes, *format);
    return parse_tet_mesh(*bytes, path.string());
}

bool looks_like_tet_mesh(std::string_view bytes) {
    return tet_format(bytes).has_value();
}

}  // namespace pliant::mesh

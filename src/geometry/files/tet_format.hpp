// Recognises the format of a tet mesh file by its content.
#pragma once

#include <optional>
#include <string_view>

namespace pliant::mesh {

enum class TetFormat { vtk, vtu, msh, medit, tetgen_nodes, tetgen_tets, inp, gid };

/// Looks at the first bytes only. Nothing: not a tet format that Pliant reads.
[[nodiscard]] std::optional<TetFormat> tet_format(std::string_view bytes);

/// For messages.
inline constexpr std::string_view tet_format_list =
    ".vtk, .vtu, .msh, Medit .mesh, TetGen .node with .ele, Abaqus .inp or GiD";

}  // namespace pliant::mesh

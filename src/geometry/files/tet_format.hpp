// Which format of a tet mesh a file has, by its content.
#pragma once

#include <optional>
#include <string_view>

namespace pliant::mesh {

enum class TetFormat { vtk, vtu, msh, medit, tetgen_nodes, tetgen_tets, inp, gid };

/// By the first bytes alone; nothing else is checked. No format: none of those that Pliant reads.
[[nodiscard]] std::optional<TetFormat> tet_format(std::string_view bytes);

/// What messages list.
inline constexpr std::string_view tet_format_list =
    ".vtk, .vtu, .msh, Medit .mesh, TetGen .node with .ele, Abaqus .inp or GiD";

}  // namespace pliant::mesh

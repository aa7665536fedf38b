// Writing of tetrahedral meshes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// Number encoding of .vtk and .msh files. The other formats have only one.
enum class Encoding { binary, text };

/// The format follows the extension, in capitals too: .vtk (legacy), .vtu, .msh (Gmsh 4.1), .mesh (Medit) or .inp
/// (Abaqus and CalculiX: nodes, elements and sets, no materials). Coordinates are written without loss, regions with
/// their names.
[[nodiscard]] Status write_tet_mesh(const std::filesystem::path& path, const TetMesh& mesh,
                                    Encoding encoding = Encoding::binary);

/// Whether write_tet_mesh() knows the extension, and whether it has the encoding `text` if that is asked for: before
/// the mesh is made.
[[nodiscard]] Status check_tet_ending(const std::filesystem::path& path, Encoding encoding);

/// For messages.
inline constexpr std::string_view tet_writer_list = ".vtk, .vtu, .msh, .mesh or .inp";

/// Legacy VTK 3.0: regions are the cell data "region"; their names are in the title line, which Gmsh and others ignore,
/// or, if too long for it, in the text field "region_names".
[[nodiscard]] std::string vtk_bytes(const TetMesh& mesh, Encoding encoding);

/// The title line of .vtk files begins with this; the names follow, separated by commas, with blanks and special
/// characters as %XX.
inline constexpr std::string_view vtk_title_mark = "pliant tet mesh, regions: ";

/// Gmsh 4.1: region i is volume i and physical group i (from 1), with its name.
[[nodiscard]] std::string msh_bytes(const TetMesh& mesh, Encoding encoding);

/// Medit: regions are the references 1, 2, ...; a comment `# region 1 "root"` names each.
[[nodiscard]] std::string medit_text(const TetMesh& mesh);

/// *NODE, and an *ELEMENT card with an element set for each region.
[[nodiscard]] std::string inp_text(const TetMesh& mesh);

/// The element set of a region: its name if that is a valid label (a letter, then letters, digits, - or _, at most 60,
/// unique ignoring case), else "R" and its number from 1. CalculiX ignores case and allows 80 characters.
[[nodiscard]] std::vector<std::string> inp_labels(const std::vector<std::string>& names);

/// `** region LABEL "name"` for every label that differs from the name; other readers ignore these comments.
[[nodiscard]] std::string inp_name_comments(const std::vector<std::string>& names);

}  // namespace pliant::mesh

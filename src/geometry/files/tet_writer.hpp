// Tetrahedral meshes to files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// How .vtk and .msh files hold their numbers. The other formats know only one way.
enum class Encoding { binary, text };

/// By the extension: .vtk (legacy), .vtu, .msh (Gmsh 4.1), .mesh (Medit) or .inp (Abaqus and CalculiX: nodes, elements
/// and sets, no materials). Coordinates are written as they are, without loss; regions with their names.
[[nodiscard]] Status write_tet_mesh(const std::filesystem::path& path, const TetMesh& mesh,
                                    Encoding encoding = Encoding::binary);

/// What messages list.
inline constexpr std::string_view tet_writer_list = ".vtk, .vtu, .msh, .mesh or .inp";

/// Legacy VTK 3.0: regions are the cell data "region", their names stand in the title line, which Gmsh and others pass
/// over, or in the text field "region_names" where they are too long for it.
[[nodiscard]] std::string vtk_bytes(const TetMesh& mesh, Encoding encoding);

/// The title line of .vtk files begins with this; the names follow, divided by commas, with %XX for blanks and signs.
inline constexpr std::string_view vtk_title_mark = "pliant tet mesh, regions: ";

/// Gmsh 4.1: regions are volumes 1, 2, ... and physical groups of the same number, with their names.
[[nodiscard]] std::string msh_bytes(const TetMesh& mesh, Encoding encoding);

/// Medit: regions are the references 1, 2, ...; a comment `# region 1 "root"` names each.
[[nodiscard]] std::string medit_text(const TetMesh& mesh);

/// *NODE, and an *ELEMENT card with an element set for each region.
[[nodiscard]] std::string inp_text(const TetMesh& mesh);

/// The element set of a region: its name where that is a label (a letter, then letters, digits, - or _, 60 at most, no
/// two equal but for case), else "R" and its number from 1. ccx knows no case and at most 80 characters.
[[nodiscard]] std::vector<std::string> inp_labels(const std::vector<std::string>& names);

/// `** region LABEL "name"` for every label that is not the name itself; readers other than ours pass it over.
[[nodiscard]] std::string inp_name_comments(const std::vector<std::string>& names);

}  // namespace pliant::mesh

// VTK XML unstructured grids (.vtu): a tet mesh in a given configuration with point and cell data. ParaView and every
// reader of the format open them. Arrays are zlib-compressed and inlined as base64.
// Format: VTK User's Guide, "XML file formats"; linear tets are cell type 10, quadratic ones 24.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

struct VtuArray {
    std::string name;
    int components = 1;
    std::variant<std::vector<float>, std::vector<double>, std::vector<std::int32_t>> values;  ///< (items * components)
};

struct VtuData {
    std::vector<VtuArray> points;           ///< one item per point of the mesh
    std::vector<VtuArray> cells;            ///< one item per tet
    std::vector<std::string> region_names;  ///< names for the cell array "region", written as field data; empty: not
                                            ///< written
};

/// The whole file. `points` (n, 3) replaces the points of the mesh, in the unit wanted in the file. Error: an array
/// whose length does not fit the mesh, named.
[[nodiscard]] Result<std::string> vtu_text(const TetMesh& mesh, std::span<const Vec3> points, const VtuData& data);

[[nodiscard]] Status write_vtu(const std::filesystem::path& path, const TetMesh& mesh, std::span<const Vec3> points,
                               const VtuData& data);

}  // namespace pliant::mesh

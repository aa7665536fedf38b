#include "geometry/files/tet_writer.hpp"

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

}  // namespace

Status write_tet_mesh(const std::filesystem::path& path, const TetMesh& mesh, Encoding encoding) {
    const std::string extension = path.extension().string();
    if (extension == ".vtk") return write_file(path, vtk_bytes(mesh, encoding));
    if (extension == ".vtu") return write_mesh_vtu(path, mesh);
    if (extension == ".msh") return write_file(path, msh_bytes(mesh, encoding));
    if (extension == ".mesh") return write_file(path, medit_text(mesh));
    if (extension == ".inp") return write_file(path, inp_text(mesh));
    return input_error("{}: unknown kind of mesh file; write {}", path.string(), tet_writer_list);
}

}  // namespace pliant::mesh

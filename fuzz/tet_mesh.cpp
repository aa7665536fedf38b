// Tet meshes of every format: .vtk, .vtu, .msh.
#include "input.hpp"
#include "mesh/mesh_report.hpp"
#include "mesh/tet_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto mesh = pliant::mesh::parse_tet_mesh(as_text(data, size), "fuzz.mesh");
    if (mesh) (void)pliant::mesh::report_on(*mesh);
    return 0;
}

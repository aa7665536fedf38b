// One target per reader of tet meshes: PLIANT_PARSER is parse_vtk, parse_vtu, parse_msh, parse_medit, parse_inp or
// parse_gid.
#include "geometry/files/tet_file.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto mesh = pliant::mesh::PLIANT_PARSER(as_text(data, size), "fuzz.mesh");
    if (mesh) (void)pliant::mesh::report_on(*mesh);
    return 0;
}

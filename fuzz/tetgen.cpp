// TetGen's two files, separated by the first zero byte.
#include <algorithm>

#include "geometry/files/tet_file.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view both = as_text(data, size);
    const std::size_t cut = std::min(both.find('\0'), both.size());
    const std::string_view tets = both.substr(std::min(cut + 1, both.size()));
    const auto mesh = pliant::mesh::parse_tetgen(both.substr(0, cut), "fuzz.node", tets, "fuzz.ele");
    if (mesh) (void)pliant::mesh::report_on(*mesh);
    return 0;
}

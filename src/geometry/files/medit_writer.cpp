// Medit mesh files as text. Format: see medit_reader.cpp.
#include <fmt/format.h>

#include "geometry/files/tet_writer.hpp"

namespace pliant::mesh {

std::string medit_text(const TetMesh& mesh) {
    std::string text = "MeshVersionFormatted 2\nDimension 3\n";
    const auto out = std::back_inserter(text);
    for (std::size_t r = 0; r < mesh.region_names.size(); ++r) {
        std::string name = mesh.region_names[r];
        for (char& c : name) c = c == '\n' ? ' ' : c;
        fmt::format_to(out, "# region {} \"{}\"\n", r + 1, name);
    }
    fmt::format_to(out, "Vertices\n{}\n", mesh.points.size());
    for (const Vec3& p : mesh.points) fmt::format_to(out, "{} {} {} 0\n", p.x, p.y, p.z);
    fmt::format_to(out, "{}\n{}\n", mesh.order == 2 ? "TetrahedraP2" : "Tetrahedra", mesh.tet_count());
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        for (const int node : mesh.tet(t)) fmt::format_to(out, "{} ", node + 1);
        fmt::format_to(out, "{}\n", mesh.region[t] + 1);
    }
    text += "End\n";
    return text;
}

}  // namespace pliant::mesh

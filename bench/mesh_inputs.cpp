// Meshes every surface and 3MF body of the files that it is given, by itself, and prints a table: the dihedral angles
// of docs/performance.md.
//     pliant_mesh_inputs DIVISIONS FILE...        the mesh size is the longest side over DIVISIONS
#include <fmt/core.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/core/files.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/threemf/read_3mf.hpp"

using namespace pliant;

namespace {

/// Processor time, which other work on the machine does not change.
double seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

void row(const std::string& name, const mesh::TriMesh& surface, double divisions) {
    const Vec3 d = mesh::bounds(surface).size();
    Progress silent;
    const double before = seconds();
    const Result<mesh::TetMesh> mesh =
        mesh::mesh_bodies(std::vector<mesh::BodyGeometry>{{"it", surface}},
                          {.size = std::max({d.x, d.y, d.z}) / divisions, .order = 1}, silent);
    const double time = seconds() - before;
    if (!mesh) {
        fmt::print("| {} | {} | {:.1f} | | | refused: {} |\n", name, surface.triangles.size(), time,
                   mesh.error().message);
    } else {
        std::string notes;
        for (const std::string& note : mesh->notes) notes += (notes.empty() ? "" : "; ") + note;
        fmt::print("| {} | {} | {:.1f} | {} | {:.1f}° | {} |\n", name, surface.triangles.size(), time,
                   mesh->tet_count(), mesh::smallest_dihedral_deg(*mesh), notes);
    }
    std::fflush(stdout);
}

void rows(const std::filesystem::path& file, double divisions) {
    const std::string name = file.filename().string();
    const Result<std::string> bytes = read_file(file);
    if (bytes && threemf::looks_like_zip(*bytes)) {
        const Result<threemf::ThreeMf> read = threemf::read_3mf(file);
        if (!read) return fmt::print("| {} | | | | | not read: {} |\n", name, read.error().message);
        for (const threemf::Body& body : read->bodies) row(name + ": " + body.name, body.mesh_mm, divisions);
        return;
    }
    const Result<mesh::SurfaceFile> read = mesh::read_surface(file);
    if (!read) return fmt::print("| {} | | | | | not read: {} |\n", name, read.error().message);
    row(name, read->mesh, divisions);
}

}  // namespace

int main(int count, char** arguments) {
    const double divisions = count > 2 ? std::atof(arguments[1]) : 0;
    if (!(divisions > 0)) {
        fmt::print(stderr, "usage: pliant_mesh_inputs DIVISIONS FILE...\n");
        return 2;
    }
    fmt::print("| file | triangles | s | tets | smallest angle | notes |\n| --- | --- | --- | --- | --- | --- |\n");
    for (int i = 2; i < count; ++i) rows(arguments[i], divisions);
    return 0;
}

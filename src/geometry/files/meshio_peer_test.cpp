// Compares our readers and writers with meshio, an independent program: the same nodes, tets and volumes both ways.
#include <doctest/doctest.h>

#include <cstdlib>
#include <sstream>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"

using namespace pliant;
using namespace pliant::mesh;
using pliant::test::Folder;
namespace fs = std::filesystem;

namespace {

/// A block of 3 x 2 x 2 cubes of five tets each, in two regions, stretched so that no two edges are equal.
TetMesh block() {
    TetMesh mesh;
    const auto node = [](int i, int j, int k) { return (i * 3 + j) * 3 + k; };
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < 3; ++k) mesh.points.push_back({1.1 * i, 0.9 * j + 0.1 * i * i, 0.7 * k + 1e-3 * j * j});
        }
    }
    constexpr std::array<std::array<int, 4>, 10> corners = {{{0, 1, 2, 4},
                                                             {1, 3, 2, 7},
                                                             {1, 2, 4, 7},
                                                             {1, 4, 5, 7},
                                                             {2, 4, 7, 6},
                                                             {0, 1, 3, 5},
                                                             {0, 3, 2, 6},
                                                             {0, 3, 5, 6},
                                                             {0, 4, 5, 6},
                                                             {3, 5, 6, 7}}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 2; ++j) {
            for (int k = 0; k < 2; ++k) {
                for (std::size_t t = 0; t < 5; ++t) {
                    for (const int c : corners[t + ((i + j + k) % 2 == 0 ? 0 : 5)])
                        mesh.nodes.push_back(node(i + c % 2, j + c / 2 % 2, k + c / 4));
                    mesh.region.push_back(i == 0 ? 0 : 1);
                }
            }
        }
    }
    mesh.region_names = {"root part", "tip"};
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        int* n = mesh.nodes.data() + 4 * t;
        if (signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]) < 0)
            std::swap(n[1], n[2]);
    }
    return mesh;
}

/// Runs meshio_peer.py with the Python that meshio itself runs with.
std::string meshio(const Folder& folder, const std::string& arguments) {
    const fs::path out = folder.path() / "out.txt";
    const std::string command =
        fmt::format("$(head -1 \"$(command -v meshio)\" | cut -c3-) src/geometry/files/meshio_peer.py {} >'{}' 2>'{}'",
                    arguments, out.string(), (folder.path() / "errors.txt").string());
    const int status = std::system(command.c_str());
    const auto errors = read_file(folder.path() / "errors.txt");
    REQUIRE_MESSAGE(status == 0, (errors ? *errors : "no meshio"));
    const auto text = read_file(out);
    REQUIRE(text);
    return *text;
}

void check_read_by_meshio(const Folder& folder, const TetMesh& mesh, const std::vector<std::string>& names) {
    std::string arguments = "read";
    for (const std::string& name : names) arguments += fmt::format(" '{}'", (folder.path() / name).string());
    std::istringstream rows(meshio(folder, arguments));
    for (const std::string& name : names) {
        CAPTURE(name);
        int width = 0;
        std::size_t tets = 0;
        std::size_t points = 0;
        double found = 0;
        const bool complete = static_cast<bool>(rows >> width >> tets >> points >> found);
        REQUIRE(complete);
        CHECK(width == mesh.nodes_per_tet());
        CHECK(tets == mesh.tet_count());
        CHECK(points == mesh.points.size());
        CHECK(found == near(volume(mesh), {.relative = 1e-12}));
    }
}

}  // namespace

TEST_CASE("meshio reads what Pliant writes: same nodes, tets and volume") {
    for (const TetMesh& mesh : {block(), to_quadratic(block())}) {
        const Folder folder;
        REQUIRE(write_tet_mesh(folder.path() / "text.vtk", mesh, Encoding::text));
        REQUIRE(write_tet_mesh(folder.path() / "text.msh", mesh, Encoding::text));
        for (const char* name : {"binary.vtk", "binary.msh", "zlib.vtu", "deck.inp", "medit.mesh"})
            REQUIRE(write_tet_mesh(folder.path() / name, mesh));
        std::vector<std::string> names = {"text.vtk", "text.msh", "binary.vtk", "binary.msh", "zlib.vtu", "deck.inp"};
        if (mesh.order == 1) names.emplace_back("medit.mesh");  // meshio has no TetrahedraP2
        check_read_by_meshio(folder, mesh, names);
    }
}

TEST_CASE("Pliant reads what meshio writes: same nodes, tets, regions and volumes") {
    for (const TetMesh& mesh : {block(), to_quadratic(block())}) {
        const Folder folder;
        const fs::path source = folder.path() / "source.vtk";
        REQUIRE(write_tet_mesh(source, mesh));
        const fs::path written = folder.path() / "written";
        fs::create_directories(written);
        meshio(folder, fmt::format("write '{}' '{}'", source.string(), written.string()));
        std::size_t files = 0;
        for (const auto& entry : fs::directory_iterator(written)) {
            const std::string name = entry.path().filename().string();
            CAPTURE(name);
            const Result<TetMesh> back = read_tet_mesh(entry.path());
            REQUIRE_MESSAGE(back, (back ? "" : back.error().message));
            ++files;
            CHECK(back->order == mesh.order);
            CHECK(back->tet_count() == mesh.tet_count());
            CHECK(back->points.size() == mesh.points.size());
            CHECK(volume(*back) == near(volume(mesh), {.relative = 1e-12}));
            // meshio's Abaqus, TetGen and Gmsh 4 writers lose data whose names they do not know.
            if (name == "deck.inp" || name.starts_with("pair") || name.ends_with("4.msh")) continue;
            CHECK(back->region == mesh.region);
        }
        CHECK(files == (mesh.order == 1 ? 13u : 10u));
    }
}

// Compares our readers and writers with Gmsh's own: the same nodes, tets and volumes both ways.
#include <doctest/doctest.h>
#include <gmsh.h>

#include <algorithm>
#include <filesystem>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"

using namespace pliant;
using namespace pliant::mesh;
namespace fs = std::filesystem;

namespace {

/// A silent Gmsh session with a folder of its own.
class Bench {
public:
    Bench() {
        gmsh::initialize(0, nullptr, false);
        gmsh::option::setNumber("General.Terminal", 0);
        gmsh::option::setNumber("General.AbortOnError", 2);
    }
    ~Bench() { gmsh::finalize(); }
    Bench(const Bench&) = delete;
    Bench& operator=(const Bench&) = delete;
    [[nodiscard]] const fs::path& folder() const { return folder_.path(); }

    /// Two cubes side by side, in named groups.
    void draw(int order) {
        gmsh::model::add("cubes");
        namespace occ = gmsh::model::occ;
        gmsh::vectorpair out;
        std::vector<gmsh::vectorpair> parts;
        occ::fragment({{3, occ::addBox(0, 0, 0, 1, 1, 1)}}, {{3, occ::addBox(1, 0, 0, 1, 1, 1)}}, out, parts);
        occ::synchronize();
        gmsh::model::addPhysicalGroup(3, {out[0].second}, 5);
        gmsh::model::setPhysicalName(3, 5, "left half");
        gmsh::model::addPhysicalGroup(3, {out[1].second}, 9);
        gmsh::model::setPhysicalName(3, 9, "right");
        gmsh::option::setNumber("Mesh.MeshSizeMax", 0.6);
        gmsh::model::mesh::generate(3);
        gmsh::model::mesh::setOrder(order);
    }
    static std::size_t tets(int order) {
        std::vector<std::size_t> elements;
        std::vector<std::size_t> nodes;
        gmsh::model::mesh::getElementsByType(order == 2 ? 11 : 4, elements, nodes);
        return elements.size();
    }

private:
    pliant::test::Folder folder_{"gmsh_files"};
};

void check_cubes(const fs::path& file, int order, std::size_t tets, bool named) {
    CAPTURE(file.filename().string());
    const Result<TetMesh> mesh = read_tet_mesh(file);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->order == order);
    CHECK(mesh->tet_count() == tets);
    CHECK(mesh->notes.empty());
    CHECK(volume(*mesh) == near(2, {.relative = 1e-12}));
    std::vector<std::string> names = mesh->region_names;
    std::sort(names.begin(), names.end());
    if (named) CHECK(names == std::vector<std::string>{"left half", "right"});
    if (mesh->region_names.size() > 1) CHECK(volume(*mesh, 0) == near(1, {.relative = 1e-12}));
    const Vec3 middle = 0.5 * (mesh->points[mesh->tet(0)[0]] + mesh->points[mesh->tet(0)[1]]);
    if (order == 2) CHECK(norm(mesh->points[mesh->tet(0)[4]] - middle) < 1e-12);
}

}  // namespace

TEST_CASE("Pliant reads what Gmsh writes") {
    for (const int order : {1, 2}) {
        Bench bench;
        bench.draw(order);
        for (const double version : {2.2, 4.1}) {
            for (const double binary : {0.0, 1.0}) {
                gmsh::option::setNumber("Mesh.MshFileVersion", version);
                gmsh::option::setNumber("Mesh.Binary", binary);
                const fs::path file = bench.folder() / fmt::format("{}_{}.msh", version, binary);
                gmsh::write(file.string());
                check_cubes(file, order, Bench::tets(order), true);
            }
        }
        for (const char* name : {"binary.vtk", "text.vtk", "text.mesh", "text.inp"}) {
            gmsh::option::setNumber("Mesh.Binary", name[0] == 'b' ? 1 : 0);
            gmsh::write((bench.folder() / name).string());
            check_cubes(bench.folder() / name, order, Bench::tets(order), false);
        }
    }
}

TEST_CASE("Gmsh reads what Pliant writes") {
    for (const int order : {1, 2}) {
        Bench bench;
        bench.draw(order);
        const std::size_t tets = Bench::tets(order);
        gmsh::write((bench.folder() / "source.msh").string());
        const Result<TetMesh> mesh = read_tet_mesh(bench.folder() / "source.msh");
        REQUIRE(mesh);
        for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
            for (const std::string name : {"a.msh", "a.vtk"}) {
                CAPTURE(name);
                REQUIRE(write_tet_mesh(bench.folder() / name, *mesh, encoding));
                gmsh::clear();
                gmsh::open((bench.folder() / name).string());
                CHECK(Bench::tets(order) == tets);
                std::vector<std::size_t> tags;
                std::vector<double> coordinates;
                std::vector<double> parameters;
                gmsh::model::mesh::getNodes(tags, coordinates, parameters);
                CHECK(tags.size() == mesh->points.size());
                if (name != "a.msh") continue;
                std::string group;
                gmsh::model::getPhysicalName(3, 2, group);
                CHECK(group == mesh->region_names[1]);
            }
        }
    }
}

// Geometry files uploaded by a page.
#include "studio/files/received_file.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <fstream>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "studio/files/test_surface.hpp"

using namespace pliant;
using namespace pliant::studio;
using pliant::studio::test::tetra;
using pliant::test::holds;
namespace fs = std::filesystem;

namespace {

struct UploadBench {
    pliant::test::Folder folder{"received"};
    ProjectFolder project = ProjectFolder::open(folder.path()).value();

    Result<ReceivedGeometry> send(const std::string& name, const std::string& bytes, bool replace = false,
                                  bool length_known = true, long long largest = largest_geometry) {
        std::size_t at = 0;
        const ReadMore more = [&](char* into, std::size_t most) {
            const std::size_t n = std::min({most, bytes.size() - at, std::size_t{100}});
            std::memcpy(into, bytes.data() + at, n);
            at += n;
            return static_cast<long long>(n);
        };
        return receive_geometry(project, name, replace, length_known ? static_cast<long long>(bytes.size()) : -1, more,
                                largest);
    }
    [[nodiscard]] std::size_t files() const {
        std::size_t n = 0;
        for (const auto& entry : fs::directory_iterator(folder.path())) n += entry.exists() ? 1 : 0;
        return n;
    }
};

std::string refused_file(const Result<ReceivedGeometry>& received) {
    return received ? "" : received.error().message;
}

}  // namespace

TEST_CASE("a surface file is received whole and measured, and replaces another file only on request") {
    UploadBench b;
    for (const bool known : {true, false}) {
        const auto received = b.send(known ? "a.stl" : "b.STL", tetra(10), false, known);
        REQUIRE(received);
        CHECK(received->how == Received::written);
        CHECK(received->content.kind == "surface");
        CHECK(received->content.unit_mm == 0);
        CHECK(received->content.text == "surface, 4 triangles");
        CHECK(received->content.box.size().x == near(10, {.relative = 1e-12}));
    }
    CHECK(read_file(b.folder.path() / "a.stl").value() == tetra(10));
    CHECK(b.send("a.stl", tetra(10))->how == Received::same_as_there);
    CHECK(b.send("a.stl", tetra(20))->how == Received::name_is_taken);
    CHECK(read_file(b.folder.path() / "a.stl").value() == tetra(10));
    CHECK(b.send("a.stl", tetra(20), true)->how == Received::written);
    CHECK(read_file(b.folder.path() / "a.stl").value() == tetra(20));
    fs::create_directory(b.folder.path() / "c.stl");
    CHECK(b.send("c.stl", tetra(20), true)->how == Received::name_is_taken);
    CHECK(b.files() == 3);
}

TEST_CASE("paths, hidden names and unknown extensions are refused, and nothing is written") {
    UploadBench b;
    for (const char* name : {"", ".stl", ".hidden.stl", "../up.stl", "/etc/x.stl", "sub/x.stl", "a\\b.stl", "a\nb.stl",
                             "c:x.stl", "quote\".stl"}) {
        INFO(name);
        CHECK(holds(refused_file(b.send(name, tetra(10))), "a plain name"));
    }
    CHECK(holds(refused_file(b.send(std::string(200, 'x') + ".stl", tetra(10))), "at most 120 bytes"));
    for (const char* name : {"robot.toml", "job.zip", "a.stl.exe", "stl"})
        CHECK(holds(refused_file(b.send(name, tetra(10))), "is not geometry that Pliant reads by its ending"));
    CHECK(b.files() == 0);
}

TEST_CASE("a link that leads out of the folder is not written through") {
    UploadBench b;
    const pliant::test::Folder elsewhere("received_elsewhere");
    std::ofstream(elsewhere.path() / "precious.stl") << "mine";
    fs::create_symlink(elsewhere.path() / "precious.stl", b.folder.path() / "a.stl");
    CHECK(holds(refused_file(b.send("a.stl", tetra(10), true)), "leads outside"));
    CHECK(read_file(elsewhere.path() / "precious.stl").value() == "mine");
}

TEST_CASE("unreadable, oversized and broken-off files are refused and leave nothing") {
    UploadBench b;
    const std::string cut = tetra(10).substr(0, 120);
    const std::string why = refused_file(b.send("cut.stl", cut));
    CHECK(why.starts_with("cut.stl:"));
    CHECK_FALSE(holds(why, ".partial"));
    CHECK(refused_file(b.send("noise.step", "no step at all")).starts_with("noise.step:"));
    CHECK(holds(refused_file(b.send("empty.stl", "")), "empty"));
    for (const bool known : {true, false})
        CHECK(holds(refused_file(b.send("big.stl", tetra(10), false, known, 300)), "larger than"));
    const ReadMore broken = [](char*, std::size_t) { return -1LL; };
    CHECK(holds(refused_file(receive_geometry(b.project, "a.stl", false, 10, broken)), "the connection was lost"));
    const ReadMore short_one = [](char*, std::size_t) { return 0LL; };
    CHECK(holds(refused_file(receive_geometry(b.project, "a.stl", false, 10, short_one)), "the connection was lost"));
    CHECK(b.files() == 0);
}

TEST_CASE("regions of a tet mesh are listed as parts") {
    UploadBench b;
    const auto received = b.send("two.mesh",
                                 "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 "
                                 "0\n0 0 -1 0\nTetrahedra\n2\n1 2 3 4 1\n1 3 2 5 2\nEnd\n");
    REQUIRE(received);
    CHECK(received->content.kind == "tets");
    CHECK(received->content.parts.size() == 2);
    CHECK(received->content.box.size().z == near(2, {.relative = 1e-12}));
}

#include "geometry/shapes/flat_faces.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/mesher/mesher.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

Solid combined(CombinedSolid::Operation operation, std::vector<Solid> parts) {
    return solid(CombinedSolid{operation, std::move(parts)});
}

TriMesh triangles(const Solid& shape, double tolerance = 0.05) {
    const Result<TriMesh> surface = tessellate(shape, tolerance);
    REQUIRE(surface);
    return *surface;
}

/// Coordinates rounded as in an STL file.
TriMesh rounded(TriMesh surface) {
    for (Vec3& p : surface.points) p = {double(float(p.x)), double(float(p.y)), double(float(p.z))};
    return surface;
}

std::size_t face_count(const FacetedSurface& surface) {
    std::size_t count = 0;
    for (const auto& piece : surface.pieces) {
        for (const auto& shell : piece) count += shell.size();
    }
    return count;
}

/// Rotated so that no face is parallel to an axis.
Solid askew(const Solid& shape) {
    return solid(RotatedSolid{shape, {1, 2, 3}, {1, 0.3, 0.7}, 0.6});
}

TetMesh mesh_of(const std::vector<BodyGeometry>& bodies, double size) {
    Progress silent;
    Result<TetMesh> mesh = mesh_bodies(bodies, {.size = size, .order = 1, .close_gaps = 1e-3 * size}, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    return *mesh;
}

/// Area that two regions share, by the nodes of their faces.
double shared_area(const TetMesh& mesh, int one, int other) {
    const auto key = [](const Face& face) {
        std::array<int, 3> nodes = {face.nodes[0], face.nodes[1], face.nodes[2]};
        std::sort(nodes.begin(), nodes.end());
        return nodes;
    };
    std::vector<std::array<int, 3>> theirs;
    for (const Face& face : region_faces(mesh, other)) theirs.push_back(key(face));
    std::sort(theirs.begin(), theirs.end());
    double area = 0;
    for (const Face& face : region_faces(mesh, one)) {
        if (!std::binary_search(theirs.begin(), theirs.end(), key(face))) continue;
        const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(face.nodes[k])]; };
        area += norm(cross(at(1) - at(0), at(2) - at(0))) / 2;
    }
    return area;
}

using Operation = CombinedSolid::Operation;

}  // namespace

TEST_CASE("triangles are merged into the drawn faces: also with holes, cavities and 32-bit coordinates") {
    const Solid frame = combined(Operation::subtract, {box({0, 0, 0}, {9, 8, 7}), box({2, 2, -1}, {5, 5, 8})});
    const Solid hollow = combined(Operation::subtract, {box({0, 0, 0}, {9, 8, 7}), box({2, 2, 2}, {5, 5, 5})});
    struct Row {
        Solid shape;
        std::size_t faces, shells;
        double volume;
    };
    for (const Row& row :
         {Row{box({0, 0, 0}, {1, 2, 3}), 6, 1, 6}, Row{frame, 10, 1, 504 - 63}, Row{hollow, 12, 2, 504 - 27}}) {
        for (const Solid& shape : {row.shape, askew(row.shape)}) {
            const TriMesh surface = rounded(triangles(shape));
            const Result<FacetedSurface> faceted = flat_faces(surface, 100);
            REQUIRE_MESSAGE(faceted, (faceted ? "" : faceted.error().message));
            CHECK(face_count(*faceted) == row.faces);
            REQUIRE(faceted->pieces.size() == 1);
            CHECK(faceted->pieces[0].size() == row.shells);
            const Result<Solid> whole = polyhedron(surface);
            REQUIRE(whole);
            const Result<double> volume = solid_volume(*whole);
            REQUIRE_MESSAGE(volume, (volume ? "" : volume.error().message));
            CHECK(*volume == near(row.volume, {.relative = 1e-5}));
        }
    }
}

TEST_CASE("open surfaces and those with too many faces are refused with a reason") {
    TriMesh open = triangles(box({0, 0, 0}, {1, 1, 1}));
    open.triangles.pop_back();
    CHECK_FALSE(flat_faces(open, 100));
    const Result<FacetedSurface> many = flat_faces(triangles(solid(SphereSolid{{0, 0, 0}, 5})), 100);
    REQUIRE_FALSE(many);
    CHECK(many.error().message.find("up to 100 can be joined") != std::string::npos);
}

TEST_CASE("surfaces that touch each other or a drawn body share the nodes of their common face") {
    const TriMesh below = rounded(triangles(askew(box({0, 0, 0}, {20, 20, 5}))));
    const TriMesh above = rounded(triangles(askew(box({5, 5, 5}, {12, 12, 15}))));
    const TetMesh both = mesh_of({{"below", below}, {"above", above}}, 3);
    CHECK(volume(both, 0) == near(2000, {.relative = 1e-4}));
    CHECK(volume(both, 1) == near(490, {.relative = 1e-4}));
    CHECK(shared_area(both, 0, 1) == near(49, {.relative = 1e-4}));
    const TetMesh mixed = mesh_of({{"below", below}, {"above", askew(box({5, 5, 5}, {12, 12, 15}))}}, 3);
    CHECK(shared_area(mixed, 0, 1) == near(49, {.relative = 1e-12}));
}

TEST_CASE("an overlap of surfaces goes to the later one") {
    const TriMesh plate = triangles(box({0, 0, 0}, {20, 20, 5}));
    const TriMesh pin = rounded(triangles(askew(box({0, 0, 0}, {4, 4, 10}))));
    const TetMesh mesh = mesh_of({{"pin", pin}, {"plate", plate}}, 3);
    CHECK(volume(mesh, 1) == near(2000, {.relative = 1e-12}));
    REQUIRE(mesh.notes.size() >= 1);
    CHECK(mesh.notes[0].find("overlap") != std::string::npos);
}

TEST_CASE("a prism of 48 corners counts as round, one of 12 does not") {
    for (const int corners : {12, 48}) {
        TriMesh prism{{{0, 0, 0}, {0, 0, 10}}, {}};
        for (int i = 0; i < corners; ++i) {
            const double turn = 2 * std::numbers::pi * i / corners;
            for (const double z : {0.0, 10.0}) prism.points.push_back({5 * std::cos(turn), 5 * std::sin(turn), z});
            const int a = 2 + 2 * i;
            const int b = 2 + 2 * ((i + 1) % corners);
            prism.triangles.insert(prism.triangles.end(),
                                   {{a, b, b + 1}, {a, b + 1, a + 1}, {0, b, a}, {1, a + 1, b + 1}});
        }
        const Result<Solid> whole = polyhedron(prism);
        CHECK(whole.has_value() == (corners == 12));
        if (!whole) CHECK(whole.error().message.find("round: 48 of its") != std::string::npos);
    }
}

TEST_CASE("a faceted cylinder is not a polyhedron; with a plate it gives one mesh and a note on the overlap") {
    const TriMesh plate = triangles(box({0, 0, 0}, {20, 20, 5}));
    const Solid rod = solid(CylinderSolid{{10, 10, 2}, {10, 10, 15}, 3});
    const TriMesh pin = triangles(solid(RepeatedSolid{rod, 1, {}}), 0.3);  // by the mesher: no straight sides
    CHECK_FALSE(polyhedron(pin));
    const TetMesh mesh = mesh_of({{"plate", plate}, {"pin", pin}}, 1.5);
    const double whole = signed_volume(pin);
    CHECK(whole == near(9 * std::numbers::pi * 13, {.relative = 0.05}));
    CHECK(volume(mesh, 1) == near(whole, {.relative = 0.02}));
    CHECK(volume(mesh, 0) == near(2000 - whole * 3 / 13, {.relative = 0.005}));
    REQUIRE(mesh.notes.size() == 2);
    CHECK(mesh.notes[1].find("body \"plate\" and body \"pin\" overlap by about 8") != std::string::npos);
}

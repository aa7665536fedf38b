#include "geometry/mesher/packing.hpp"

#include <doctest/doctest.h>

#include "geometry/mesh/test_shapes.hpp"
#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/shapes/flat_faces.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;

namespace {

template <class T>
std::string bytes_of(const T& value) {
    Packer out;
    pack(out, value);
    return out.take();
}

/// The bytes of a value that was written, read and written again.
template <class T>
std::string bytes_after(const T& value) {
    const std::string bytes = bytes_of(value);
    Unpacker in(bytes);
    T read{};
    unpack(in, read);
    CHECK(in.finished());
    return bytes_of(read);
}

/// A solid of every type, nested where a type contains others.
Solid every_kind() {
    const Solid ball = solid(SphereSolid{{1, 2, 3}, 4});
    const Solid rod = solid(CylinderSolid{{0, 0, 0}, {0, 0, 1. / 3}, 2});
    const Solid prism = solid(PrismSolid{{{0, 0}, {4, 0}, {0, 3}}, {0, 2, 1}, -1, 10});
    const Solid faces = *polyhedron(tetrahedron());
    const Solid step = solid(StepSolid{"part.step", {0, 2}, 1e-3, std::make_shared<const TriangleTree>(tetrahedron())});
    const Solid moved = solid(TranslatedSolid{solid(RotatedSolid{rod, {1, 1, 1}, {0, 1, 0}, 0.5}), {1, 2, 3}});
    const Solid row = solid(RepeatedSolid{moved, 6, {14, 0, 0}});
    const Solid air = solid(EnclosedSolid{{1, 1, 1}, {row, ball}});
    const Solid gaps = solid(NotchesSolid{{prism}, {{3, 2, 1}}, {faces, step}});
    return solid(CombinedSolid{CombinedSolid::Operation::subtract, {box({0, 0, 0}, {9, 9, 9}), air, gaps}});
}

}  // namespace

TEST_CASE("what is sent to the mesher arrives bit for bit") {
    CHECK(bytes_after(every_kind()) == bytes_of(every_kind()));
    CHECK(bytes_of(every_kind()).size() > 500);
    CHECK(bytes_after(BodyGeometry{"tip", every_kind(), true, 0.1}) ==
          bytes_of(BodyGeometry{"tip", every_kind(), true, 0.1}));
    CHECK(bytes_after(BodyGeometry{"part", tetrahedron()}) == bytes_of(BodyGeometry{"part", tetrahedron()}));
    const std::vector<BodyGeometry> bodies{{"tip", every_kind(), true, 0.1}, {"part", tetrahedron()}};
    CHECK(bytes_of(std::span<const BodyGeometry>(bodies)) == bytes_after(bodies));
    MeshSettings settings{.size = 0.1, .order = 1, .through_wall = 3, .judge_walls = true, .close_gaps = 1e-3};
    settings.cables = {{{0, 0, 0}, {1, 0, 0}}, {}};
    CHECK(bytes_after(settings) == bytes_of(settings));
}

TEST_CASE("what the mesher sends back arrives bit for bit") {
    const TetMesh mesh{1, tetrahedron().points, {0, 1, 2, 3}, {0}, {"body"}, {"a note"}};
    CHECK(bytes_after(mesh) == bytes_of(mesh));
    const StepContent content{{"lid"}, {tetrahedron()}};
    CHECK(bytes_after(content) == bytes_of(content));
    const Error error = error_of(Cause::failed, {{"robot.toml", 12, "body \"tip\"", "is empty"}, {"", 0, "", "a sum"}});
    CHECK(bytes_after(error) == bytes_of(error));
    const std::vector<Notch> notches{{every_kind(), {1, 2, 3}, {0, 0, 0}, {0.1, 0.2, 0.3}}};
    CHECK(bytes_after(notches) == bytes_of(notches));
}

TEST_CASE("bytes that end early, have wrong counts or wrong indices are refused") {
    const auto readable = [](const std::string& bytes) {
        Unpacker in(bytes);
        BodyGeometry body;
        unpack(in, body);
        return in.finished();
    };
    const std::string whole = bytes_of(BodyGeometry{"tip", every_kind()});
    REQUIRE(readable(whole));
    for (std::size_t size = 0; size < whole.size(); ++size) CHECK_FALSE(readable(whole.substr(0, size)));
    CHECK_FALSE(readable(whole + "x"));

    std::string nowhere = bytes_of(BodyGeometry{"part", TriMesh{{{0, 0, 0}}, {{0, 0, 1}}}});
    CHECK_FALSE(readable(nowhere));

    Packer huge;
    huge.number<std::uint64_t>(1ULL << 60U);  // the length of a name
    CHECK_FALSE(readable(huge.take()));
}

TEST_CASE("solids nested too deep are refused") {
    Solid deep = box({0, 0, 0}, {1, 1, 1});
    for (int k = 0; k < 1000; ++k) deep = solid(TranslatedSolid{deep, {1, 0, 0}});
    const std::string bytes = bytes_of(deep);
    Unpacker in(bytes);
    Solid read;
    unpack(in, read);
    CHECK_FALSE(in.finished());
}

#include "geometry/files/surface_mending.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "geometry/files/test_surfaces.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;
using namespace pliant::mesh;
using namespace pliant::mesh::test;
using pliant::test::holds;

namespace {

/// A torus around z: 2 x across x along triangles.
TriMesh torus(double big, double small, int along, int across) {
    TriMesh mesh;
    const auto turn = [](int i, int n) { return 2 * std::numbers::pi * i / n; };
    for (int i = 0; i < along; ++i) {
        for (int j = 0; j < across; ++j) {
            const double r = big + small * std::cos(turn(j, across));
            mesh.points.push_back(
                {r * std::cos(turn(i, along)), r * std::sin(turn(i, along)), small * std::sin(turn(j, across))});
        }
    }
    const auto at = [&](int i, int j) { return (i % along) * across + j % across; };
    for (int i = 0; i < along; ++i) {
        for (int j = 0; j < across; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

TriMesh moved(TriMesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.points) p += by;
    return mesh;
}

TriMesh in_floats(TriMesh mesh) {
    for (Vec3& p : mesh.points) {
        for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<float>(p[k]);
    }
    return mesh;
}

/// A triangle soup without shared points; a fraction `share` of the points is moved by up to `steps` float steps along
/// each axis.
TriMesh jittered(const TriMesh& mesh, double share, int steps, unsigned seed) {
    std::mt19937 random(seed);
    const auto chance = [&] { return static_cast<double>(random()) / 4294967296.0; };
    TriMesh soup;
    for (const auto& t : mesh.triangles) {
        for (const int corner : t) {
            Vec3 p = mesh.points[static_cast<std::size_t>(corner)];
            const bool move = chance() < share;
            for (std::size_t k = 0; k < 3 && move; ++k) {
                const int by = static_cast<int>(random() % static_cast<unsigned>(2 * steps + 1)) - steps;
                auto c = static_cast<float>(p[k]);
                for (int i = 0; i < std::abs(by); ++i) c = std::nextafter(c, by > 0 ? 1e30F : -1e30F);
                p[k] = static_cast<double>(c);
            }
            soup.points.push_back(p);
        }
        const int n = static_cast<int>(soup.points.size());
        soup.triangles.push_back({n - 3, n - 2, n - 1});
    }
    return soup;
}

/// Text whose numbers are formatted by `print`.
std::string text_stl(const TriMesh& soup, const std::function<std::string(double)>& print) {
    std::string text = "solid\n";
    for (const auto& t : soup.triangles) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int corner : t) {
            const Vec3& p = soup.points[static_cast<std::size_t>(corner)];
            text += fmt::format("vertex {} {} {}\n", print(p.x), print(p.y), print(p.z));
        }
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid\n";
}

SurfaceFile read(const std::string& bytes) {
    Result<SurfaceFile> file = parse_surface(bytes, "a.stl");
    REQUIRE_MESSAGE(file, (file ? "" : file.error().message));
    return *file;
}

struct Shape {
    const char* name;
    TriMesh mesh;
};

std::vector<Shape> shapes() {
    TriMesh plate = cube({0, 0, 0}, 50);
    for (Vec3& p : plate.points) p.z /= 500;  // a tenth of a millimetre
    return {{"cube", cube({-3.3, 1.7, 0}, 10)},
            {"plate", plate},
            {"torus", torus(20, 5, 60, 24)},
            {"far torus", moved(torus(20, 5, 60, 24), {1000, -2000, 500})},
            {"fine torus", torus(20, 5, 300, 100)},
            {"hollow", joined(cube({0, 0, 0}, 100), [] {
                 TriMesh inner = cube({20.1, 30.2, 40.3}, 30);
                 for (auto& t : inner.triangles) std::swap(t[1], t[2]);
                 return inner;
             }())}};
}

}  // namespace

TEST_CASE("mending: corners some float steps apart are joined; volume and corners stay") {
    unsigned seed = 1;
    for (const Shape& shape : shapes()) {
        const TriMesh exact = in_floats(shape.mesh);
        for (const auto& [share, steps] : {std::pair{0.05, 1}, {0.2, 1}, {1.0, 1}, {0.3, 4}, {1.0, 4}}) {
            CAPTURE(shape.name);
            CAPTURE(share);
            CAPTURE(steps);
            const SurfaceFile file = read(binary_stl(jittered(exact, share, steps, ++seed)));
            CHECK(check_closed(file.mesh));
            CHECK(file.mesh.points.size() == exact.points.size());
            CHECK(file.mesh.triangles.size() == exact.triangles.size());
            CHECK(signed_volume(file.mesh) == near(signed_volume(exact), {.relative = 1e-4}));
            REQUIRE(file.warnings.size() == 1);
            CHECK(holds(file.warnings[0], "point(s) at open edges lay within"));
        }
        const SurfaceFile clean = read(binary_stl(exact));
        CHECK(clean.warnings.empty());
        CHECK(clean.mesh.points.size() == exact.points.size());
    }
}

TEST_CASE("mending: the tolerance follows from the number of digits in a text file") {
    const TriMesh exact = torus(20, 5, 60, 24);
    std::mt19937 random(7);
    const auto off_by_one = [&](double value, double step) {
        const int by = random() % 5 == 0 ? static_cast<int>(random() % 3) - 1 : 0;
        return std::round(value / step) * step + by * step;
    };
    const TriMesh soup = jittered(exact, 0, 1, 1);
    for (const auto& print : std::vector<std::function<std::string(double)>>{
             [&](double v) { return fmt::format("{:.4f}", off_by_one(v, 1e-4)); },
             [&](double v) { return fmt::format("{:.6g}", off_by_one(v, 1e-4)); },
             [&](double v) { return fmt::format("{:.5e}", off_by_one(v, 1e-4)); }}) {
        const SurfaceFile file = read(text_stl(soup, print));
        CHECK(check_closed(file.mesh));
        CHECK(file.mesh.points.size() == exact.points.size());
        CHECK(signed_volume(file.mesh) == near(signed_volume(exact), {.relative = 1e-4}));
    }
    const auto round = [](double v) { return fmt::format("{}", v); };
    CHECK(read(text_stl(jittered(exact, 0, 1, 1), round)).warnings.empty());
}

TEST_CASE("mending: round coordinates do not widen the tolerance, and a hole stays a hole") {
    TriMesh holed = cube({0, 0, 0}, 1);
    holed.triangles.pop_back();
    const auto whole = [](double v) { return fmt::format("{:.0f}", v); };
    const SurfaceFile file = read(text_stl(holed, whole));
    CHECK(file.mesh.points.size() == 8);
    CHECK(file.mesh.triangles.size() == 11);
    CHECK(file.warnings.empty());
    // A slit much wider than a float step stays open.
    TriMesh slit = jittered(cube({0, 0, 0}, 10), 0, 1, 1);
    for (std::size_t i = 30; i < 36; ++i) slit.points[i].x += 1e-3;
    CHECK_FALSE(check_closed(read(binary_stl(slit)).mesh));
}

TEST_CASE("mending: a chain of close points does not collapse into one point") {
    // An open strip with border points closer together than the reach.
    TriMesh strip;
    constexpr int count = 200;
    for (int i = 0; i < count; ++i) {
        const double x = 4096 + i * 0.002;  // a step is 0.0005 here, the reach 0.0078
        strip.points.push_back({x, 0, 0});
        strip.points.push_back({x, 10, 0});
    }
    for (int i = 0; i + 1 < count; ++i) {
        strip.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
        strip.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
    }
    const SurfaceFile file = read(binary_stl(strip));
    CHECK(bounds(file.mesh).size().x > 0.39 - 2 * 0.0079);
}

TEST_CASE("mending: an inverted solid, and a cavity whose faces look outwards, are turned over with a note") {
    TriMesh outwards = joined(cube({0, 0, 0}, 10), cube({2, 2, 2}, 6));
    const SurfaceFile hollow = read(binary_stl(outwards));
    CHECK(signed_volume(hollow.mesh) == near(784, {.relative = 1e-12}));
    REQUIRE(hollow.warnings.size() == 1);
    CHECK(holds(hollow.warnings[0], "1 shell(s) inside another one looked outwards and were turned into cavities"));
    for (auto& t : outwards.triangles) std::swap(t[1], t[2]);
    const SurfaceFile turned = read(binary_stl(outwards));
    CHECK(signed_volume(turned.mesh) == near(784, {.relative = 1e-12}));
    REQUIRE(turned.warnings.size() == 1);
    CHECK(holds(turned.warnings[0], "1 shell(s) inside out were turned outwards"));
}

TEST_CASE("the step of printed numbers: fixed decimals, or significant digits") {
    const auto step = [](std::initializer_list<const char*> numbers, double size) {
        PrintedDigits digits;
        for (const char* number : numbers) digits.see(number);
        return digits.step(size);
    };
    CHECK(step({}, 100) == 0);
    CHECK(step({"1.000", "-20.125"}, 100) == near(1e-3, {.relative = 1e-12}));
    CHECK(step({"123.457", "0", "10.5"}, 200) == near(1e-3, {.relative = 1e-12}));
    CHECK(step({"1.23457e+02", "0.00000e+00"}, 123) == near(1e-3, {.relative = 1e-12}));
    CHECK(step({"0.00123", "1"}, 1) == near(1e-2, {.relative = 1e-12}));
    CHECK(float_step(1) == near(1.0 / 8388608, {.relative = 1e-12}));
    CHECK(float_step(0) > 0);
}

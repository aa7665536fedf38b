// The slicer against the simplest method: a point-in-solid test.
#include <doctest/doctest.h>

#include "printing/slice/slicer.hpp"
#include "printing/slice/test_shapes.hpp"

using namespace pliant;
using namespace pliant::slice;
using namespace pliant::slice::test;

namespace {

class Random {
public:
    explicit Random(std::uint32_t seed) : state_(seed) {}
    /// In [low, high).
    double operator()(double low, double high) {
        state_ = state_ * 1664525 + 1013904223;
        return low + (high - low) * (state_ >> 8) / 16777216.0;
    }

private:
    std::uint32_t state_;
};

/// A closed surface around `centre` that every ray from there meets once; between 0.5 and 1 times `radius`.
mesh::TriMesh boulder(const Vec3& centre, double radius, Random& random) {
    constexpr int around = 9, down = 6;
    std::vector<Vec3> ring;
    const auto point = [&](double t, double p) {
        const double r = radius * random(0.5, 1);
        return centre + Vec3{r * std::sin(t) * std::cos(p), r * std::sin(t) * std::sin(p), -r * std::cos(t)};
    };
    const Vec3 bottom = point(0, 0), top = point(std::numbers::pi, 0);
    for (int i = 1; i < down; ++i) {
        for (int j = 0; j < around; ++j)
            ring.push_back(point(std::numbers::pi * i / down, 2 * std::numbers::pi * j / around));
    }
    const auto at = [&](int i, int j) {
        return i == 0 ? bottom : i == down ? top : ring[static_cast<std::size_t>((i - 1) * around + j % around)];
    };
    mesh::TriMesh mesh;
    for (int i = 0; i < down; ++i) {
        for (int j = 0; j < around; ++j) {
            if (i > 0) add_triangle(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1));
            if (i < down - 1) add_triangle(mesh, at(i, j), at(i + 1, j + 1), at(i + 1, j));
        }
    }
    return mesh;
}

/// The winding number of a point: signed crossings of the vertical upward ray.
int winding(const mesh::TriMesh& mesh, const Vec3& p) {
    int count = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3 a = mesh.points[t[0]] - p, b = mesh.points[t[1]] - p, c = mesh.points[t[2]] - p;
        const double u = b.x * c.y - b.y * c.x, v = c.x * a.y - c.y * a.x, w = a.x * b.y - a.y * b.x;
        const bool positive = u > 0 && v > 0 && w > 0, negative = u < 0 && v < 0 && w < 0;
        if (!positive && !negative) continue;
        if ((u * a.z + v * b.z + w * c.z > 0) == positive) count += positive ? 1 : -1;
    }
    return count;
}

const Raster sampled_raster{40, 36, 100};

/// Fraction of a pixel's sample points inside the body.
double sampled(const mesh::TriMesh& mesh, int row, int column, double z) {
    constexpr int n = 12;
    int inside = 0;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const double x = (column + (i + 0.5) / n - sampled_raster.width_px / 2.0) * sampled_raster.pixel_um;
            const double y = (sampled_raster.height_px / 2.0 - row - (j + 0.5) / n) * sampled_raster.pixel_um;
            inside += winding(mesh, {x + 1e-4, y + 2e-4, z}) != 0;
        }
    }
    return inside / double(n * n);
}

}  // namespace

TEST_CASE("grey values are the covered share, for random bodies with cavities") {
    Random random(2024);
    for (int round = 0; round < 8; ++round) {
        mesh::TriMesh mesh = boulder({0, 0, 1500}, 1700, random);
        const double lowest = mesh::bounds(mesh).low.z;
        mesh = together(mesh, turned_inside_out(boulder({0, 0, 1500}, 600, random)));
        for (Vec3& p : mesh.points) p.z -= lowest;
        const auto slicer = Slicer::prepare(std::vector<Body>{{"soft", mesh, ""}}, {sampled_raster, 100, {}});
        REQUIRE_MESSAGE(slicer.has_value(), (slicer ? "" : slicer.error().message));
        double worst = 0;
        int grey = 0;
        for (int shot = 0; shot < 400; ++shot) {
            const int layer = static_cast<int>(random(0, slicer->layer_count()));
            const int row = static_cast<int>(random(0, sampled_raster.height_px));
            const int column = static_cast<int>(random(0, sampled_raster.width_px));
            const SlicedLayer sliced = slicer->layer(layer);
            const int value = sliced.images.empty() ? 0 : sliced.images[0].image.at(row, column);
            const double expected = sampled(mesh, row, column, (layer + 0.5) * 100);
            grey += value > 0 && value < 255;
            worst = std::max(worst, std::fabs(value / 255.0 - expected));
        }
        CHECK(grey > 10);
        CHECK(worst < 0.1);  // an edge passes at most two of twelve columns of points unevenly
    }
}

TEST_CASE("two materials: every pixel is lit by one at most, and together they light the union") {
    Random random(7);
    for (int round = 0; round < 6; ++round) {
        mesh::TriMesh a = boulder({-400, 0, 1500}, 1400, random), b = boulder({500, 100, 1500}, 1300, random);
        const double lowest = std::min(mesh::bounds(a).low.z, mesh::bounds(b).low.z);
        for (Vec3& p : a.points) p.z -= lowest;
        for (Vec3& p : b.points) p.z -= lowest;
        const auto slicer =
            Slicer::prepare(std::vector<Body>{{"soft", a, ""}, {"rigid", b, ""}}, {sampled_raster, 100, {}});
        REQUIRE(slicer.has_value());
        for (int shot = 0; shot < 300; ++shot) {
            const int layer = static_cast<int>(random(0, slicer->layer_count()));
            const int row = static_cast<int>(random(0, sampled_raster.height_px));
            const int column = static_cast<int>(random(0, sampled_raster.width_px));
            const SlicedLayer sliced = slicer->layer(layer);
            int lit = 0, value = 0, owner = -1;
            for (const MaterialImage& m : sliced.images) {
                if (m.image.at(row, column) == 0) continue;
                ++lit;
                value = m.image.at(row, column);
                owner = m.material;
            }
            CHECK(lit <= 1);
            const double z = (layer + 0.5) * 100;
            const double in_a = sampled(a, row, column, z), in_b = sampled(b, row, column, z);
            if (in_a + in_b == 0) CHECK(value < 26);
            if (in_b == 1) CHECK(owner == 1);  // the later body keeps the overlap
            if (in_a == 1 && in_b == 0) CHECK(owner == 0);
            if (in_a == 1 || in_b == 1) CHECK(value > 229);
        }
    }
}

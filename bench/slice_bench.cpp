// Speed of slicing and of encoding layer images, at 1920 x 1080 pixels.
#include <benchmark/benchmark.h>

#include "core/progress.hpp"
#include "job/job.hpp"
#include "slice/slicer.hpp"

using namespace pliant;

namespace {

mesh::TriMesh cube(double side_um, double x_um) {
    mesh::TriMesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.points.push_back({x_um + ((i & 1) != 0 ? side_um : 0), ((i & 2) != 0 ? side_um : 0) - side_um / 2,
                               (i & 4) != 0 ? side_um : 0});
    }
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

/// Two 20 mm cubes of two materials that share a face, 100 layers.
void two_cubes(benchmark::State& state, bool encode) {
    const std::vector<slice::Body> bodies = {{"a", cube(20000, -20000), "left"}, {"b", cube(20000, 0), "right"}};
    slice::Settings settings;
    settings.raster = {1920, 1080, 50, false, false};
    settings.layer_um = 200;
    Progress silent;
    std::size_t bytes = 0;
    for (auto _ : state) {
        const auto summary = slice::slice_bodies(
            bodies, settings,
            [&](int, int, const slice::Image& image) -> Status {
                if (encode) bytes += job::encode(image).png.size();
                return {};
            },
            silent);
        benchmark::DoNotOptimize(summary);
    }
    state.counters["layers_per_second"] =
        benchmark::Counter(100.0 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
    benchmark::DoNotOptimize(bytes);
}

}  // namespace

BENCHMARK_CAPTURE(two_cubes, slice_only, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(two_cubes, slice_and_encode, true)->Unit(benchmark::kMillisecond)->UseRealTime();

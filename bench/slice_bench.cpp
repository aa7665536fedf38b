// Speed of slicing and of encoding layer images, on all cores that the process may use.
#include <benchmark/benchmark.h>

#include "base/core/parallel.hpp"
#include "base/core/progress.hpp"
#include "bumpy_ball.hpp"
#include "printing/job/job.hpp"
#include "printing/slice/slicer.hpp"

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
            [&](int, int, const slice::RunImage& image) -> Status {
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

/// Layers of a body of `around` x `down` rows of triangles, as PNG files in memory, without reading and repair.
void layers_of_ball(benchmark::State& state, int around, int down, double radius_um, const slice::Raster& raster) {
    std::vector<slice::Body> bodies{{"a", bench::bumpy_ball(around, down, radius_um), "ball"}};
    for (Vec3& p : bodies[0].surface_um.points) p.z += radius_um;
    slice::Settings settings;
    settings.raster = raster;
    const auto slicer = slice::Slicer::prepare(bodies, settings);
    if (!slicer) return state.SkipWithError(slicer.error().message.c_str());
    const auto count = static_cast<std::size_t>(slicer->layer_count());
    std::vector<std::size_t> bytes(count);
    for (auto _ : state) {
        parallel_for(count, 1, [&](std::size_t k, std::size_t) {
            bytes[k] = job::encode(slicer->layer(static_cast<int>(k)).images.at(0).image).png.size();
        });
    }
    const auto layers = static_cast<double>(count * state.iterations());
    state.counters["per_1000_layers"] =
        benchmark::Counter(layers / 1000, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["layers"] = static_cast<double>(count);
}

/// From points and triangles to a body that can be cut.
void prepare_ball(benchmark::State& state, int around, int down) {
    std::vector<slice::Body> bodies{{"a", bench::bumpy_ball(around, down, 50000), "ball"}};
    for (Vec3& p : bodies[0].surface_um.points) p.z += 50000;
    slice::Settings settings;
    settings.raster = {3840, 2160, 50};
    for (auto _ : state) benchmark::DoNotOptimize(slice::Slicer::prepare(bodies, settings));
}

constexpr slice::Raster hd{1920, 1080, 75}, uhd{3840, 2160, 37.5};

}  // namespace

BENCHMARK_CAPTURE(layers_of_ball, 83k_triangles_hd, 300, 140, 30000, hd)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(layers_of_ball, 83k_triangles_uhd, 300, 140, 30000, uhd)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(layers_of_ball, 1m_triangles_uhd, 1000, 500, 30000, uhd)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(prepare_ball, 83k_triangles, 300, 140)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(prepare_ball, 1m_triangles, 1000, 500)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(two_cubes, slice_only, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(two_cubes, slice_and_encode, true)->Unit(benchmark::kMillisecond)->UseRealTime();

// Speed of meshing, and of reading and writing mesh files: in bytes of the file per second, and in bytes of points,
// nodes and regions, which a compressed file has fewer of.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/progress.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/mesher/mesher.hpp"
#include "simulation/peers/reference_problems.hpp"

using namespace pliant;

namespace {

/// 750,000 linear tets, or as many quadratic ones.
const mesh::TetMesh& block(int order) {
    static const mesh::TetMesh linear = [] {
        mesh::TetMesh mesh = sim::reference::kuhn_box({1, 1, 1}, 50, 50, 50, [](Vec3) { return 0; });
        mesh.region_names = {"block"};
        return mesh;
    }();
    static const mesh::TetMesh quadratic = mesh::to_quadratic(linear);
    return order == 2 ? quadratic : linear;
}

std::filesystem::path file_of(const char* extension) {
    return std::filesystem::temp_directory_path() / (std::string("pliant_mesh_bench") + extension);
}

benchmark::Counter data_rate(const mesh::TetMesh& mesh) {
    const std::size_t bytes = 24 * mesh.points.size() + 4 * (mesh.nodes.size() + mesh.region.size());
    return {static_cast<double>(bytes), benchmark::Counter::kIsIterationInvariantRate,
            benchmark::Counter::OneK::kIs1000};
}

void write_mesh(benchmark::State& state, const char* extension, int order) {
    const mesh::TetMesh& mesh = block(order);
    const auto path = file_of(extension);
    for (auto _ : state) {
        if (!mesh::write_tet_mesh(path, mesh)) state.SkipWithError("not written");
    }
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(std::filesystem::file_size(path)));
    state.counters["data"] = data_rate(mesh);
    std::filesystem::remove(path);
}

void read_mesh(benchmark::State& state, const char* extension, int order) {
    const auto path = file_of(extension);
    if (!mesh::write_tet_mesh(path, block(order))) state.SkipWithError("not written");
    for (auto _ : state) {
        const auto mesh = mesh::read_tet_mesh(path);
        if (!mesh || mesh->tet_count() != block(order).tet_count()) state.SkipWithError("not read");
        benchmark::DoNotOptimize(mesh);
    }
    state.counters["data"] = data_rate(block(order));
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(std::filesystem::file_size(path)));
    std::filesystem::remove(path);
}

/// A cube of side 1.
void mesh_cube(benchmark::State& state, double size, int order) {
    const mesh::Solid cube = std::make_shared<const mesh::SolidNode>(mesh::SolidNode{mesh::BoxSolid{{}, {1, 1, 1}}});
    Progress silent;
    double tets = 0;
    for (auto _ : state) {
        mesh::MeshSettings settings;
        settings.size = size;
        settings.order = order;
        const auto mesh = mesh::mesh_bodies(std::vector<mesh::BodyGeometry>{{"cube", cube}}, settings, silent);
        if (!mesh) state.SkipWithError(mesh.error().message.c_str());
        tets = mesh ? static_cast<double>(mesh->tet_count()) : 0;
    }
    state.counters["tets"] = tets;
}

}  // namespace

BENCHMARK_CAPTURE(write_mesh, vtk, ".vtk", 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(write_mesh, msh, ".msh", 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(write_mesh, vtk_quadratic, ".vtk", 2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(write_mesh, vtu, ".vtu", 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_mesh, vtk, ".vtk", 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_mesh, msh, ".msh", 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_mesh, vtk_quadratic, ".vtk", 2)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_mesh, vtu, ".vtu", 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(mesh_cube, thousands, 0.09, 1)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(mesh_cube, million, 0.0167, 1)->Unit(benchmark::kSecond)->Iterations(1);

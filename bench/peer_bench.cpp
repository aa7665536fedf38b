// Whole programs beside us: `pliant slice` and PrusaSlicer (prusa-slicer --export-sla) turn the same STL file into an
// archive of layer images of the same size, pixel and layer height, one after the other in one run. Both read and check
// the file, cut it, rasterise with grey edges, encode PNG and write a zip file; PrusaSlicer's supports, pad, hollowing
// and compensations are off. Pliant also plans the print and writes and checks its G-code. `volume_mm3` is what the
// images of the archive light up (pixel values / 255 x pixel area x layer height): that of the body, if both did the
// same work.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "core/files.hpp"
#include "job/png.hpp"
#include "job/zip_file.hpp"
#include "mesh/surface_file.hpp"

using namespace pliant;
namespace fs = std::filesystem;

namespace {

// The projector of examples/printers/tower.toml.
constexpr int width_px = 1920, height_px = 1080;
constexpr double pixel_mm = 0.15875, layer_mm = 0.05;

/// A ball of 60 mm with bumps, 159,200 triangles, closed, in millimetres.
mesh::TriMesh bumpy_ball() {
    constexpr int around = 400, down = 200;
    mesh::TriMesh mesh;
    mesh.points = {{0, 0, -30}, {0, 0, 30}};
    const auto point = [&](int i, int j) { return i == 0 ? 0 : i == down ? 1 : 2 + (i - 1) * around + j % around; };
    for (int i = 1; i < down; ++i) {
        for (int j = 0; j < around; ++j) {
            const double t = std::numbers::pi * i / down, p = 2 * std::numbers::pi * j / around;
            const double s = std::sin(t);
            const double r = 30 * (1 + 0.1 * s * s * s * std::cos(9 * p) * std::sin(7 * t));
            mesh.points.push_back({r * s * std::cos(p), r * s * std::sin(p), -r * std::cos(t)});
        }
    }
    for (int i = 0; i < down; ++i) {
        for (int j = 0; j < around; ++j) {
            const int a = point(i, j), b = point(i, j + 1), c = point(i + 1, j + 1), d = point(i + 1, j);
            if (i > 0) mesh.triangles.push_back({a, b, c});
            if (i < down - 1) mesh.triangles.push_back({a, c, d});
        }
    }
    return mesh;
}

/// A folder of its own that goes with the object.
struct Scratch {
    fs::path folder = fs::temp_directory_path() / fmt::format("pliant_peer_bench_{}", getpid());
    Scratch() { fs::create_directories(folder); }
    ~Scratch() { fs::remove_all(folder); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
};

constexpr std::string_view peer_settings =
    "printer_technology = SLA\nlayer_height = 0.05\ninitial_layer_height = 0.05\n"
    "display_width = 304.8\ndisplay_height = 171.45\ndisplay_pixels_x = 1920\ndisplay_pixels_y = "
    "1080\ndisplay_orientation = landscape\n"
    "bed_shape = 0x0,304.8x0,304.8x171.45,0x171.45\nmax_print_height = 300\n"
    "supports_enable = 0\npad_enable = 0\nhollowing_enable = 0\n"
    "elefant_foot_compensation = 0\nabsolute_correction = 0\ngamma_correction = 1\nsla_archive_format = SL1\n";

struct Lit {
    int images = 0;
    double volume_mm3 = 0;
};

Result<Lit> lit_volume(const fs::path& archive) {
    const auto zip = job::ZipReader::open(archive);
    if (!zip) return tl::unexpected(zip.error());
    Lit lit;
    for (std::uint64_t i = 0; i < zip->entry_count(); ++i) {
        const std::string name = zip->name(i);
        if (!name.ends_with(".png") || name.find("thumbnail") != std::string::npos) continue;
        const auto bytes = zip->read(name, 1u << 24);
        if (!bytes) return tl::unexpected(bytes.error());
        const auto image = job::decode_png(*bytes, {width_px, height_px}, name);
        if (!image) return tl::unexpected(image.error());
        double sum = 0;
        for (const std::uint8_t value : image->pixels) sum += value;
        ++lit.images;
        lit.volume_mm3 += sum / 255 * pixel_mm * pixel_mm * layer_mm;
    }
    return lit;
}

/// Times `command`, a shell line that writes `archive`.
void time_program(benchmark::State& state, const std::string& command, const fs::path& archive, double body_mm3) {
    for (auto _ : state) {
        if (std::system(command.c_str()) != 0) return state.SkipWithError(("failed: " + command).c_str());
    }
    const Result<Lit> lit = lit_volume(archive);
    if (!lit) return state.SkipWithError(lit.error().message.c_str());
    state.counters["images"] = lit->images;
    state.counters["volume_mm3"] = lit->volume_mm3;
    state.counters["body_mm3"] = body_mm3;
    state.counters["archive_MB"] = static_cast<double>(fs::file_size(archive)) / 1e6;
}

void slice_program(benchmark::State& state, bool peer) {
    if (peer && std::system("command -v prusa-slicer >/dev/null") != 0)
        return state.SkipWithError("prusa-slicer is not installed: nothing to compare with");
    const Scratch scratch;
    const mesh::TriMesh ball = bumpy_ball();
    const std::string stl = scratch.folder / "ball.stl", ini = scratch.folder / "peer.ini";
    const fs::path archive = scratch.folder / (peer ? "ball.sl1" : "ball.zip");
    if (!mesh::write_stl(stl, ball) || !write_file(ini, peer_settings))
        return state.SkipWithError("the temporary folder cannot be written");
    const std::string command =
        peer ? fmt::format("prusa-slicer --export-sla --load {} --center 152.4,85.7 -o {} {} >/dev/null 2>&1", ini,
                           archive.string(), stl)
             : fmt::format("{} slice semi-flex={} --printer examples/printers/tower.toml --layer '50 um' -o {} -q",
                           PLIANT_PROGRAM, stl, archive.string());
    time_program(state, command, archive, mesh::signed_volume(ball));
}

}  // namespace

BENCHMARK_CAPTURE(slice_program, pliant, false)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(3);
BENCHMARK_CAPTURE(slice_program, prusa_slicer, true)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(3);

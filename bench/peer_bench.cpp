// Whole programs beside us: `pliant slice` and PrusaSlicer (prusa-slicer --export-sla) turn the same STL file into an
// archive of layer images of the same size, pixel and layer height, one after the other in one run. Both read and check
// the file, cut it, rasterise with grey edges, encode PNG and write a zip file; PrusaSlicer's supports, pad, hollowing
// and compensations are off. Pliant also plans the print and writes and checks its G-code. `volume_mm3` is what the
// images of the archive light up (pixel values / 255 x pixel area x layer height): that of the body, if both did the
// same work.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/core/files.hpp"
#include "base/zip/zip_file.hpp"
#include "bumpy_ball.hpp"
#include "geometry/files/surface_file.hpp"
#include "printing/job/png.hpp"

using namespace pliant;
namespace fs = std::filesystem;

namespace {

constexpr double layer_mm = 0.05;

/// The projector of examples/printers/tower.toml, or one of twice its pixels on the same bed.
struct Screen {
    int width_px, height_px;
    double pixel_mm;
};
constexpr Screen hd{1920, 1080, 0.15875}, uhd{3840, 2160, 0.079375};

/// A folder of its own that goes with the object.
struct Scratch {
    fs::path folder = fs::temp_directory_path() / fmt::format("pliant_peer_bench_{}", getpid());
    Scratch() { fs::create_directories(folder); }
    ~Scratch() { fs::remove_all(folder); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
};

/// PrusaSlicer's settings, but for the number of pixels.
constexpr std::string_view peer_settings =
    "printer_technology = SLA\nlayer_height = 0.05\ninitial_layer_height = 0.05\n"
    "display_width = 304.8\ndisplay_height = 171.45\ndisplay_orientation = landscape\n"
    "bed_shape = 0x0,304.8x0,304.8x171.45,0x171.45\nmax_print_height = 300\n"
    "supports_enable = 0\npad_enable = 0\nhollowing_enable = 0\n"
    "elefant_foot_compensation = 0\nabsolute_correction = 0\ngamma_correction = 1\nsla_archive_format = SL1\n";

struct Lit {
    int images = 0;
    double volume_mm3 = 0;
};

Result<Lit> lit_volume(const fs::path& archive, const Screen& screen) {
    const auto zip = ZipReader::open(archive);
    if (!zip) return tl::unexpected(zip.error());
    Lit lit;
    for (std::uint64_t i = 0; i < zip->entry_count(); ++i) {
        const std::string name = zip->name(i);
        if (!name.ends_with(".png") || name.find("thumbnail") != std::string::npos) continue;
        const auto bytes = zip->read(name, 1u << 24);
        if (!bytes) return tl::unexpected(bytes.error());
        const auto image = job::decode_png(*bytes, {screen.width_px, screen.height_px}, name);
        if (!image) return tl::unexpected(image.error());
        double sum = 0;
        for (const std::uint8_t value : image->pixels) sum += value;
        ++lit.images;
        lit.volume_mm3 += sum / 255 * screen.pixel_mm * screen.pixel_mm * layer_mm;
    }
    return lit;
}

struct Run {
    bool done = false;
    double cpu_s = 0, peak_MB = 0;
};

/// Runs a shell line and waits for it.
Run run_program(const std::string& command) {
    const pid_t child = fork();
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
        _exit(127);
    }
    int status = 0;
    rusage used{};
    if (child < 0 || wait4(child, &status, 0, &used) != child) return {};
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return {WIFEXITED(status) && WEXITSTATUS(status) == 0, seconds(used.ru_utime) + seconds(used.ru_stime),
            static_cast<double>(used.ru_maxrss) / 1024};
}

/// Times `command`, a shell line that writes `archive`.
void time_program(benchmark::State& state, const std::string& command, const fs::path& archive, const Screen& screen,
                  double body_mm3) {
    double cpu_s = 0, peak_MB = 0;
    for (auto _ : state) {
        const Run run = run_program(command);
        if (!run.done) return state.SkipWithError(("failed: " + command).c_str());
        cpu_s += run.cpu_s;
        peak_MB = std::max(peak_MB, run.peak_MB);
    }
    const Result<Lit> lit = lit_volume(archive, screen);
    if (!lit) return state.SkipWithError(lit.error().message.c_str());
    state.counters["images"] = lit->images;
    state.counters["volume_mm3"] = lit->volume_mm3;
    state.counters["body_mm3"] = body_mm3;
    state.counters["archive_MB"] = static_cast<double>(fs::file_size(archive)) / 1e6;
    state.counters["cpu_ms_a_layer"] = 1000 * cpu_s / static_cast<double>(state.iterations()) / lit->images;
    state.counters["peak_MB"] = peak_MB;
}

/// examples/printers/tower.toml with the pixels of `screen`.
Result<std::string> printer_text(const Screen& screen) {
    Result<std::string> text = read_file("examples/printers/tower.toml");
    if (!text) return text;
    const auto put = [&](const std::string& from, const std::string& to) {
        if (const std::size_t at = text->find(from); at != std::string::npos) text->replace(at, from.size(), to);
    };
    put("width = 1920", fmt::format("width = {}", screen.width_px));
    put("height = 1080", fmt::format("height = {}", screen.height_px));
    put("pixel = \"158.75 um\"", fmt::format("pixel = \"{:.6g} um\"", screen.pixel_mm * 1000));
    return text;
}

enum class Program { pliant, pliant_on_one_core, prusa_slicer };

/// A bumpy ball, 2 * around * (down - 1) triangles.
struct Ball {
    int around, down;
    double radius_mm;
};
constexpr Ball usual{300, 140, 30}, million{1000, 500, 50};

void slice_program(benchmark::State& state, Program program, const Screen& screen, const Ball& shape = usual) {
    const bool peer = program == Program::prusa_slicer;
    if (peer && std::system("command -v prusa-slicer >/dev/null") != 0)
        return state.SkipWithError("prusa-slicer is not installed: nothing to compare with");
    const Scratch scratch;
    const mesh::TriMesh ball = bench::bumpy_ball(shape.around, shape.down, shape.radius_mm);
    const std::string stl = scratch.folder / "ball.stl", ini = scratch.folder / "peer.ini";
    const std::string printer = scratch.folder / "printer.toml";
    const fs::path archive = scratch.folder / (peer ? "ball.sl1" : "ball.zip");
    const Result<std::string> toml = printer_text(screen);
    const std::string settings = fmt::format("{}display_pixels_x = {}\ndisplay_pixels_y = {}\n", peer_settings,
                                             screen.width_px, screen.height_px);
    if (!toml || !write_file(printer, *toml) || !mesh::write_stl(stl, ball) || !write_file(ini, settings))
        return state.SkipWithError("the temporary folder cannot be written, or this is not the project's folder");
    const std::string command =
        peer ? fmt::format(
                   "taskset -c 0 prusa-slicer --export-sla --load {} --center 152.4,85.7 -o {} {} >/dev/null 2>&1", ini,
                   archive.string(), stl)
             : fmt::format("{}{} slice semi-flex={} --printer {} --layer '50 um' -o {} -q",
                           program == Program::pliant ? "" : "taskset -c 0 ", PLIANT_PROGRAM, stl, printer,
                           archive.string());
    time_program(state, command, archive, screen, mesh::signed_volume(ball));
}

}  // namespace

BENCHMARK_CAPTURE(slice_program, pliant_one_core_hd, Program::pliant_on_one_core, hd)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(3);
BENCHMARK_CAPTURE(slice_program, pliant_hd, Program::pliant, hd)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(3);
BENCHMARK_CAPTURE(slice_program, prusa_slicer_one_core_hd, Program::prusa_slicer, hd)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);
BENCHMARK_CAPTURE(slice_program, pliant_one_core_uhd, Program::pliant_on_one_core, uhd)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(3);
BENCHMARK_CAPTURE(slice_program, pliant_uhd, Program::pliant, uhd)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(3);
BENCHMARK_CAPTURE(slice_program, prusa_slicer_one_core_uhd, Program::prusa_slicer, uhd)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);
// A million triangles, 2000 layers.
BENCHMARK_CAPTURE(slice_program, pliant_one_core_uhd_1m_triangles, Program::pliant_on_one_core, uhd, million)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(2);
BENCHMARK_CAPTURE(slice_program, pliant_uhd_1m_triangles, Program::pliant, uhd, million)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(2);

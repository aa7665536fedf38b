// Supports beside PrusaSlicer's, of the same parts as they lie in their files, 5 mm above the platform, in layers of
// 0.1 mm: are all islands held, by how much material?
//     pliant_supports FILE.stl...
// An island is what Pliant's own inspection calls so, in the images of either program. Volumes are light in the images.
#include "printing/slice/supports.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "base/core/files.hpp"
#include "geometry/files/surface_file.hpp"
#include "printing/job/image_stack.hpp"
#include "printing/slice/inspect.hpp"
#include "printing/slice/place.hpp"
#include "printing/slice/slicer.hpp"

using namespace pliant;
namespace fs = std::filesystem;

namespace {

constexpr slice::Raster raster{1920, 1080, 100};
constexpr int layer_um = 100;
constexpr double lift_um = 5000;
constexpr double voxel_mm3 = 0.1 * 0.1 * 0.1;

/// PrusaSlicer's own choices for supports, but for the pad, on the same screen.
constexpr std::string_view peer_settings =
    "printer_technology = SLA\nlayer_height = 0.1\ninitial_layer_height = 0.1\n"
    "display_width = 192\ndisplay_height = 108\ndisplay_pixels_x = 1920\ndisplay_pixels_y = 1080\n"
    "display_orientation = landscape\nbed_shape = 0x0,192x0,192x108,0x108\nmax_print_height = 300\n"
    "supports_enable = 1\nsupport_object_elevation = 5\npad_enable = 0\nhollowing_enable = 0\n"
    "elefant_foot_compensation = 0\nabsolute_correction = 0\ngamma_correction = 1\nsla_archive_format = SL1\n";

/// What the images of a part hold.
struct Outcome {
    std::size_t islands = 0;
    double volume_mm3 = 0, seconds = 0;
    int tips = 0, struts = 0;
};

template <class LayerAt>
Outcome inspected(int count, const LayerAt& layer_at) {
    Outcome outcome;
    slice::Inspector inspector;
    for (int k = 0; k < count; ++k) {
        const slice::ComposedLayer layer = layer_at(k);
        for (const slice::MaterialImage& m : layer.images)
            outcome.volume_mm3 += static_cast<double>(m.value_sum) / 255 * voxel_mm3;
        inspector.add(slice::shape_of(layer, raster.width_px));
    }
    outcome.islands = inspector.finish().islands.size();
    return outcome;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Result<Outcome> sliced(std::vector<slice::Body> bodies, bool supported) {
    const slice::Settings settings{raster, layer_um, {}};
    const auto start = std::chrono::steady_clock::now();
    slice::Supports supports;
    if (supported) {
        Progress silent;
        slice::SupportSettings wanted;
        wanted.material = "part";
        Result<slice::Supports> made = slice::make_supports(bodies, settings, wanted, silent);
        if (!made) return tl::unexpected(made.error());
        supports = std::move(*made);
    }
    const double seconds = seconds_since(start);
    bodies.insert(bodies.begin(), supports.bodies.begin(), supports.bodies.end());
    const auto slicer = slice::Slicer::prepare(bodies, settings);
    if (!slicer) return tl::unexpected(slicer.error());
    Outcome outcome = inspected(slicer->layer_count(), [&](int k) { return slicer->layer(k); });
    outcome.seconds = seconds;
    outcome.tips = supports.tips;
    outcome.struts = supports.struts;
    return outcome;
}

Result<Outcome> of_peer(const fs::path& file) {
    const fs::path folder = fs::temp_directory_path() / fmt::format("pliant_supports_{}", getpid());
    std::error_code code;
    fs::create_directories(folder, code);
    const fs::path ini = folder / "peer.ini", archive = folder / "part.sl1";
    if (auto status = write_file(ini, peer_settings); !status) return tl::unexpected(status.error());
    const auto start = std::chrono::steady_clock::now();
    const std::string command =
        fmt::format("prusa-slicer --export-sla --load '{}' --center 96,54 -o '{}' '{}' >/dev/null 2>&1", ini.string(),
                    archive.string(), file.string());
    const bool ran = std::system(command.c_str()) == 0;
    const double seconds = seconds_since(start);
    Result<job::ImageStack> stack = failure("prusa-slicer failed");
    if (ran) stack = job::ImageStack::open(archive);
    if (!stack) {
        fs::remove_all(folder, code);
        return tl::unexpected(stack.error());
    }
    Outcome outcome = inspected(stack->layer_count(), [&](int k) {
        slice::ComposedLayer layer;
        const auto image = stack->image(k);
        if (!image) return layer;
        slice::RunImage runs = slice::RunImage::from_image(*image);
        const std::int64_t sum = runs.value_sum();
        if (sum > 0) layer.images.push_back({0, std::move(runs), sum, 0});
        return layer;
    });
    outcome.seconds = seconds;
    fs::remove_all(folder, code);
    return outcome;
}

Status row(const fs::path& file) {
    const auto read = mesh::read_surface(file);
    if (!read) return tl::unexpected(read.error());
    std::vector<slice::Body> part{{"part", read->mesh, file.stem().string()}};
    for (Vec3& p : part[0].surface_um.points) p *= 1000;
    const auto placed = slice::place_on_platform(part, raster);
    if (!placed) return tl::unexpected(placed.error());
    slice::move(part[0], {0, 0, lift_um});
    const Result<Outcome> bare = sliced(part, false), ours = sliced(part, true), theirs = of_peer(file);
    for (const auto* outcome : {&bare, &ours}) {
        if (!*outcome) return tl::unexpected(outcome->error());
    }
    fmt::print("| {} | {} | {} | {} | {} | {:.0f} | {:.1f} |", file.stem().string(), bare->islands, ours->islands,
               ours->tips, ours->struts, ours->volume_mm3 - bare->volume_mm3, ours->seconds);
    if (theirs) {
        fmt::print(" {} | {:.0f} | {:.1f} |\n", theirs->islands, theirs->volume_mm3 - bare->volume_mm3,
                   theirs->seconds);
    } else {
        fmt::print(" | {} | |\n", theirs.error().message);
    }
    std::fflush(stdout);
    return {};
}

}  // namespace

int main(int count, char** arguments) {
    if (count < 2) {
        fmt::print(stderr, "usage: pliant_supports FILE.stl...\n");
        return 2;
    }
    fmt::print(
        "| part | islands without supports | islands left | tips | struts | supports, mm^3 | time, s | PrusaSlicer: "
        "islands left | supports, mm^3 | time, s |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (int i = 1; i < count; ++i) {
        if (const Status status = row(arguments[i]); !status)
            fmt::print("| {} | {} |\n", arguments[i], status.error().message);
    }
    return 0;
}

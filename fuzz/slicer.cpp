// Slices bodies that touch, overlap, intersect themselves or are invalid: no pixel has two owners, and a layer's
// figures match its images.
#include "printing/slice/slicer.hpp"

#include <algorithm>

#include "printing/slice/place.hpp"
#include "shapes.hpp"

namespace {

using namespace pliant;

std::vector<slice::Body> bodies_of(Bytes& bytes) {
    std::vector<slice::Body> bodies(1 + static_cast<std::size_t>(bytes.up_to(3)));
    for (slice::Body& body : bodies) {
        body.material = bytes.chance() ? "soft" : "rigid";
        body.surface_um = mesh::scaled(shapes::any(bytes), 100);
        if (bytes.up_to(7) == 0)
            body.blend =
                slice::Blend{"rigid", 100 * shapes::grid_point(bytes, 15), 100 * shapes::grid_point(bytes, 15)};
    }
    return bodies;
}

slice::Settings settings_of(Bytes& bytes) {
    slice::Settings settings;
    settings.raster = {1 + bytes.up_to(23), 1 + bytes.up_to(23), 60 + 5.0 * bytes.up_to(40)};
    settings.raster.mirror_x = bytes.chance();
    settings.raster.rotation_deg = bytes.chance() ? bytes.signed_byte() : 0;
    settings.layer_um = 25 * (1 + bytes.up_to(9));
    settings.rules.anti_alias = bytes.chance();
    if (bytes.up_to(3) == 0)
        settings.compensation["soft"] = {1.0 * bytes.signed_byte(), 1.0 * bytes.byte(), bytes.up_to(5)};
    if (bytes.up_to(3) == 0) settings.teeth = {{"soft", "rigid", 1 + bytes.up_to(9), 1 + bytes.up_to(3)}};
    return settings;
}

/// Traps if a pixel is lit in more than one image.
void trap_on_two_owners(const slice::SlicedLayer& layer) {
    for (std::size_t i = 0; i < layer.images.size(); ++i) {
        const slice::MaterialImage& one = layer.images[i];
        if (one.value_sum != one.image.value_sum() || one.image.blank()) __builtin_trap();
        for (int row = one.image.first_row(); row < one.image.end_row(); ++row) {
            for (const slice::Run& run : one.image.row(row)) {
                for (int column = run.begin; column < run.end; ++column) {
                    for (std::size_t j = 0; j < i; ++j) {
                        if (layer.images[j].image.at(row, column) != 0) __builtin_trap();
                    }
                }
            }
        }
    }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes bytes(data, size);
    const slice::Settings settings = settings_of(bytes);
    std::vector<slice::Body> bodies = bodies_of(bytes);
    if (!slice::place_on_platform(bodies, settings.raster)) return 0;
    const auto slicer = slice::Slicer::prepare(bodies, settings);
    if (!slicer) return 0;
    for (int layer = 0; layer < std::min(slicer->layer_count(), 16); ++layer) trap_on_two_owners(slicer->layer(layer));
    return 0;
}

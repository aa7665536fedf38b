#include "library/printing/cured_block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace pliant::library {
namespace {

constexpr double mm_per_um = 1e-3;
constexpr std::size_t most_voxels = 4'000'000'000;

/// The pixels lit by any layer.
struct Frame {
    int left = std::numeric_limits<int>::max(), right = 0, first = std::numeric_limits<int>::max(), last = 0;

    void hold(const twin::Runs& runs) {
        for (const twin::Run& run : runs) {
            left = std::min(left, run.begin);
            right = std::max(right, run.end);
            first = std::min(first, run.row);
            last = std::max(last, run.row + 1);
        }
    }
};

/// Layers with cured resin, from the platform on.
std::vector<const twin::CuredLayer*> solid_layers(const std::vector<twin::CuredLayer>& layers) {
    std::vector<const twin::CuredLayer*> solid;
    for (const twin::CuredLayer& layer : layers)
        if (std::any_of(layer.vats.begin(), layer.vats.end(), [](const auto& vat) { return !vat.runs.empty(); }))
            solid.push_back(&layer);
    std::sort(solid.begin(), solid.end(), [](auto* a, auto* b) { return a->top_um < b->top_um; });
    return solid;
}

/// Index of a resin in the block's list, from 1.
std::uint8_t number_of(CuredBlock& block, const std::string& resin) {
    const auto found = std::find(block.resins.begin(), block.resins.end(), resin);
    if (found != block.resins.end()) return static_cast<std::uint8_t>(found - block.resins.begin() + 1);
    if (block.resins.size() == 255) throw Failure(Failure::Kind::failed, "more than 255 resins have cured");
    block.resins.push_back(resin);
    return static_cast<std::uint8_t>(block.resins.size());
}

/// Position of a projector pixel in the block: x to the right, y up on the platform, not mirrored.
class Place {
public:
    Place(const Frame& frame, const machine::Projector& projector) : frame_(frame), projector_(projector) {}

    [[nodiscard]] std::size_t x(int column) const {
        return static_cast<std::size_t>(projector_.mirror_x ? frame_.right - 1 - column : column - frame_.left);
    }
    [[nodiscard]] std::size_t y(int row) const {  // row 0 has the largest y
        return static_cast<std::size_t>(projector_.mirror_y ? row - frame_.first : frame_.last - 1 - row);
    }
    [[nodiscard]] int left() const { return projector_.mirror_x ? projector_.width_px - frame_.right : frame_.left; }
    [[nodiscard]] int lower() const { return projector_.mirror_y ? frame_.first : projector_.height_px - frame_.last; }

private:
    const Frame& frame_;
    const machine::Projector& projector_;
};

/// Adds one vat's runs in a layer. `most`: for each pixel, the amount of the resin that it is assigned to.
void add(CuredBlock& block, std::size_t z, const Place& place, const twin::Runs& runs, std::uint8_t resin,
         std::vector<std::uint8_t>& most) {
    const std::size_t width = block.size[0], plane = width * block.size[1];
    for (const twin::Run& run : runs) {
        const auto value = static_cast<std::uint8_t>(std::min<int>(run.value, 255));
        const std::size_t row = place.y(run.row) * width;
        for (int x = run.begin; x < run.end; ++x) {
            const std::size_t pixel = row + place.x(x), voxel = z * plane + pixel;
            block.share[voxel] = static_cast<std::uint8_t>(std::min(255, block.share[voxel] + value));
            if (value <= most[pixel]) continue;
            most[pixel] = value;
            block.resin[voxel] = resin;
        }
    }
}

}  // namespace

CuredBlock cured_block(const std::vector<twin::CuredLayer>& layers, const machine::Printer& printer) {
    const std::vector<const twin::CuredLayer*> solid = solid_layers(layers);
    CuredBlock block;
    block.pixel_mm = mm_per_um * printer.projector.pixel_um;
    if (solid.empty()) return block;
    Frame frame;
    for (const twin::CuredLayer* layer : solid)
        for (const twin::VatLayer& vat : layer->vats) frame.hold(vat.runs);
    block.size = {static_cast<std::size_t>(frame.right - frame.left),
                  static_cast<std::size_t>(frame.last - frame.first), solid.size()};
    const std::size_t plane = block.size[0] * block.size[1], voxels = plane * block.size[2];
    if (voxels > most_voxels)
        throw Failure(Failure::Kind::failed,
                      fmt::format("the cured block has {} voxels; {} are possible", voxels, most_voxels));
    const Place place(frame, printer.projector);
    block.resin.resize(voxels);
    block.share.resize(voxels);
    for (std::size_t z = 0; z < solid.size(); ++z) {
        block.tops_mm.push_back(mm_per_um * solid[z]->top_um);
        block.bottoms_mm.push_back(mm_per_um * (solid[z]->top_um - solid[z]->thickness_um));
        std::vector<std::uint8_t> most(plane);
        for (const twin::VatLayer& vat : solid[z]->vats) {
            if (vat.runs.empty()) continue;
            const std::string& resin = printer.vats[static_cast<std::size_t>(vat.vat)].resin;
            add(block, z, place, vat.runs, number_of(block, resin), most);
        }
    }
    block.corner_mm = {block.pixel_mm * place.left(), block.pixel_mm * place.lower(), block.bottoms_mm.front()};
    return block;
}

}  // namespace pliant::library

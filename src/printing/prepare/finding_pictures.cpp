#include "printing/prepare/finding_pictures.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace pliant::job {
namespace {

constexpr int side_px = 240;
constexpr std::uint8_t below_grey = 70, layer_grey = 150, mark_grey = 255;
constexpr int solid_value = 128;

/// The most severe first, then the largest.
std::vector<Finding> worst(std::vector<Finding> findings) {
    const auto rank = [](const Finding& f) { return f.severity == "high" ? 2 : f.severity == "medium" ? 1 : 0; };
    std::stable_sort(findings.begin(), findings.end(), [&](const Finding& l, const Finding& r) {
        return std::pair(rank(l), l.area_mm2 + l.volume_mm3) > std::pair(rank(r), r.area_mm2 + r.volume_mm3);
    });
    if (findings.size() > most_findings) findings.resize(most_findings);
    return findings;
}

/// One finding per group of islands, except that all groups of low severity are one, with a picture of the largest.
std::vector<Finding> island_findings(std::span<const slice::IslandGroup> groups, double pixel_mm2) {
    std::vector<Finding> findings;
    std::optional<Finding> grain;
    for (const slice::IslandGroup& g : groups) {
        const Finding finding{"island",
                              g.largest.layer,
                              std::max(g.last_layer, g.largest.layer),
                              g.largest.row,
                              g.largest.column,
                              static_cast<double>(g.most_pixels) * pixel_mm2,
                              0,
                              {},
                              slice::severity_name(g.severity),
                              g.islands};
        if (g.severity != slice::Severity::low) {
            findings.push_back(finding);
            continue;
        }
        const int count = g.islands + (grain ? grain->count : 0);
        if (!grain || finding.area_mm2 > grain->area_mm2) grain = finding;
        grain->count = count;
    }
    findings = worst(std::move(findings));
    if (grain) findings.push_back(*grain);
    return findings;
}

/// A large cavity tears the part off by suction, or keeps resin that never cures.
Finding cavity_finding(const slice::Cavity& c, double pixel_mm2) {
    constexpr double large_mm3 = 1;
    const double volume_mm3 = static_cast<double>(c.volume) / 1000 * pixel_mm2;
    return {c.end == slice::Cavity::End::closed ? "trap" : "cup",
            c.first_layer,
            c.last_layer,
            c.row,
            c.column,
            0,
            volume_mm3,
            {},
            slice::severity_name(volume_mm3 >= large_mm3 ? slice::Severity::high : slice::Severity::medium),
            1};
}

/// A part of a layer image as pixels.
class Window {
public:
    Window(const Finding& finding, const slice::Raster& raster)
        : width_(std::min(side_px, raster.width_px)),
          height_(std::min(side_px, raster.height_px)),
          left_(std::clamp(finding.column - width_ / 2, 0, raster.width_px - width_)),
          top_(std::clamp(finding.row - height_ / 2, 0, raster.height_px - height_)),
          image_{width_, height_, std::vector<std::uint8_t>(static_cast<std::size_t>(width_ * height_), 0)} {}

    void fill(int row, int begin, int end, std::uint8_t grey) {
        begin = std::max(begin - left_, 0);
        end = std::min(end - left_, width_);
        if (row < top_ || row >= top_ + height_ || begin >= end) return;
        std::fill(image_.pixels.begin() + at(row - top_, begin), image_.pixels.begin() + at(row - top_, end), grey);
    }
    void draw(const slice::ComposedLayer& layer, std::uint8_t grey) {
        for (const slice::MaterialImage& m : layer.images) {
            for (int row = top_; row < top_ + height_; ++row) {
                for (const slice::Run& run : m.image.row(row)) {
                    if (run.value >= solid_value) fill(row, run.begin, run.end, grey);
                }
            }
        }
    }
    /// Draws the component that contains a pixel.
    void draw_piece(const slice::PieceMap& map, int row, int column, std::uint8_t grey) {
        const auto stretches = map.row(row);
        const auto found = std::find_if(stretches.begin(), stretches.end(),
                                        [&](const slice::Stretch& s) { return s.begin <= column && column < s.end; });
        if (found == stretches.end()) return;
        for (int r = top_; r < top_ + height_; ++r) {
            for (const slice::Stretch& s : map.row(r)) {
                if (s.piece == found->piece) fill(r, s.begin, s.end, grey);
            }
        }
    }
    [[nodiscard]] const Image& image() const { return image_; }

private:
    [[nodiscard]] std::ptrdiff_t at(int row, int column) const {
        return static_cast<std::ptrdiff_t>(row) * width_ + column;
    }

    int width_, height_, left_, top_;
    Image image_;
};

}  // namespace

std::vector<Finding> listed(const slice::Findings& findings, const std::vector<slice::ThinSpot>& thin,
                            const slice::Raster& raster) {
    const double pixel_mm2 = raster.pixel_um * raster.pixel_um / 1e6;
    std::vector<Finding> all = island_findings(findings.groups, pixel_mm2), cavities, spots;
    for (const slice::Cavity& c : findings.cavities) cavities.push_back(cavity_finding(c, pixel_mm2));
    for (const slice::ThinSpot& t : thin)
        spots.push_back({"thin",
                         t.layer,
                         t.last_layer,
                         t.row,
                         t.column,
                         static_cast<double>(t.pixels) * pixel_mm2,
                         0,
                         {},
                         slice::severity_name(slice::Severity::medium),
                         1});
    for (auto* kind : {&cavities, &spots}) {
        const std::vector<Finding> most = worst(std::move(*kind));
        all.insert(all.end(), most.begin(), most.end());
    }
    return all;
}

EncodedImage picture(const Finding& finding, const slice::ComposedLayer& layer, const slice::ComposedLayer& below,
                     const slice::Raster& raster) {
    Window window(finding, raster);
    window.draw(below, below_grey);
    window.draw(layer, layer_grey);
    const slice::LayerShape shape = slice::shape_of(layer, raster.width_px);
    const bool is_void = finding.kind == "trap" || finding.kind == "cup";
    window.draw_piece(is_void ? shape.voids : shape.solid, finding.row, finding.column, mark_grey);
    return encode(window.image());
}

Status add_pictures(std::vector<Finding>& findings, const slice::Raster& raster,
                    const std::function<Result<slice::ComposedLayer>(int)>& layer, Writer& writer) {
    for (std::size_t i = 0; i < findings.size(); ++i) {
        Finding& f = findings[i];
        const auto here = layer(f.first_layer);
        if (!here) return tl::unexpected(here.error());
        const auto below = f.first_layer > 0 ? layer(f.first_layer - 1) : slice::ComposedLayer{};
        if (!below) return tl::unexpected(below.error());
        f.picture = fmt::format("findings/{:02}_{}.png", i, f.kind);
        if (auto status = writer.add_image(f.picture, picture(f, *here, *below, raster)); !status) return status;
    }
    return {};
}

}  // namespace pliant::job

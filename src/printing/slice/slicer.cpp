#include "printing/slice/slicer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "base/core/parallel.hpp"
#include "base/core/text.hpp"
#include "printing/slice/blend.hpp"
#include "printing/slice/layer_text.hpp"
#include "printing/slice/mask.hpp"
#include "printing/slice/place.hpp"
#include "printing/slice/raster_frame.hpp"
#include "printing/slice/repair.hpp"

namespace pliant::slice {
namespace {

/// Points of open edges within this distance are merged, in pixels: invisible in any image.
constexpr double join_px = 0.1;

Status check_settings(const Settings& settings) {
    if (auto status = check(settings.raster); !status) return status;
    if (settings.layer_um < 1 || settings.layer_um > 10000)
        return input_error("layer of {} um: must be 1 to 10000 um", settings.layer_um);
    int below_um = 0;
    for (const int top_um : settings.tops_um) {
        if (top_um <= below_um || top_um - below_um > 10000)
            return input_error("a layer from {} to {} um: must be 1 to 10000 um thick", below_um, top_um);
        below_um = top_um;
    }
    if (!(settings.rules.threshold > 0 && settings.rules.threshold <= 1))
        return input_error("threshold {}: must be above 0 and at most 1", settings.rules.threshold);
    if (!(settings.rules.close_gap_um >= 0))
        return input_error("gap of {:.6g} um to close: must not be negative", settings.rules.close_gap_um);
    for (const auto& [material, compensation] : settings.compensation) {
        if (auto status = check(compensation, "material '" + material + "'"); !status) return status;
    }
    return {};
}

/// Bounds of the body's points in the image; only x and y are used.
Box3 image_box(const Body& body, const RasterFrame& frame) {
    Box3 box;
    const auto add = [&](double x, double y) { box.add({frame.column(x, y), frame.row(x, y), 0}); };
    for (const OutlineSlice& slice : body.slices) {
        for (const auto& outline : slice.outlines_um) {
            for (const auto& [x, y] : outline) add(x, y);
        }
    }
    if (!body.slices.empty()) return box;
    for (const auto& triangle : body.surface_um.triangles) {
        for (const int corner : triangle) add(body.surface_um.points[corner].x, body.surface_um.points[corner].y);
    }
    return box;
}

/// How far outlines of a material are moved outwards in this many layers.
double growth_of(const std::string& material, const Settings& settings, int layers) {
    const auto own = settings.compensation.find(material);
    return own == settings.compensation.end() ? 0 : growth_um(own->second, layers);
}

/// Where the image is on the platform: "which reaches 9.000 mm in x and 5.000 mm in y to both sides of the centre", or
/// its corners if the projector has an offset.
std::string reach_text(const Raster& raster) {
    if (raster.offset_x_um == 0 && raster.offset_y_um == 0) {
        const ImageExtent extent = image_extent(raster);
        return fmt::format("which reaches {:.3f} mm in x and {:.3f} mm in y to both sides of the centre",
                           extent.x_um / 2000, extent.y_um / 2000);
    }
    const RasterFrame frame(raster, 1);
    const auto corner = [&](int column, int row) {
        const std::array<double, 2> at_um = frame.place(column, row);
        return fmt::format("({:.3f}, {:.3f})", at_um[0] / 1000, at_um[1] / 1000);
    };
    return fmt::format("whose corners are at {}, {}, {} and {} mm", corner(0, 0), corner(raster.width_px, 0),
                       corner(raster.width_px, raster.height_px), corner(0, raster.height_px));
}

/// Bodies may exceed the raster's border by rounding errors only, also where they are compensated.
Status check_place(const Body& body, const Box3& box, const Raster& raster, double grow_um, const std::string& label) {
    constexpr double rounding_um = 1;
    if (box.low.z < -rounding_um)
        return input_error("{}: reaches {:.3f} mm below the platform", label, -box.low.z / 1000);
    const double slack = (rounding_um - grow_um) / raster.pixel_um;
    const Box3 image = image_box(body, RasterFrame(raster, 1));
    if (image.low.x < -slack || image.high.x > raster.width_px + slack || image.low.y < -slack ||
        image.high.y > raster.height_px + slack) {
        return input_error("{}: x {:.3f} to {:.3f} mm, y {:.3f} to {:.3f} mm lies outside the image, {}",
                           grown_label(label, grow_um), box.low.x / 1000, box.high.x / 1000, box.low.y / 1000,
                           box.high.y / 1000, reach_text(raster));
    }
    return {};
}

/// All lit pixels.
/// The coverage by all materials. Precondition: each pixel has one owner.
RunImage coverage(const ComposedLayer& layer, const Raster& raster) {
    RunImage all(raster.width_px, raster.height_px);
    for (const MaterialImage& m : layer.images) all = together(all, m.image);
    return all;
}

std::string size_text(const Vec3& size) {
    return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", size.x / 1000, size.y / 1000, size.z / 1000);
}

/// A part drawn in metres and read in millimetres is the usual cause.
tl::unexpected<Error> too_low(std::span<const Body> bodies, int layer_um) {
    const Result<Box3> box = bounds_of_all(bodies);
    const std::string size =
        box && !box->empty() ? fmt::format("; the part measures {}, is its unit right?", size_text(box->size())) : "";
    return input_error("nothing to print: no body reaches the middle of a layer of {} um{}", layer_um, size);
}

}  // namespace

Result<Slicer> Slicer::prepare(std::span<const Body> bodies, const Settings& settings) {
    if (auto status = check_settings(settings); !status) return tl::unexpected(status.error());
    Slicer slicer;
    slicer.settings_ = settings;
    slicer.layers_ = settings.layers();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (auto status = slicer.add_body(bodies[i], describe(bodies[i], i)); !status)
            return tl::unexpected(status.error());
    }
    if (auto status = slicer.check_pairs(); !status) return tl::unexpected(status.error());
    if (slicer.layer_count_ == 0) return too_low(bodies, settings.layer_um);
    return slicer;
}

Status Slicer::add_body(const Body& body, const std::string& label) {
    labels_.push_back(label);
    fillers_.push_back(body.filler);
    const auto box = bounds(body, label);
    if (!body.slices.empty()) {
        if (!box) return tl::unexpected(box.error());
        auto stack = OutlineStack::from(body.slices, layers_, label);
        if (!stack) return tl::unexpected(stack.error());
        measures_.push_back({stack->volume_mm3(), stack->area_mm2()});
        shapes_.emplace_back(std::move(*stack));
    } else {
        auto repaired = repair(body.surface_um, label, layers_, join_px * settings_.raster.pixel_um);
        if (!repaired) return tl::unexpected(repaired.error());
        std::move(repaired->warnings.begin(), repaired->warnings.end(), std::back_inserter(warnings_));
        measures_.push_back({volume_mm3(repaired->surface), slice::area_mm2(repaired->surface)});
        shapes_.emplace_back(Sectioner(std::move(repaired->surface), layers_));
    }
    air_.emplace_back();
    for (const mesh::TriMesh& air_um : body.air_um) {
        auto air = repair(air_um, "the air in " + label, layers_, join_px * settings_.raster.pixel_um);
        if (!air) return tl::unexpected(air.error());
        std::move(air->warnings.begin(), air->warnings.end(), std::back_inserter(warnings_));
        measures_.back().area_mm2 += slice::area_mm2(air->surface);
        air_.back().emplace_back(std::move(air->surface), layers_);
    }
    // The chords of both bodies deviate from their common face, which is at most all of the surface.
    residues_mm3_.push_back(2 * body.chord_um / 1000 * measures_.back().area_mm2);
    if (!box) return tl::unexpected(box.error());
    if (body.blend) {
        if (auto status = check(*body.blend, label); !status) return status;
    }
    const int layers = std::visit([](const auto& shape) { return shape.layer_count(); }, shapes_.back());
    if (auto status = check_place(body, *box, settings_.raster, growth_of(body.material, settings_, layers), label);
        !status)
        return status;
    add_shape(body, box->size());
    return {};
}

/// Adds remarks on the shape added last.
void Slicer::add_shape(const Body& body, const Vec3& size_um) {
    material_of_.push_back(add_material(body.material));
    zone_of_.push_back(add_zone(body));
    const int layers = std::visit([](const auto& shape) { return shape.layer_count(); }, shapes_.back());
    layer_count_ = std::max(layer_count_, layers);
    if (body.filler) return;
    if (layers == 0) {
        warnings_.push_back(fmt::format("{}: {} lies between the middles of two layers of {} um and is not printed",
                                        labels_.back(), size_text(size_um), settings_.layer_um));
    } else if (std::fmin(size_um.x, size_um.y) < settings_.raster.pixel_um) {
        warnings_.push_back(fmt::format("{}: {} is narrower than a pixel of {:.6g} um", labels_.back(),
                                        size_text(size_um), settings_.raster.pixel_um));
    }
}

int Slicer::add_material(const std::string& name) {
    if (material(name) < 0) materials_.push_back(name);
    return material(name);
}

int Slicer::add_zone(const Body& body) {
    Zone zone{material(body.material), -1, static_cast<int>(material_of_.size()) - 1, body.blend};
    if (zone.blend && zone.blend->cell_um > 0)
        zone.blend->cell_px =
            std::clamp(static_cast<int>(std::lround(zone.blend->cell_um / settings_.raster.pixel_um)), 1, 1000);
    if (body.blend) {
        zone.second = add_material(body.blend->second);
    } else {
        for (std::size_t z = 0; z < zones_.size(); ++z) {
            if (zones_[z].material == zone.material && !zones_[z].blend) return static_cast<int>(z);
        }
    }
    zones_.push_back(std::move(zone));
    return static_cast<int>(zones_.size()) - 1;
}

void Slicer::section(std::size_t body, int layer, std::vector<Segment>& segments) const {
    std::visit([&](const auto& shape) { shape.section(layer, segments); }, shapes_[body]);
}

/// Returns the area that `lines`, of the body in an image, lose.
Overlap Slicer::cut_air(std::size_t body, int layer, const Raster& raster, std::vector<Segment>& lines) const {
    std::vector<std::vector<Segment>> outlines{lines};
    std::vector<Segment> segments;
    for (const Sectioner& air : air_[body]) {
        segments.clear();
        air.section(layer, segments);
        if (!segments.empty()) outlines.push_back(in_image(segments, raster, Beyond::kept));
    }
    if (lines.empty() || outlines.size() == 1) return {};
    std::vector<int> material_of(outlines.size(), 1);
    material_of[0] = 0;
    DividedLayer divided = slice::divided(outlines, material_of);
    lines = std::move(divided.kept[0]);
    return divided.areas[0];
}

/// Overlapping bodies are separated as outlines before rasterisation: the coverage of a pixel does not tell whether two
/// outlines cover the same part of it.
ComposedLayer Slicer::composed(int k, const Raster& raster, const ComposeRules& rules) const {
    std::vector<std::vector<Segment>> lines(shapes_.size());
    std::vector<Segment> segments;
    std::vector<Overlap> cut(shapes_.size());
    CellBuffer cells;
    for (std::size_t b = 0; b < shapes_.size(); ++b) {
        segments.clear();
        section(b, k, segments);
        lines[b] = in_image(segments, raster);
        if (!air_[b].empty()) cut[b] = cut_air(b, k, raster, lines[b]);
        cells.add(static_cast<int>(b), lines[b]);
    }
    ComposedLayer layer = compose(cells.sorted(), zone_of_, raster, rules);
    if (layer.overlapping) {
        const DividedLayer divided = slice::divided(lines, material_of_);
        CellBuffer apart;
        for (std::size_t b = 0; b < shapes_.size(); ++b) apart.add(static_cast<int>(b), divided.kept[b]);
        layer = compose(apart.sorted(), zone_of_, raster, rules);
        for (std::size_t b = 0; b < shapes_.size(); ++b) {
            layer.lost_px[b] = divided.areas[b].others;
            layer.doubled_px[b] = divided.areas[b].own;
        }
    }
    for (std::size_t b = 0; b < shapes_.size(); ++b) {
        layer.air_px.push_back(cut[b].others);
        layer.doubled_px[b] += cut[b].own;
    }
    return layer;
}

/// Per zone; empty if no border of the layer moves.
std::vector<double> Slicer::offsets_um(int layer, Foot foot) const {
    std::vector<double> offsets;
    for (const Zone& zone : zones_) {
        const auto known = settings_.compensation.find(materials_[zone.material]);
        if (known == settings_.compensation.end())
            offsets.push_back(0);
        else
            offsets.push_back(foot == Foot::drawn ? known->second.grow_um : known->second.offset_um(layer));
    }
    if (std::all_of(offsets.begin(), offsets.end(), [](double um) { return um == 0; })) offsets.clear();
    return offsets;
}

/// The layer with outer borders moved.
ComposedLayer Slicer::outlined(int k, Foot foot) const {
    const std::vector<double> offsets = offsets_um(k, foot);
    if (offsets.empty()) return composed(k, settings_.raster, settings_.rules);
    const int factor = fine_factor(settings_.raster);
    const ComposedLayer fine = composed(k, refined(settings_.raster, factor), {false, 0.5, 0});
    return compensated(fine, factor, offsets, settings_.raster, settings_.rules);
}

/// Converts zones to materials.
void Slicer::deal_out(int k, ComposedLayer& layer) const {
    std::vector<RunImage> images(materials_.size());
    const double z_um = layers_.middle2_um(k) / 2.0;
    for (MaterialImage& m : layer.images) {
        const Zone& zone = zones_[m.material];
        RunImage own = std::move(m.image);
        if (zone.blend) {
            auto [first, second] = dealt(own, *zone.blend, settings_.raster, z_um, k);
            layer.dealt.push_back({zone.body, static_cast<double>(first.value_sum()) / 255,
                                   static_cast<double>(second.value_sum()) / 255});
            images[zone.second] = slice::together(images[zone.second], second);
            own = std::move(first);
        }
        images[zone.material] = slice::together(images[zone.material], own);
    }
    layer.images.clear();
    for (std::size_t m = 0; m < images.size(); ++m) {
        if (images[m].blank()) continue;
        const std::int64_t sum = images[m].value_sum();
        layer.images.push_back({static_cast<int>(m), std::move(images[m]), sum, 0});
    }
}

void Slicer::take_out(int k, ComposedLayer& layer) const {
    const RunSet removed = settings_.removed->at(k);
    if (removed.empty()) return;
    for (MaterialImage& m : layer.images) {
        m.image = outside(m.image, removed);
        m.value_sum = m.image.value_sum();
    }
    std::erase_if(layer.images, [](const MaterialImage& m) { return m.image.blank(); });
}

/// The layer with one owner per pixel, before light is added or left out.
ComposedLayer Slicer::owned(int k, Foot foot) const {
    ComposedLayer layer = outlined(k, foot);
    if (settings_.removed) take_out(k, layer);
    const bool blends = std::any_of(zones_.begin(), zones_.end(), [](const Zone& z) { return z.blend.has_value(); });
    if (blends) deal_out(k, layer);
    for (const Teeth& teeth : settings_.teeth) {
        int taker = material(teeth.first), giver = material(teeth.second);
        if (k / teeth.layers % 2 == 1) std::swap(taker, giver);
        layer.interlocked.push_back(take_teeth(layer, taker, giver, teeth.depth_px));
    }
    return layer;
}

/// The number of layers below a layer that must be solid where a material is exposed: those whose middle would be
/// reached by light that goes deeper by the material's bleed.
int Slicer::bleed_layers(int material, int k) const {
    const auto known = settings_.compensation.find(materials_[material]);
    if (known == settings_.compensation.end() || known->second.bleed_um <= 0) return 0;
    int count = 0;
    while (count < k && layers_.bottom_um(k) - layers_.middle2_um(k - count - 1) / 2.0 < known->second.bleed_um)
        ++count;
    return count;
}

/// The layer without the light that would go too deep: no pixel gets more than is covered in all layers that must be
/// solid below it. What the elephant foot leaves out below counts as solid: light is to cure it.
ComposedLayer Slicer::bled(int k) const {
    ComposedLayer layer = owned(k, Foot::left_out);
    std::vector<RunImage> held;  // by the number of solid layers required below
    for (MaterialImage& m : layer.images) {
        const auto count = static_cast<std::size_t>(bleed_layers(m.material, k));
        if (count == 0) continue;
        while (held.size() < count) {
            RunImage solid = coverage(owned(k - 1 - static_cast<int>(held.size()), Foot::drawn), settings_.raster);
            held.push_back(held.empty() ? std::move(solid) : lesser(held.back(), solid));
        }
        m.image = lesser(m.image, held[count - 1]);
        m.value_sum = m.image.value_sum();
    }
    std::erase_if(layer.images, [](const MaterialImage& m) { return m.image.blank(); });
    return layer;
}

SlicedLayer Slicer::layer(int k) const {
    SlicedLayer layer = bled(k);
    if (settings_.bonds.empty()) return layer;
    const ComposedLayer owned = layer;
    std::map<int, ComposedLayer> known;
    for (const Bond& bond : settings_.bonds) {
        std::vector<ComposedLayer> around;
        for (int j = std::max(0, k - bond.layers); j <= std::min(layer_count_ - 1, k + bond.layers); ++j) {
            if (j == k) continue;
            if (!known.contains(j)) known[j] = bled(j);
            around.push_back(known[j]);
        }
        layer.overlapped.push_back(
            add_bond(layer, owned, around, material(bond.first), material(bond.second), bond.depth_px));
    }
    return layer;
}

/// Index of a material; -1 if no body names it.
int Slicer::material(const std::string& name) const {
    const auto found = std::find(materials_.begin(), materials_.end(), name);
    return found == materials_.end() ? -1 : static_cast<int>(found - materials_.begin());
}

Status Slicer::check_pair(const char* what, const std::string& first, const std::string& second) const {
    for (const std::string& name : {first, second}) {
        if (material(name) < 0)
            return input_error("{} '{}' with '{}': there is no material '{}', only {}", what, first, second, name,
                               join_names(materials_));
    }
    return {};
}

Status Slicer::check_pairs() const {
    for (const Teeth& teeth : settings_.teeth) {
        if (auto status = check(teeth); !status) return status;
        if (auto status = check_pair("interlock", teeth.first, teeth.second); !status) return status;
    }
    for (const Bond& bond : settings_.bonds) {
        if (auto status = check(bond); !status) return status;
        if (auto status = check_pair("overlap", bond.first, bond.second); !status) return status;
    }
    return {};
}

namespace {

void add_met(const std::vector<bool>& layer, std::vector<bool>& met) {
    for (std::size_t i = 0; i < layer.size(); ++i) met[i] = met[i] || layer[i];
}

/// The pairs of which no part changed a pixel, as in "soft and firm"; an option may stand for several parts.
template <class Pairs>
std::vector<std::string> meeting_nowhere(const Pairs& pairs, const std::vector<bool>& met) {
    std::map<std::tuple<std::string, int, int>, bool> whole;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const std::string named = pairs[i].named.empty() ? pairs[i].first + " and " + pairs[i].second : pairs[i].named;
        bool& any = whole[{named, pairs[i].depth_px, pairs[i].layers}];
        any = any || met[i];
    }
    std::vector<std::string> names;
    for (const auto& [key, any] : whole) {
        if (!any) names.push_back(std::get<0>(key));
    }
    return names;
}

}  // namespace

Tally::Tally(const Slicer& slicer)
    : slicer_(slicer),
      lost_mm3_(slicer.body_labels().size(), 0.0),
      doubled_mm3_(lost_mm3_),
      air_mm3_(lost_mm3_),
      first_mm3_(lost_mm3_),
      second_mm3_(lost_mm3_),
      interlocked_(slicer.settings().teeth.size()),
      overlapped_(slicer.settings().bonds.size()) {}

void Tally::add(int k, const SlicedLayer& layer) {
    const double pixel_um = slicer_.settings().raster.pixel_um;
    const double voxel_mm3 = pixel_um * pixel_um * slicer_.layers().thickness_um(k) / 1e9;
    for (std::size_t b = 0; b < lost_mm3_.size(); ++b) {
        lost_mm3_[b] += layer.lost_px[b] * voxel_mm3;
        doubled_mm3_[b] += layer.doubled_px[b] * voxel_mm3;
        if (b < layer.air_px.size()) air_mm3_[b] += layer.air_px[b] * voxel_mm3;
    }
    for (const DealtBody& d : layer.dealt) {
        first_mm3_[static_cast<std::size_t>(d.body)] += d.first_px * voxel_mm3;
        second_mm3_[static_cast<std::size_t>(d.body)] += d.second_px * voxel_mm3;
    }
    add_met(layer.interlocked, interlocked_);
    add_met(layer.overlapped, overlapped_);
    closed_gap_pixels_ += layer.closed_gap_pixels;
    if (layer.images.empty()) {
        if (pending_empty_++ == 0 && empty_between_ == 0) first_empty_ = k;
        return;
    }
    if (first_filled_ < 0) first_filled_ = k;
    if (last_filled_ >= 0) empty_between_ += pending_empty_;
    pending_empty_ = 0;
    last_filled_ = k;
}

Summary Tally::summary() const {
    const Settings& settings = slicer_.settings();
    Summary summary{slicer_.layer_count(), slicer_.materials(), 0, closed_gap_pixels_, slicer_.warnings(), {}};
    const double voxel_mm3 =
        settings.raster.pixel_um * settings.raster.pixel_um * slicer_.layers().thickness_um(0) / 1e9;
    for (std::size_t b = 0; b < lost_mm3_.size(); ++b) {
        const double lost_mm3 = lost_mm3_[b];
        summary.lost_mm3.push_back(lost_mm3);
        summary.doubled_mm3.push_back(doubled_mm3_[b]);
        summary.air_mm3.push_back(air_mm3_[b]);
        const double all = first_mm3_[b] + second_mm3_[b];
        summary.second_share.push_back(all > 0 ? second_mm3_[b] / all : 0);
        if (lost_mm3 < std::max(voxel_mm3, slicer_.residues_mm3()[b]) || slicer_.fillers()[b]) continue;
        summary.overlap_mm3 += lost_mm3;
        summary.warnings.push_back(
            fmt::format("{}: {:.4g} mm^3 overlap with later bodies of other materials, which keep them",
                        slicer_.body_labels()[b], lost_mm3));
    }
    summary.interlocked = interlocked_;
    summary.overlapped = overlapped_;
    for (const std::string& names : meeting_nowhere(settings.teeth, interlocked_))
        summary.warnings.push_back(
            fmt::format("interlock: {} are side by side in no layer, no pixel changes sides", names));
    for (const std::string& names : meeting_nowhere(settings.bonds, overlapped_))
        summary.warnings.push_back(fmt::format("overlap: {} meet nowhere, no pixel is exposed twice", names));
    if (closed_gap_pixels_ > 0)
        summary.warnings.push_back(fmt::format("gaps of at most {:.6g} um between materials closed in {} pixels",
                                               settings.rules.close_gap_um, closed_gap_pixels_));
    if (first_filled_ > 0)
        summary.warnings.push_back(fmt::format("{} {} empty: nothing touches the platform",
                                               layers_text(0, first_filled_ - 1), first_filled_ == 1 ? "is" : "are"));
    if (empty_between_ > 0)
        summary.warnings.push_back(
            fmt::format("{} empty layers between printed ones, the first is {}: what is above will float",
                        empty_between_, layer_text(first_empty_)));
    return summary;
}

Result<Summary> slice_bodies(std::span<const Body> bodies, const Settings& settings,
                             const std::function<Status(int, int, const RunImage&)>& emit, Progress& progress) {
    auto slicer = Slicer::prepare(bodies, settings);
    if (!slicer) return tl::unexpected(slicer.error());
    Tally tally(*slicer);
    constexpr int batch = layers_at_once;
    const int count = slicer->layer_count();
    for (int first = 0; first < count; first += batch) {
        if (progress.cancelled()) return cancelled();
        progress.advance("slice", static_cast<double>(first) / count);
        std::vector<SlicedLayer> layers(static_cast<std::size_t>(std::min(batch, count - first)));
        parallel_for(layers.size(), 1, [&](std::size_t begin, std::size_t) {
            layers[begin] = slicer->layer(first + static_cast<int>(begin));
        });
        for (std::size_t i = 0; i < layers.size(); ++i) {
            const int k = first + static_cast<int>(i);
            tally.add(k, layers[i]);
            for (const MaterialImage& m : layers[i].images) {
                if (auto status = emit(k, m.material, m.image); !status) return tl::unexpected(status.error());
            }
        }
    }
    progress.advance("slice", 1);
    return tally.summary();
}

}  // namespace pliant::slice

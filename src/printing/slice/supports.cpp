#include "printing/slice/supports.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "base/core/parallel.hpp"
#include "printing/slice/braces.hpp"
#include "printing/slice/inspect.hpp"
#include "printing/slice/layer_shape.hpp"
#include "printing/slice/raster_frame.hpp"
#include "printing/slice/support_shapes.hpp"

namespace pliant::slice {
namespace {

constexpr std::size_t most_tips = 20000;

RunSet solid_of(const ComposedLayer& layer, const Raster& raster) {
    RunSet all(raster.width_px, raster.height_px);
    for (const MaterialImage& m : layer.images) {
        RunImage bright(raster.width_px, raster.height_px);
        for (int row = m.image.first_row(); row < m.image.end_row(); ++row) {
            for (const Run& run : m.image.row(row)) {
                if (run.value >= solid_value) bright.append(row, run.begin, run.end, 255);
            }
        }
        all = united(all, RunSet::lit(bright));
    }
    return all;
}

bool holds(const RunSet& set, int row, int column) {
    const auto spans = set.row(row);
    const auto found =
        std::upper_bound(spans.begin(), spans.end(), column, [](int c, const PixelSpan& s) { return c < s.end; });
    return found != spans.end() && found->begin <= column;
}

/// The contact of a tip: the centre of a pixel, and the layer that it supports.
struct Tip {
    int layer, row, column;
};

/// Tips by position, for fast lookup.
class TipMap {
public:
    TipMap(double spacing_px, double pixel_um, const Layers& layers)
        : spacing_px_(spacing_px), pixel_um_(pixel_um), layers_(layers), cell_px_(std::max(1.0, spacing_px)) {}

    [[nodiscard]] bool near(const Tip& tip) const {
        const int r = cell(tip.row), c = cell(tip.column);
        for (int i = r - 1; i <= r + 1; ++i) {
            for (int j = c - 1; j <= c + 1; ++j) {
                const auto found = cells_.find({i, j});
                if (found == cells_.end()) continue;
                for (const std::size_t other : found->second) {
                    if (distance_px(tips_[other], tip) <= spacing_px_) return true;
                }
            }
        }
        return false;
    }
    void add(const Tip& tip) {
        cells_[{cell(tip.row), cell(tip.column)}].push_back(tips_.size());
        tips_.push_back(tip);
    }
    [[nodiscard]] const std::vector<Tip>& tips() const { return tips_; }

private:
    [[nodiscard]] int cell(int at) const { return static_cast<int>(at / cell_px_); }
    [[nodiscard]] double distance_px(const Tip& a, const Tip& b) const {
        const double up = (layers_.bottom_um(a.layer) - layers_.bottom_um(b.layer)) / pixel_um_;
        return std::hypot(a.row - b.row, a.column - b.column, up);
    }

    double spacing_px_, pixel_um_;
    const Layers& layers_;
    double cell_px_;
    std::vector<Tip> tips_;
    std::map<std::pair<int, int>, std::vector<std::size_t>> cells_;
};

class SupportMaker {
public:
    SupportMaker(std::span<const Body> part, const Settings& settings, const SupportSettings& wanted)
        : part_(part),
          settings_(settings),
          wanted_(wanted),
          layers_(settings.layers()),
          frame_(settings.raster, 1),
          paint_(wanted.paint, settings.raster, layers_),
          tips_(wanted.spacing_um / settings.raster.pixel_um, settings.raster.pixel_um, layers_) {
        // Tips are placed under the drawn shape; light correction and hollowing are applied when everything is sliced
        // together.
        settings_.bonds.clear();
        settings_.compensation.clear();
    }

    Result<Supports> make(Progress& progress) {
        Settings whole = settings_;
        whole.removed = nullptr;
        whole.teeth.clear();  // they may name the material of supports, which the part alone does not have
        const auto slicer = Slicer::prepare(part_, whole);
        if (!slicer) return tl::unexpected(slicer.error());
        if (auto status = slice(*slicer, progress); !status) return tl::unexpected(status.error());
        for (int k = 1; k < static_cast<int>(solids_.size()); ++k) {
            if (progress.cancelled()) return cancelled();
            if (!paint_.empty()) hold_painted(k);
            hold_islands(k);
            if (wanted_.angle_deg > 0) hold_undersides(k);
            if (tips_.tips().size() > most_tips)
                return input_error("more than {} support tips: take a wider spacing or a smaller angle", most_tips);
        }
        return settle(progress);
    }

private:
    Status slice(const Slicer& slicer, Progress& progress) {
        const int count = slicer.layer_count();
        solids_.resize(static_cast<std::size_t>(count));
        shapes_.resize(solids_.size());
        constexpr std::size_t batch = layers_at_once;
        for (std::size_t first = 0; first < solids_.size(); first += batch) {
            if (progress.cancelled()) return cancelled();
            progress.advance("supports", static_cast<double>(first) / static_cast<double>(solids_.size()));
            parallel_for(std::min(batch, solids_.size() - first), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = first + begin; i < first + end; ++i) {
                    const SlicedLayer layer = slicer.layer(static_cast<int>(i));
                    solids_[i] = solid_of(layer, settings_.raster);
                    shapes_[i] = shape_of(layer, settings_.raster.width_px);
                }
            });
        }
        return {};
    }

    /// One tip near the middle of each component that touches nothing below.
    void hold_islands(int k) {
        const PieceMap& pieces = shapes_[static_cast<std::size_t>(k)].solid;
        const RunSet& below = solids_[static_cast<std::size_t>(k - 1)];
        std::vector<bool> held(pieces.pixels.size(), false);
        for (int row = pieces.first_row; row < pieces.first_row + pieces.rows(); ++row) {
            for (const Stretch& s : pieces.row(row)) {
                for (const PixelSpan& b : below.row(row)) {
                    if (b.begin < s.end && s.begin < b.end) held[s.piece] = true;
                }
            }
        }
        for (std::uint32_t p = 0; p < held.size(); ++p) {
            if (!held[p]) add_unless_blocked(middle_of(pieces, p, k));
        }
    }

    /// The pixel of a component nearest to its centroid.
    static Tip middle_of(const PieceMap& pieces, std::uint32_t piece, int k) {
        double rows = 0, columns = 0;
        const auto each = [&](const auto& visit) {
            for (int row = pieces.first_row; row < pieces.first_row + pieces.rows(); ++row) {
                for (const Stretch& s : pieces.row(row)) {
                    if (s.piece == piece) visit(row, s);
                }
            }
        };
        each([&](int row, const Stretch& s) {
            rows += static_cast<double>(row) * (s.end - s.begin);
            columns += (s.begin + s.end - 1) / 2.0 * (s.end - s.begin);
        });
        const auto count = static_cast<double>(pieces.pixels[piece]);
        Tip best{k, 0, 0};
        double nearest = 1e300;
        each([&](int row, const Stretch& s) {
            const int column =
                static_cast<int>(std::clamp(std::round(columns / count), static_cast<double>(s.begin), s.end - 1.0));
            const double distance = std::hypot(row - rows / count, column - columns / count);
            if (distance < nearest) {
                nearest = distance;
                best = {k, row, column};
            }
        });
        return best;
    }

    /// Height over a pixel at the angle.
    [[nodiscard]] double rise_um() const {
        return settings_.raster.pixel_um * std::tan(wanted_.angle_deg * std::numbers::pi / 180);
    }

    /// What of layer k extends beyond a layer below by more than the angle allows; from the nearest one on to which it
    /// may extend by `way_px`.
    [[nodiscard]] RunSet hanging_over(int k, double way_px) const {
        const double rise = rise_um();
        const auto allowed_px = [&](int j) { return (layers_.middle2_um(k) - layers_.middle2_um(j)) / 2.0 / rise; };
        int j = k - 1;
        while (j > 0 && allowed_px(j) < way_px) --j;
        const int reach_px = static_cast<int>(std::ceil(allowed_px(j) + 0.5));
        return without(solids_[static_cast<std::size_t>(k)], grown(solids_[static_cast<std::size_t>(j)], reach_px));
    }

    /// True for the layers in which one of eight equal parts of such a way's height begins.
    [[nodiscard]] bool is_due(int k, double way_px) const {
        const double part_um = way_px * rise_um() / 8;
        const auto part_of = [&](int layer) { return std::floor(layers_.middle2_um(layer) / 2.0 / part_um); };
        return part_of(k) > part_of(k - 1);
    }

    /// Supports what hangs over. Both outlines are rounded to pixels: on a short way only flat undersides exceed that,
    /// and the longer it is, the nearer to the angle. Long ways are slow, and need not be gone from every layer.
    void hold_undersides(int k) {
        RunSet hanging = hanging_over(k, 1);
        for (const double way_px : {4.0, 16.0, 32.0}) {
            if (is_due(k, way_px)) hanging = united(hanging, hanging_over(k, way_px));
        }
        for (int row = hanging.first_row(); row < hanging.end_row(); ++row) {
            for (const PixelSpan& span : hanging.row(row)) {
                for (int column = span.begin; column < span.end; ++column) {
                    Tip tip{k, row, column};
                    if (tips_.near(tip)) continue;
                    while (tip.layer > 0 && holds(solids_[static_cast<std::size_t>(tip.layer - 1)], row, column))
                        --tip.layer;
                    if (tip.layer > 0 && !tips_.near(tip)) add_unless_blocked(tip);
                }
            }
        }
    }

    [[nodiscard]] SupportWish wish(const Tip& tip) const { return paint_.at(tip.layer, tip.row, tip.column); }

    bool add_unless_blocked(const Tip& tip) {
        const SupportWish wish = this->wish(tip);
        if (wish == SupportWish::block) return false;
        if (wish == SupportWish::enforce) ++painted_;
        tips_.add(tip);
        return true;
    }

    void add_where_painted(const Tip& tip) {
        if (wish(tip) != SupportWish::enforce || tips_.near(tip)) return;
        ++painted_;
        tips_.add(tip);
    }

    /// Supports undersides painted to be supported, whatever their angle: first at the centres of the strokes, then
    /// where the gaps are still too wide.
    void hold_painted(int k) {
        const RunSet open = without(solids_[static_cast<std::size_t>(k)], solids_[static_cast<std::size_t>(k - 1)]);
        for (const auto& [row, column] : paint_.middles(k)) {
            if (holds(open, row, column)) add_where_painted({k, row, column});
        }
        for (int row = open.first_row(); row < open.end_row(); ++row) {
            for (const PixelSpan& span : open.row(row)) {
                for (int column = span.begin; column < span.end; ++column) add_where_painted({k, row, column});
            }
        }
    }

    /// Slices part and supports together until no island remains.
    Result<Supports> settle(Progress& progress) {
        for (int round = 0;; ++round) {
            Supports supports = built();
            std::vector<Body> all = supports.bodies;
            all.insert(all.end(), part_.begin(), part_.end());
            const auto slicer = Slicer::prepare(all, settings_);
            if (!slicer) return tl::unexpected(slicer.error());
            const Result<std::vector<Island>> islands = islands_of(*slicer, supports.volume_mm3, progress);
            if (!islands) return tl::unexpected(islands.error());
            supports.islands_left = static_cast<int>(islands->size());
            if (islands->empty() || round == support_rounds) return supports;
            bool more = false;
            for (const Island& island : *islands)
                more = add_unless_blocked({island.layer, island.row, island.column}) || more;
            if (!more) return supports;
        }
    }

    [[nodiscard]] Result<std::vector<Island>> islands_of(const Slicer& slicer, double& filled_mm3,
                                                         Progress& progress) const {
        Tally tally(slicer);
        Inspector inspector;
        constexpr int batch = 16;  // layers with many supports take a while each
        for (int first = 0; first < slicer.layer_count(); first += batch) {
            if (progress.cancelled()) return cancelled();
            progress.advance("supports", static_cast<double>(first) / slicer.layer_count());
            std::vector<SlicedLayer> layers(static_cast<std::size_t>(std::min(batch, slicer.layer_count() - first)));
            std::vector<LayerShape> shapes(static_cast<std::size_t>(std::min(batch, slicer.layer_count() - first)));
            parallel_for(shapes.size(), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    layers[i] = slicer.layer(first + static_cast<int>(i));
                    shapes[i] = shape_of(layers[i], settings_.raster.width_px);
                }
            });
            for (std::size_t i = 0; i < shapes.size(); ++i) {
                tally.add(first + static_cast<int>(i), layers[i]);
                inspector.add(std::move(shapes[i]));
            }
        }
        filled_mm3 = volume_of_fillers(slicer, tally.summary());
        return inspector.finish().islands;
    }

    static double volume_of_fillers(const Slicer& slicer, const Summary& summary) {
        double volume = 0;
        for (std::size_t b = 0; b < slicer.fillers().size(); ++b) {
            if (slicer.fillers()[b])
                volume += slicer.measures()[b].volume_mm3 - summary.lost_mm3[b] - summary.doubled_mm3[b];
        }
        return volume;
    }

    [[nodiscard]] Supports built() const {
        Supports supports;
        supports.painted = painted_;
        std::vector<std::array<double, 2>> feet;
        std::vector<Column> columns;
        std::vector<Pillar> pillars;
        for (const Tip& tip : tips_.tips()) {
            columns.push_back(column_of(tip));
            pillars.push_back(columns.back().pillar);
            supports.on_part += columns.back().on_part ? 1 : 0;
            if (!columns.back().on_part) feet.push_back({pillars.back().x_um, pillars.back().y_um});
            ++supports.tips;
        }
        const Braces tied = braces(pillars, least_strut_um(), [&](const Strut& s) { return meets_part(s); });
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (!tied.held[i]) columns[i].foot_r = std::max(columns[i].foot_r, lone_foot_um(pillars[i]) / 2);
            const Pillar& p = pillars[i];
            supports.bodies.push_back(filler(turned_solid(p.x_um, p.y_um, profile(columns[i]))));
        }
        for (const Strut& s : tied.struts) supports.bodies.push_back(filler(rod(s.from_um, s.to_um, s.radius_um)));
        supports.struts = static_cast<int>(tied.struts.size());
        if (wanted_.raft_um > 0 && !feet.empty())
            supports.bodies.push_back(filler(hull_prism(feet, 2 * wanted_.pillar_um, 0, wanted_.raft_um)));
        return supports;
    }

    /// Radius of a strut that stands on itself: it rises at 45 degrees, so that its circle moves by the thickness of a
    /// layer from one layer to the next. Two pixels of it remain above itself in the thickest one.
    [[nodiscard]] double least_strut_um() const {
        int thickest_um = 0;
        for (int k = 0; k < static_cast<int>(solids_.size()); ++k)
            thickest_um = std::max(thickest_um, layers_.thickness_um(k));
        return settings_.raster.pixel_um + thickest_um / 2.0;
    }

    /// Allows twice the slenderness of a braced pillar.
    static double lone_foot_um(const Pillar& p) { return (p.high_um - p.low_um) / (2 * slender); }

    /// Whether the part is in a strut or directly beside it.
    [[nodiscard]] bool meets_part(const Strut& s) const {
        const double margin_px = s.radius_um / settings_.raster.pixel_um + 1;
        for (int k = 0; k < static_cast<int>(solids_.size()); ++k) {
            const double z = layers_.middle2_um(k) / 2.0;
            if (z < s.from_um.z) continue;
            if (z > s.to_um.z) break;
            const Vec3 p = s.from_um + (z - s.from_um.z) / (s.to_um.z - s.from_um.z) * (s.to_um - s.from_um);
            const double row = frame_.row(p.x, p.y), column = frame_.column(p.x, p.y);
            for (const int down : {-1, 0, 1}) {
                for (const int right : {-1, 0, 1}) {
                    if (holds(solids_[static_cast<std::size_t>(k)], static_cast<int>(row + down * margin_px),
                              static_cast<int>(column + right * margin_px)))
                        return true;
                }
            }
        }
        return false;
    }

    [[nodiscard]] Body filler(mesh::TriMesh surface) const {
        Body body{wanted_.material, std::move(surface), "support"};
        body.filler = true;
        return body;
    }

    /// Top of the part below a tip; 0: the platform.
    [[nodiscard]] int top_of_part_below(const Tip& tip) const {
        for (int k = std::min(tip.layer, static_cast<int>(solids_.size())) - 1; k >= 0; --k) {
            if (holds(solids_[static_cast<std::size_t>(k)], tip.row, tip.column)) return layers_.top_um(k);
        }
        return 0;
    }

    /// One support, from the bottom up: foot or second tip, pillar, cone, tip.
    struct Column {
        Pillar pillar;
        bool on_part = false;
        double base_um = 0, held_um = 0, end_um = 0;  ///< base of the support; contact with the part; end inside the
                                                      ///< part
        double tip_r = 0, foot_r = 0;
        double cone_um = 0;  ///< height from the pillar to a tip
    };

    /// Cones are twice as long as the pillar is wide, if there is room.
    [[nodiscard]] Column column_of(const Tip& tip) const {
        const auto [x, y] = frame_.place(tip.column + 0.5, tip.row + 0.5);
        const int standing_um = top_of_part_below(tip);
        Column c;
        c.on_part = standing_um > 0;
        c.tip_r = std::max(wanted_.tip_um, 2 * settings_.raster.pixel_um) / 2;
        c.end_um = layers_.top_um(tip.layer);  // one layer deep into the part
        c.held_um = layers_.bottom_um(tip.layer);
        c.base_um = c.on_part ? standing_um : std::min<double>(wanted_.raft_um, c.held_um / 2);
        const double pillar_r = std::max(wanted_.pillar_um / 2, c.tip_r), room = c.held_um - c.base_um;
        const double cone = 4 * pillar_r;
        const double wide = std::min(pillar_r, c.tip_r + (pillar_r - c.tip_r) * room / (c.on_part ? 2 * cone : cone));
        c.cone_um = std::min(cone, c.on_part ? room / 2 : room);
        const double low = c.base_um + (c.on_part ? c.cone_um : foot_um(c));
        c.pillar = {x, y, low, std::max(low, c.held_um - c.cone_um), wide};
        c.foot_r = wanted_.raft_um > 0 ? wide : 1.5 * wide;
        return c;
    }

    /// Height of the foot.
    [[nodiscard]] double foot_um(const Column& c) const {
        return wanted_.raft_um > 0 ? 0 : std::min(500.0, (c.held_um - c.base_um) / 4);
    }

    [[nodiscard]] std::vector<Ring> profile(const Column& c) const {
        const double wide = c.pillar.radius_um;
        std::vector<Ring> rings;
        if (c.on_part) {
            rings = {{c.base_um - std::min(c.base_um, static_cast<double>(layers_.thickness_um(0))), c.tip_r},
                     {c.base_um, c.tip_r}};
            rings.push_back({c.pillar.low_um, wide});
        } else {
            rings.push_back({c.base_um, c.foot_r});
            // A pillar that stands alone tapers over its whole height.
            if (c.pillar.low_um > c.base_um && c.foot_r <= 1.5 * wide) rings.push_back({c.pillar.low_um, wide});
        }
        if (c.pillar.high_um > rings.back().z_um) rings.push_back({c.pillar.high_um, wide});
        rings.push_back({c.held_um, c.tip_r});
        rings.push_back({c.end_um, c.tip_r});
        return rings;
    }

    std::span<const Body> part_;
    Settings settings_;
    SupportSettings wanted_;
    Layers layers_;
    RasterFrame frame_;
    SupportPaint paint_;
    TipMap tips_;
    int painted_ = 0;
    std::vector<RunSet> solids_;
    std::vector<LayerShape> shapes_;
};

}  // namespace

Status check(const SupportSettings& s) {
    constexpr double most_um = 50000, thickest_raft_um = 20000;
    const std::pair<const char*, double> lengths[] = {
        {"spacing", s.spacing_um}, {"tip", s.tip_um}, {"pillar", s.pillar_um}};
    for (const auto& [what, um] : lengths) {
        if (!(um > 0 && um <= most_um))
            return input_error("supports: {} of {:.6g} um: must be above 0 and at most 50 mm", what, um);
    }
    if (s.tip_um > s.pillar_um)
        return input_error("supports: a tip of {:.6g} um is wider than its pillar of {:.6g} um", s.tip_um, s.pillar_um);
    if (s.spacing_um < s.tip_um)
        return input_error("supports: a spacing of {:.6g} um is less than the diameter of a tip, {:.6g} um",
                           s.spacing_um, s.tip_um);
    if (!(s.raft_um >= 0 && s.raft_um <= thickest_raft_um))
        return input_error("supports: raft of {:.6g} um: must be 0 to 20 mm", s.raft_um);
    if (!(s.angle_deg >= 0 && s.angle_deg <= 89))
        return input_error("supports: angle of {} degrees: must be 0 to 89", s.angle_deg);
    if (s.material.empty()) return input_error("supports: a material is needed");
    for (const SupportTouch& touch : s.paint) {
        if (Status status = check(touch); !status) return status;
    }
    return {};
}

Result<Supports> make_supports(std::span<const Body> part, const Settings& settings, const SupportSettings& supports,
                               Progress& progress) {
    if (auto status = check(supports); !status) return tl::unexpected(status.error());
    return SupportMaker(part, settings, supports).make(progress);
}

}  // namespace pliant::slice

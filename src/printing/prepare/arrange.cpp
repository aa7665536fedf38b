// Placement of the part, and supports under it.
#include "printing/slice/arrange.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "base/core/counted.hpp"
#include "printing/plan/plan.hpp"
#include "printing/prepare/option_text.hpp"
#include "printing/prepare/paint_file.hpp"
#include "printing/prepare/settings.hpp"
#include "printing/slice/adaptive.hpp"
#include "printing/slice/hollow.hpp"
#include "printing/slice/place.hpp"
#include "printing/slice/supports.hpp"

namespace pliant::prepare {
namespace {

std::string number(int count, std::string_view word) {
    return counted(static_cast<std::size_t>(count), word);
}

Status read_lengths(std::initializer_list<std::tuple<const char*, const std::string*, double*>> wanted) {
    for (const auto& [option, text, um] : wanted) {
        const Result<double> length = length_um(option, *text, *um);
        if (!length) return tl::unexpected(length.error());
        *um = *length;
    }
    return {};
}

Result<slice::SupportSettings> support_settings(const Order& order) {
    slice::SupportSettings s;
    s.material = order.support;
    if (!order.support_angle.empty()) {
        const Result<double> angle = plain_degrees("--support-angle", order.support_angle);
        if (!angle) return tl::unexpected(angle.error());
        s.angle_deg = *angle;
    }
    Status status = read_lengths({{"--support-spacing", &order.support_spacing, &s.spacing_um},
                                  {"--support-tip", &order.support_tip, &s.tip_um},
                                  {"--support-pillar", &order.support_pillar, &s.pillar_um},
                                  {"--raft", &order.raft, &s.raft_um}});
    if (status) status = slice::check(s);
    if (!status) return tl::unexpected(status.error());
    return s;
}

Result<double> spacing_um(const Order& order) {
    double um = 0;
    if (Status status = read_lengths({{"--spacing", &order.spacing, &um}}); !status)
        return tl::unexpected(status.error());
    if (um < 0) return input_error("--spacing {}: must be 0 or more", order.spacing);
    return um;
}

/// The wanted position of the centre, relative to the platform's.
Result<Vec3> shift_of(const Order& order) {
    if (order.at.empty()) return Vec3{};
    constexpr double um = 1000, most_mm = 1000;
    if (order.at.size() != 2) return input_error("--at: two numbers in mm are needed, from the middle of the platform");
    if (!(std::fabs(order.at[0]) <= most_mm && std::fabs(order.at[1]) <= most_mm))
        return input_error("--at {:g} {:g}: must be -{:g} to {:g} mm from the middle of the platform", order.at[0],
                           order.at[1], most_mm, most_mm);
    return Vec3{um * order.at[0], um * order.at[1], 0};
}

/// Copies stand within the image, and on the platform.
slice::Room room_of(const job::JobSettings& settings) {
    slice::Room room = settings.slicing.raster;
    if (settings.edge && settings.edge->limits()) room.limit(settings.edge->width_um(), settings.edge->depth_um());
    return room;
}

/// How far a body's outlines are moved outwards.
double growth_of(const job::JobSettings& settings, const std::string& material, double top_um) {
    const auto own = settings.slicing.compensation.find(material);
    if (own == settings.slicing.compensation.end()) return 0;
    return slice::growth_um(own->second, settings.slicing.layers().middles_up_to(std::lround(top_um), 1));
}

/// Supports and rafts count too, and compensation.
Status check_edge(const job::JobSettings& settings, const Drawing& drawing) {
    if (!settings.edge) return {};
    for (std::size_t i = 0; i < drawing.bodies.size(); ++i) {
        const std::string label = describe(drawing.bodies[i], i);
        const Result<Box3> box = bounds(drawing.bodies[i], label);
        if (!box) return tl::unexpected(box.error());
        if (box->empty()) continue;
        const double grow = growth_of(settings, drawing.bodies[i].material, box->high.z);
        const Vec3 around{grow, grow, 0};
        const Status status = job::check_on_platform(*settings.edge, {box->low - around, box->high + around},
                                                     slice::grown_label(label, grow));
        if (!status) return status;
    }
    return {};
}

/// Hollowing and supports take long for a tall part, too. Rounded down: the slicer's own count has the last word.
Status check_tall(const job::JobSettings& settings, const Drawing& drawing) {
    if (settings.build_height_um <= 0) return {};
    const Result<Box3> box = slice::bounds_of_all(drawing.bodies);
    if (!box) return tl::unexpected(box.error());
    if (box->empty() || box->high.z < settings.build_height_um) return {};
    const slice::Layers layers = settings.slicing.layers();
    constexpr double far_um = 1e9;  // beyond any machine, within what layers can count
    const int count = layers.middles_up_to(static_cast<std::int64_t>(std::min(box->high.z, far_um)), 1);
    if (count == 0) return {};
    return plan::check_height(settings.name, layers.top_um(count - 1), settings.printer, settings.build_height_um);
}

Status place(const Order& order, const job::JobSettings& settings, Drawing& drawing) {
    const slice::Raster& raster = settings.slicing.raster;
    if (order.scale != 1) {
        if (Status status = slice::scale(drawing.bodies, order.scale); !status)
            return input_error("--scale: {}", status.error().message);
    }
    if (!order.turn.empty()) {
        const Vec3 degrees{order.turn[0], order.turn[1], order.turn[2]};
        if (Status status = slice::turn(drawing.bodies, degrees); !status) return status;
    }
    const Result<double> spacing = spacing_um(order);
    if (!spacing) return tl::unexpected(spacing.error());
    if (Status status = slice::repeat(drawing.bodies, order.copies, *spacing, room_of(settings)); !status)
        return status;
    const Result<std::vector<std::string>> warnings = slice::place_on_platform(drawing.bodies, raster);
    if (!warnings) return tl::unexpected(warnings.error());
    drawing.warnings.insert(drawing.warnings.end(), warnings->begin(), warnings->end());
    const Result<Vec3> shift = shift_of(order);
    if (!shift) return tl::unexpected(shift.error());
    for (slice::Body& body : drawing.bodies) slice::move(body, *shift);
    return {};
}

/// None where nothing is painted.
Result<std::vector<slice::SupportTouch>> painted(const Order& order) {
    if (order.support_paint.empty()) return std::vector<slice::SupportTouch>{};
    if (order.support.empty()) return input_error("--support-paint: needs --support MATERIAL");
    return read_paint(order.support_paint, order.support_paint_file);
}

/// Makes painted places follow the part: adds them as points of a body without triangles or material, which is copied
/// with the part. After each place comes a point one millimetre outwards.
Status add_paint(const Order& order, Drawing& drawing, std::vector<slice::SupportTouch>& touches) {
    if (order.support_paint.empty()) return {};
    auto read = painted(order);
    if (!read) return tl::unexpected(read.error());
    touches = std::move(*read);
    slice::Body carrier;
    for (const slice::SupportTouch& t : touches) {
        carrier.surface_um.points.push_back(t.at_um);
        carrier.surface_um.points.push_back(t.at_um + (1000 / norm(t.normal)) * t.normal);
    }
    drawing.bodies.push_back(std::move(carrier));
    return {};
}

/// Converts those bodies back to strokes on every copy and removes them; a later stroke comes after earlier ones of all
/// copies, which its ball may reach.
std::vector<slice::SupportTouch> take_paint(Drawing& drawing, const std::vector<slice::SupportTouch>& touches,
                                            double scale) {
    std::vector<slice::SupportTouch> placed;
    for (std::size_t i = 0; i < touches.size(); ++i) {
        for (const slice::Body& body : drawing.bodies) {
            if (!body.material.empty()) continue;
            const std::vector<Vec3>& points = body.surface_um.points;
            const Vec3 out = points[2 * i + 1] - points[2 * i];
            placed.push_back({touches[i].wish, points[2 * i], (1 / norm(out)) * out, scale * touches[i].radius_um});
        }
    }
    std::erase_if(drawing.bodies, [](const slice::Body& body) { return body.material.empty(); });
    return placed;
}

bool enforces(const std::vector<slice::SupportTouch>& touches) {
    return std::any_of(touches.begin(), touches.end(),
                       [](const slice::SupportTouch& t) { return t.wish == slice::SupportWish::enforce; });
}

/// With a raft the part must be above it, or there is nothing to break away.
Result<double> lift_um(const Order& order, double raft_um) {
    constexpr double usual_um = 5000, most_um = 100000;
    double lift_um = raft_um > 0 ? raft_um + usual_um : 0;
    if (Status status = read_lengths({{"--lift", &order.lift, &lift_um}}); !status)
        return tl::unexpected(status.error());
    if (!(lift_um >= 0 && lift_um <= most_um)) return input_error("--lift {}: must be 0 to 100 mm", order.lift);
    if (raft_um > 0 && lift_um < raft_um + 500)
        return input_error("--lift {}: must be at least half a millimetre more than the raft of {:.6g} mm", order.lift,
                           raft_um / 1000);
    return lift_um;
}

Status lift(const Order& order, double raft_um, Drawing& drawing) {
    const Result<double> height_um = lift_um(order, raft_um);
    if (!height_um) return tl::unexpected(height_um.error());
    for (slice::Body& body : drawing.bodies) slice::move(body, {0, 0, *height_um});
    return {};
}

Status set_heights(const Order& order, const Drawing& drawing, slice::Settings& slicing) {
    if (order.least_layer.empty()) return {};
    const Result<int> least_um = layer_height_um("--least-layer", order.least_layer);
    if (!least_um) return tl::unexpected(least_um.error());
    if (*least_um > slicing.layer_um)
        return input_error("--least-layer {}: must be 1 um to the layer height, {} um", order.least_layer,
                           slicing.layer_um);
    auto tops = slice::adaptive_tops(drawing.bodies, {*least_um, slicing.layer_um});
    if (!tops) return input_error("--least-layer: {}", tops.error().message);
    slicing.tops_um = std::move(*tops);
    return {};
}

/// A plate that does not reach the middle of the first layer would not be printed.
Status check_raft(const Order& order, double raft_um, const slice::Layers& layers) {
    if (raft_um <= 0 || 2 * raft_um >= layers.middle2_um(0)) return {};
    return input_error("--raft {}: is less than half of the first layer and would not be printed: give at least {} um",
                       order.raft, layers.top_um(0));
}

void note_wide_tips(const Order& order, double tip_um, double pixel_um, std::vector<std::string>& warnings) {
    if (order.support_tip.empty() || tip_um >= 2 * pixel_um) return;
    warnings.push_back(fmt::format("--support-tip {}: is less than two pixels; tips are {:g} mm wide",
                                   order.support_tip, 2 * pixel_um / 1000));
}

void note_touching_pillars(const Order& order, const slice::SupportSettings& wanted,
                           std::vector<std::string>& warnings) {
    if (order.support_spacing.empty() || wanted.spacing_um > wanted.pillar_um) return;
    warnings.push_back(
        fmt::format("--support-spacing {}: pillars of {:g} mm touch each other and may close cavities; "
                    "wider spacing or thinner pillars stand apart",
                    order.support_spacing, wanted.pillar_um / 1000));
}

void note_thin_walls(const Order& order, double wall_um, const slice::Settings& slicing,
                     std::vector<std::string>& warnings) {
    const double pixel_um = slicing.raster.pixel_um;
    if (wall_um < 2 * pixel_um)
        warnings.push_back(fmt::format("--hollow {}: is less than two pixels of {:g} um; walls become thicker",
                                       order.hollow, pixel_um));
    else if (wall_um < 2 * slicing.layer_um)
        warnings.push_back(
            fmt::format("--hollow {}: is less than two layers of {} um; floors and ceilings become "
                        "thicker",
                        order.hollow, slicing.layer_um));
}

Status hollow_part(const Order& order, job::JobSettings& settings, Drawing& drawing, std::vector<std::string>& notes,
                   Progress& progress) {
    if (order.hollow.empty()) return {};
    const Result<slice::HollowSettings> hollow = hollow_settings(order);
    if (!hollow) return tl::unexpected(hollow.error());
    note_thin_walls(order, hollow->wall_um, settings.slicing, drawing.warnings);
    auto made = slice::hollow_out(drawing.bodies, settings.slicing, *hollow, progress);
    if (!made) return tl::unexpected(made.error());
    settings.slicing.removed = made->removed;
    drawing.warnings.insert(drawing.warnings.end(), made->warnings.begin(), made->warnings.end());
    notes.push_back(fmt::format("hollow: {} of {:.1f} mm^3, {}",
                                made->cavities == 1 ? "1 cavity" : fmt::format("{} cavities", made->cavities),
                                made->volume_mm3, number(made->drains, "drain")));
    return {};
}

}  // namespace

Result<slice::HollowSettings> hollow_settings(const Order& order) {
    slice::HollowSettings hollow;
    Status status =
        read_lengths({{"--hollow", &order.hollow, &hollow.wall_um}, {"--drain", &order.drain, &hollow.drain_um}});
    if (!status) return tl::unexpected(status.error());
    if (!(hollow.wall_um > 0 && hollow.wall_um <= slice::most_hollow_um))
        return input_error("--hollow {}: must be above 0 and at most 100 mm", order.hollow);
    if (!(hollow.drain_um >= 0 && hollow.drain_um <= slice::most_hollow_um))
        return input_error("--drain {}: must be 0 to 100 mm", order.drain);
    return hollow;
}

Status check_companions(const Order& order) {
    for (const auto& [option, text] :
         {std::pair{"--raft", &order.raft}, std::pair{"--lift", &order.lift},
          std::pair{"--support-angle", &order.support_angle}, std::pair{"--support-spacing", &order.support_spacing},
          std::pair{"--support-tip", &order.support_tip}, std::pair{"--support-pillar", &order.support_pillar}}) {
        if (order.support.empty() && !text->empty()) return input_error("{}: needs --support MATERIAL", option);
    }
    if (order.hollow.empty() && !order.drain.empty()) return input_error("--drain: needs --hollow");
    return {};
}

Status check_supports(const Order& order) {
    if (const auto touches = painted(order); !touches) return tl::unexpected(touches.error());
    if (order.support.empty()) return {};
    const Result<slice::SupportSettings> settings = support_settings(order);
    if (!settings) return tl::unexpected(settings.error());
    const Result<double> height_um = lift_um(order, settings->raft_um);
    return height_um ? Status() : tl::unexpected(height_um.error());
}

Status arrange(const Order& order, job::JobSettings& settings, Drawing& drawing, std::vector<std::string>& notes,
               Progress& progress) {
    if (!drawing.stacks.empty()) return {};
    if (Status status = check_companions(order); !status) return status;
    const bool supported = !order.support.empty();
    std::vector<slice::SupportTouch> touches;
    if (Status status = add_paint(order, drawing, touches); !status) return status;
    if (Status status = place(order, settings, drawing); !status) return status;
    slice::SupportSettings wanted;
    if (supported) {
        Result<slice::SupportSettings> read = support_settings(order);
        if (!read) return tl::unexpected(read.error());
        wanted = std::move(*read);
        if (Status status = lift(order, wanted.raft_um, drawing); !status) return status;
        wanted.paint = take_paint(drawing, touches, order.scale);
    }
    if (Status status = check_edge(settings, drawing); !status) return status;
    if (Status status = set_heights(order, drawing, settings.slicing); !status) return status;
    if (Status status = check_tall(settings, drawing); !status) return status;
    if (Status status = hollow_part(order, settings, drawing, notes, progress); !status) return status;
    if (!supported) return {};
    if (Status status = check_raft(order, wanted.raft_um, settings.slicing.layers()); !status) return status;
    note_wide_tips(order, wanted.tip_um, settings.slicing.raster.pixel_um, drawing.warnings);
    note_touching_pillars(order, wanted, drawing.warnings);
    auto supports = slice::make_supports(drawing.bodies, settings.slicing, wanted, progress);
    if (!supports) return tl::unexpected(supports.error());
    notes.push_back(fmt::format("supports: {}, {} of them on the part itself, {}, {:.1f} mm^3",
                                number(supports->tips, "tip"), supports->on_part, number(supports->struts, "strut"),
                                supports->volume_mm3));
    if (!wanted.paint.empty()) notes.push_back(fmt::format("painted supports: {} of the tips", supports->painted));
    if (supports->painted == 0 && enforces(wanted.paint))
        drawing.warnings.push_back("painted supports: no place to be supported lies on an underside of the part");
    if (supports->islands_left > 0)
        drawing.warnings.push_back(fmt::format("supports do not reach {}", number(supports->islands_left, "island")));
    drawing.bodies.insert(drawing.bodies.begin(), std::make_move_iterator(supports->bodies.begin()),
                          std::make_move_iterator(supports->bodies.end()));
    return check_edge(settings, drawing);
}

}  // namespace pliant::prepare

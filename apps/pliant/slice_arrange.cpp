// Where the part stands, and what stands under it.
#include <charconv>
#include <cmath>
#include <tuple>

#include "core/units.hpp"
#include "slice/adaptive.hpp"
#include "slice/arrange.hpp"
#include "slice/hollow.hpp"
#include "slice/place.hpp"
#include "slice/supports.hpp"
#include "slice_settings.hpp"

namespace pliant::app {
namespace {

/// Micrometres; `otherwise` where the option was not given.
Result<double> length_um(const char* option, const std::string& text, double otherwise) {
    if (text.empty()) return otherwise;
    const Result<double> length = parse_quantity(text, Dimension::length);
    if (!length) return input_error("{}: {}", option, length.error().message);
    return *length * 1e6;
}

Status read_lengths(std::initializer_list<std::tuple<const char*, const std::string*, double*>> wanted) {
    for (const auto& [option, text, um] : wanted) {
        const Result<double> length = length_um(option, *text, *um);
        if (!length) return tl::unexpected(length.error());
        *um = *length;
    }
    return {};
}

Result<slice::SupportSettings> support_settings(const SliceOptions& options) {
    slice::SupportSettings s;
    s.material = options.support;
    if (!options.support_angle.empty()) {
        const std::string& text = options.support_angle;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), s.angle_deg);
        if (error != std::errc() || end != text.data() + text.size())
            return input_error("--support-angle {}: a number of degrees is needed", text);
    }
    Status status = read_lengths({{"--support-spacing", &options.support_spacing, &s.spacing_um},
                                  {"--support-tip", &options.support_tip, &s.tip_um},
                                  {"--support-pillar", &options.support_pillar, &s.pillar_um},
                                  {"--raft", &options.raft, &s.raft_um}});
    if (status) status = slice::check(s);
    if (!status) return tl::unexpected(status.error());
    return s;
}

Status place(const SliceOptions& options, const slice::Raster& raster, Drawing& drawing) {
    if (!options.turn.empty()) {
        const Vec3 degrees{options.turn[0], options.turn[1], options.turn[2]};
        if (Status status = slice::turn(drawing.bodies, degrees); !status) return status;
    }
    double spacing_um = 0;
    if (Status status = read_lengths({{"--spacing", &options.spacing, &spacing_um}}); !status) return status;
    if (Status status = slice::repeat(drawing.bodies, options.copies, spacing_um, raster); !status) return status;
    const Result<std::vector<std::string>> warnings = slice::place_on_platform(drawing.bodies, raster);
    if (!warnings) return tl::unexpected(warnings.error());
    drawing.warnings.insert(drawing.warnings.end(), warnings->begin(), warnings->end());
    return {};
}

/// With a raft the part must be off it, or there is nothing to break away.
Status lift(const SliceOptions& options, double raft_um, Drawing& drawing) {
    constexpr double usual_um = 5000, most_um = 100000;
    double lift_um = raft_um > 0 ? raft_um + usual_um : 0;
    if (Status status = read_lengths({{"--lift", &options.lift, &lift_um}}); !status) return status;
    if (!(lift_um >= 0 && lift_um <= most_um)) return input_error("--lift {}: must be 0 to 100 mm", options.lift);
    if (raft_um > 0 && lift_um < raft_um + 500)
        return input_error("--lift {}: must be at least half a millimetre more than the raft of {:.6g} mm",
                           options.lift, raft_um / 1000);
    for (slice::Body& body : drawing.bodies) slice::move(body, {0, 0, lift_um});
    return {};
}

Status set_heights(const SliceOptions& options, const Drawing& drawing, slice::Settings& slicing) {
    if (options.least_layer.empty()) return {};
    double least_um = 0;
    if (Status status = read_lengths({{"--least-layer", &options.least_layer, &least_um}}); !status) return status;
    if (std::fabs(least_um - std::round(least_um)) > 1e-6)
        return input_error("--least-layer {}: a whole number of micrometres is needed", options.least_layer);
    auto tops = slice::adaptive_tops(drawing.bodies, {static_cast<int>(std::lround(least_um)), slicing.layer_um});
    if (!tops) return input_error("--least-layer: {}", tops.error().message);
    slicing.tops_um = std::move(*tops);
    return {};
}

Status hollow_part(const SliceOptions& options, job::JobSettings& settings, Drawing& drawing,
                   std::vector<std::string>& notes, Progress& progress) {
    if (options.hollow.empty()) {
        if (!options.drain.empty()) return input_error("--drain: needs --hollow");
        return {};
    }
    slice::HollowSettings hollow;
    Status status =
        read_lengths({{"--hollow", &options.hollow, &hollow.wall_um}, {"--drain", &options.drain, &hollow.drain_um}});
    if (!status) return status;
    auto made = slice::hollow_out(drawing.bodies, settings.slicing, hollow, progress);
    if (!made) return tl::unexpected(made.error());
    settings.slicing.removed = made->removed;
    drawing.warnings.insert(drawing.warnings.end(), made->warnings.begin(), made->warnings.end());
    notes.push_back(
        fmt::format("hollow: {} cavities of {:.1f} mm^3, {} drains", made->cavities, made->volume_mm3, made->drains));
    return {};
}

}  // namespace

Status arrange(const SliceOptions& options, job::JobSettings& settings, Drawing& drawing,
               std::vector<std::string>& notes, Progress& progress) {
    if (!drawing.stacks.empty()) return {};
    const bool supported = !options.support.empty();
    for (const auto& [option, text] : {std::pair{"--raft", &options.raft}, std::pair{"--lift", &options.lift}}) {
        if (!supported && !text->empty()) return input_error("{}: needs --support MATERIAL", option);
    }
    if (Status status = place(options, settings.slicing.raster, drawing); !status) return status;
    slice::SupportSettings wanted;
    if (supported) {
        Result<slice::SupportSettings> read = support_settings(options);
        if (!read) return tl::unexpected(read.error());
        wanted = std::move(*read);
        if (Status status = lift(options, wanted.raft_um, drawing); !status) return status;
    }
    if (Status status = set_heights(options, drawing, settings.slicing); !status) return status;
    if (Status status = hollow_part(options, settings, drawing, notes, progress); !status) return status;
    if (!supported) return {};
    auto supports = slice::make_supports(drawing.bodies, settings.slicing, wanted, progress);
    if (!supports) return tl::unexpected(supports.error());
    notes.push_back(fmt::format("supports: {} tips, {} of them on the part itself, {:.1f} mm^3", supports->tips,
                                supports->on_part, supports->volume_mm3));
    if (supports->islands_left > 0)
        drawing.warnings.push_back(
            fmt::format("{} islands are left that supports do not reach", supports->islands_left));
    drawing.bodies.insert(drawing.bodies.begin(), std::make_move_iterator(supports->bodies.begin()),
                          std::make_move_iterator(supports->bodies.end()));
    return {};
}

}  // namespace pliant::app

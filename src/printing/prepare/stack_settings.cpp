#include "printing/prepare/stack_settings.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "printing/prepare/option_text.hpp"

namespace pliant::prepare {
namespace {

std::string um_text(double um) {
    return fmt::format("{:g} um", um);
}

/// The layer height stated by the stacks, if any; all must agree.
Result<std::optional<double>> stacked_layer_um(const Drawing& drawing) {
    constexpr double same_um = 1e-3;
    const job::MaterialStack* first = nullptr;
    for (const job::MaterialStack& s : drawing.stacks) {
        if (!s.stack.layer_um()) continue;
        if (first == nullptr) first = &s;
        if (std::fabs(*s.stack.layer_um() - *first->stack.layer_um()) > same_um)
            return input_error(
                "images of \"{}\" are for layers of {}, those of \"{}\" for {}: slice them in the same layer height",
                first->material, um_text(*first->stack.layer_um()), s.material, um_text(*s.stack.layer_um()));
    }
    if (first == nullptr) return std::nullopt;
    return first->stack.layer_um();
}

}  // namespace

Status check_stacks(const Order& order, const Drawing& drawing) {
    if (drawing.stacks.empty()) return {};
    const std::pair<const char*, bool> given[] = {{"--copies", order.copies != 1},
                                                  {"--turn", !order.turn.empty()},
                                                  {"--scale", order.scale != 1},
                                                  {"--at", !order.at.empty()},
                                                  {"--least-layer", !order.least_layer.empty()},
                                                  {"--spacing", order.spacing != Order{}.spacing},
                                                  {"--support", !order.support.empty()},
                                                  {"--support-angle", !order.support_angle.empty()},
                                                  {"--support-spacing", !order.support_spacing.empty()},
                                                  {"--support-tip", !order.support_tip.empty()},
                                                  {"--support-pillar", !order.support_pillar.empty()},
                                                  {"--support-paint", !order.support_paint.empty()},
                                                  {"--lift", !order.lift.empty()},
                                                  {"--raft", !order.raft.empty()},
                                                  {"--hollow", !order.hollow.empty()},
                                                  {"--drain", !order.drain.empty()},
                                                  {"--no-anti-alias", order.no_anti_alias},
                                                  {"--threshold", order.threshold != Order{}.threshold}};
    for (const auto& [option, is_given] : given) {
        if (is_given) return input_error("{}: layer images are printed as they are", option);
    }
    return {};
}

Status check_pixels(const Drawing& drawing, const machine::Projector& projector) {
    constexpr double rounding = 0.005;  // of displays stated in tenths of a millimetre
    for (const job::MaterialStack& s : drawing.stacks) {
        const std::optional<job::PixelSize> pixel = s.stack.pixel();
        if (!pixel) continue;
        for (const auto& [um, way] : {std::pair{pixel->x_um, "wide"}, {pixel->y_um, "deep"}}) {
            if (std::fabs(projector.pixel_um / um - 1) <= rounding) continue;
            return input_error(
                "images of \"{}\" are for pixels of {:.4g} x {:.4g} um, the projector has {:.4g} um: the part would "
                "come out {:.3g} times as {}; slice it for this printer",
                s.material, pixel->x_um, pixel->y_um, projector.pixel_um, projector.pixel_um / um, way);
        }
    }
    return {};
}

Result<int> layer_of(const Order& order, const machine::Printer& printer, Drawing& drawing) {
    const Result<std::optional<double>> stacked = stacked_layer_um(drawing);
    if (!stacked) return tl::unexpected(stacked.error());
    const Result<int> asked = order.layer.empty() ? printer.layer_um : layer_height_um("--layer", order.layer);
    if (!asked) return asked;
    if (!*stacked) {
        if (!drawing.stacks.empty() && order.layer.empty())
            drawing.warnings.push_back(
                fmt::format("layer images do not say how high their layers are: {} "
                            "of the printer file are assumed; --layer gives another height",
                            um_text(*asked)));
        return asked;
    }
    const double um = std::round(**stacked);
    if (std::fabs(um - **stacked) > 1e-3 || um > 1000)
        return input_error("layer images are for layers of {}: a whole number of micrometres from 1 to 1000 is needed",
                           um_text(**stacked));
    if (!order.layer.empty() && *asked != static_cast<int>(um))
        return input_error(
            "--layer {}: the layer images are for layers of {}, the part would come out {:.3g} times as high: leave "
            "--layer out, or slice again",
            order.layer, um_text(um), *asked / um);
    return static_cast<int>(um);
}

Result<std::vector<int>> stacked_tops_um(const Drawing& drawing, int layer_um) {
    std::optional<int> first_um;
    for (const job::MaterialStack& s : drawing.stacks) {
        const double stated_um = s.stack.first_layer_um().value_or(layer_um), um = std::round(stated_um);
        if (std::fabs(um - stated_um) > 1e-3 || um < 1 || um > 1000)
            return input_error(
                "the first layer of \"{}\" is {} high: a whole number of micrometres from 1 to 1000 is needed",
                s.material, um_text(stated_um));
        if (first_um && *first_um != static_cast<int>(um))
            return input_error("the first layer of \"{}\" is {} high, that of another stack {}: slice them alike",
                               s.material, um_text(um), um_text(*first_um));
        first_um = static_cast<int>(um);
    }
    if (first_um.value_or(layer_um) == layer_um) return std::vector<int>{};
    return std::vector<int>{*first_um, *first_um + layer_um};
}

}  // namespace pliant::prepare

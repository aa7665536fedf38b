#include "spray_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "interrupt.hpp"
#include "presentation/print_report/wash_picture.hpp"
#include "printing/twin/runs.hpp"
#include "printing/twin/wet_part.hpp"
#include "printing/wash/run_off.hpp"

namespace pliant::app {
namespace {

/// The finished part, with all materials as one.
Result<wash::PartCells> part_of(const job::Archive& archive, const machine::Projector& projector) {
    const job::Manifest& m = archive.manifest();
    const int part_um = m.layers.empty() ? 0 : m.layers.back().z_um;
    twin::CoarsePart part(m.width_px, m.height_px, m.pixel_um, std::max(1, part_um));
    for (const job::Layer& layer : m.layers) {
        for (const job::LayerImage& listed : layer.images) {
            const Result<job::Image> image = archive.image(listed.file);
            if (!image) return tl::unexpected(image.error());
            part.add(layer.z_um - layer.thickness_um, layer.z_um, 0, twin::runs_of(*image));
        }
    }
    return twin::wet_part(part, projector);
}

Status use_best(const wash::PartCells& part, double wanted, machine::Printer& printer, SprayResult& result) {
    const Result<wash::BestSpray> best = wash::best_spray(part, printer, wanted);
    if (!best) return tl::unexpected(best.error());
    result.before_ml = printer.cleaning.solvent_ml_s * printer.cleaning.spray_s;
    result.now_ml = best->solution_ml;
    printer.cleaning.stroke_x_um = best->strokes.x_um;
    printer.cleaning.stroke_z_um = best->strokes.z_um;
    printer.cleaning.spray_s = best->seconds;
    return {};
}

}  // namespace

Result<std::optional<SprayResult>> look_at_spray(const SprayOrder& order, const job::Archive& archive,
                                                 machine::Printer& printer) {
    if (!order.wanted && !order.cleanness && order.picture_file.empty()) return std::nullopt;
    if (printer.sprinklers.empty())
        return input_error("{} does not say where its sprinklers are: it has no [[sprinkler]] tables", printer.name);
    const Result<wash::PartCells> part = part_of(archive, printer.projector);
    if (!part) return tl::unexpected(part.error());
    const std::vector<wash::Face> faces = wash::wet_faces(*part);
    if (faces.empty())
        return input_error("{}: nothing is printed, so there is nothing to clean", archive.manifest().name);
    SprayResult result;
    if (order.cleanness) {
        if (Status status = use_best(*part, *order.cleanness, printer, result); !status)
            return tl::unexpected(status.error());
    }
    result.strokes = wash::strokes_of(printer);
    result.seconds = printer.cleaning.spray_s;
    const wash::Cleanness c =
        wash::cleanness(faces, wash::washed_rates(*part, faces, printer, result.strokes), result.seconds);
    result.removed = c.removed;
    result.unseen = c.unseen;
    if (!order.picture_file.empty()) {
        const Result<std::string> png = report::wash_picture(archive.manifest().name, *part, faces, c);
        if (!png) return tl::unexpected(png.error());
        if (Status status = write_file_and_leave(order.picture_file, *png); !status)
            return tl::unexpected(status.error());
    }
    return result;
}

std::string with_spray(const std::string& plan_json, const std::optional<SprayResult>& spray) {
    if (!spray) return plan_json;
    const auto rounded = [](double value) { return std::round(value * 1e6) / 1e6; };
    auto json = parse_ordered_json(plan_json);
    json["spray"] = {{"removed", rounded(spray->removed)},
                     {"unseen", rounded(spray->unseen)},
                     {"seconds", rounded(spray->seconds)},
                     {"stroke_x_um", spray->strokes.x_um},
                     {"stroke_z_um", spray->strokes.z_um}};
    if (spray->now_ml) {
        json["spray"]["solution_ml"] = rounded(*spray->now_ml);
        json["spray"]["solution_ml_before"] = rounded(*spray->before_ml);
    }
    return json_text(json, 1) + "\n";
}

std::string spray_text(const std::optional<SprayResult>& spray) {
    if (!spray) return "";
    std::string text =
        fmt::format("  {:<10}{:>8.1f} %   of the film is removed; no spray reaches {:.1f} % of the surface\n", "spray",
                    100 * spray->removed, 100 * spray->unseen);
    if (!spray->now_ml) return text;
    text += fmt::format("  {:<10}{:>7.1f} ml   of solution for one cleaning, {:.1f} ml before; in the printer file:\n",
                        "", *spray->now_ml, *spray->before_ml);
    const std::string x =
        spray->strokes.x_um > 0 ? fmt::format("stroke_x = \"{:g} mm\", ", spray->strokes.x_um / 1000.0) : "";
    return text + fmt::format("  {:<10}             {}stroke_z = \"{:g} mm\", spray = \"{:g} s\"\n", "", x,
                              spray->strokes.z_um / 1000.0, spray->seconds);
}

}  // namespace pliant::app

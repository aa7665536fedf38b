#include "printing/plan/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/core/counted.hpp"
#include "printing/job/exposure.hpp"
#include "printing/machine/working_curve.hpp"
#include "printing/plan/assign.hpp"
#include "printing/plan/departures.hpp"
#include "printing/plan/least_cost.hpp"
#include "printing/plan/print_sequence.hpp"
#include "printing/plan/solution_use.hpp"
#include "printing/plan/swap.hpp"

namespace pliant::plan {
namespace {

using machine::Printer;

Status check_projector(const job::Manifest& job, const machine::Projector& projector) {
    const bool same = job.width_px == projector.width_px && job.height_px == projector.height_px &&
                      std::abs(job.pixel_um - projector.pixel_um) <= 1e-6 * projector.pixel_um;
    if (same) return {};
    return input_error(
        "{} was sliced for {} x {} pixels of {:.6g} um, the projector has {} x {} of {:.6g} um; slice it again",
        job.name, job.width_px, job.height_px, job.pixel_um, projector.width_px, projector.height_px,
        projector.pixel_um);
}

Status check_materials(const job::Manifest& job) {
    for (const job::Material& m : job.materials) {
        const bool good = m.exposure_s > 0 && m.exposure_s <= job::longest_exposure_s &&
                          m.bottom_exposure_s <= job::longest_exposure_s &&
                          (m.bottom_exposure_s > 0 || job::bottom_layers(job, m) == 0);
        if (!good)
            return input_error("{}: material \"{}\" needs exposures above 0 s, up to {} s", job.name, m.name,
                               job::longest_exposure_s);
    }
    return {};
}

Status check_image(const job::Manifest& job, std::size_t layer, const job::LayerImage& image) {
    if (image.material < 0 || image.material >= static_cast<int>(job.materials.size())) {
        return input_error("{}: layer {} prints material {}, there are {}", job.name, layer + 1, image.material,
                           job.materials.size());
    }
    const bool printable = std::all_of(image.file.begin(), image.file.end(), [](char c) { return c >= ' '; });
    if (image.file.empty() || !printable || image.file.front() == ' ' || image.file.back() == ' ') {
        return input_error("{}: layer {} has an image without a usable name", job.name, layer + 1);
    }
    if (!(image.area_mm2 >= 0) || !std::isfinite(image.area_mm2)) {
        return input_error("{}: layer {} has an image with an impossible area", job.name, layer + 1);
    }
    return {};
}

Status check_layers(const job::Manifest& job, const Printer& printer) {
    int below_um = 0;
    for (std::size_t i = 0; i < job.layers.size(); ++i) {
        const job::Layer& layer = job.layers[i];
        if (layer.z_um <= below_um || layer.thickness_um <= 0) {
            return input_error("{}: layer {} at {} um does not lie above {} um", job.name, i + 1, layer.z_um, below_um);
        }
        below_um = layer.z_um;
        for (const job::LayerImage& image : layer.images) {
            if (Status status = check_image(job, i, image); !status) return status;
        }
    }
    return check_height(job.name, below_um, printer.name, printer.platform.build_height_um);
}

Status check_job(const job::Manifest& job, const Printer& printer) {
    if (Status status = check_projector(job, printer.projector); !status) return status;
    if (Status status = check_materials(job); !status) return status;
    return check_layers(job, printer);
}

/// The distinct vats of each layer, in the order of its materials.
std::vector<VatList> vats_by_layer(const std::vector<std::vector<int>>& vat_of_image) {
    std::vector<VatList> layers;
    for (const std::vector<int>& images : vat_of_image) {
        VatList vats;
        for (const int vat : images) {
            if (std::find(vats.begin(), vats.end(), vat) == vats.end()) vats.push_back(vat);
        }
        layers.push_back(std::move(vats));
    }
    return layers;
}

/// Duration of every change between vats that the job uses.
ChangeCosts change_times(const Plan& plan, const Printer& printer) {
    ChangeCosts costs(static_cast<int>(printer.vats.size()));
    for (const VatUse& from : plan.vats) {
        Sequence s = standing_at(printer, from.slot);
        store_vat(s, from.slot);
        costs.store[static_cast<std::size_t>(from.vat)] = s.seconds().total;
        costs.load[static_cast<std::size_t>(from.vat)] = load_seconds(printer, from.slot).total;
        for (const VatUse& to : plan.vats) {
            if (to.vat == from.vat) continue;
            costs.swap[costs.at(from.vat, to.vat)] = swap_seconds(printer, from.slot, to.slot).total;
        }
    }
    return costs;
}

/// With the penalties of the pairs.
ChangeCosts with_penalties(ChangeCosts costs, const Plan& plan, const Printer& printer) {
    for (const VatUse& from : plan.vats) {
        for (const VatUse& to : plan.vats) {
            if (to.vat != from.vat) costs.swap[costs.at(from.vat, to.vat)] += printer.penalty_s(from.vat, to.vat);
        }
    }
    return costs;
}

/// The printer with the resins that the plan fills in: cleaning depends on pairs of them.
Printer with_resins(const Plan& plan, Printer printer) {
    for (const VatUse& use : plan.vats) {
        machine::Vat& vat = printer.vats[static_cast<std::size_t>(use.vat)];
        vat.fill_ml = printer.filled_ml(vat);
        vat.resin = use.resin;
    }
    return printer;
}

void choose_order(Plan& plan, const std::vector<VatList>& layers, const Printer& printer, OrderRule rule) {
    const ChangeCosts times = change_times(plan, printer), costs = with_penalties(times, plan, printer);
    const LeastCost least = least_cost_order(layers, costs);
    if (!least.exact)
        plan.warnings.emplace_back(
            "layers of more than 12 vats: their order is close to the optimum, not proved to be it");
    for (const OrderRule each : {OrderRule::naive, OrderRule::thesis, OrderRule::least_cost}) {
        std::vector<VatList> order = each == OrderRule::least_cost ? least.order : order_vats(layers, each);
        const double change_s = change_cost(order, times);
        plan.compared.push_back({each, count_swaps(order), change_s, change_cost(order, costs) - change_s});
        if (each == rule) plan.order = std::move(order);
    }
    if (rule == OrderRule::fewest_swaps) plan.order = order_vats(layers, rule);
    plan.rule = rule;
    plan.least_change_s = least.cost;
    plan.swaps = count_swaps(plan.order);
    plan.swap_lower_bound = fewest_swaps(layers);
}

/// The vats of every image, and their order.
Plan ordered(Assignment assignment, const job::Manifest& job, const Printer& printer, OrderRule rule) {
    Plan plan;
    plan.job = job.name;
    plan.printer = printer.name;
    plan.layers = static_cast<int>(job.layers.size());
    plan.vats = std::move(assignment.vats);
    plan.vat_of_material = std::move(assignment.vat_of_material);
    plan.refills = std::move(assignment.refills);
    plan.warnings = std::move(assignment.warnings);
    plan.vat_of_image = std::move(assignment.vat_of_image);
    choose_order(plan, vats_by_layer(plan.vat_of_image), with_resins(plan, printer), rule);
    return plan;
}

/// Whether `more` allows for at least what is carried off by `ml`.
bool covers(const CarriedOff& more, const CarriedOff& ml) {
    constexpr double rounding = 1 + 1e-9;
    for (std::size_t i = 0; i < ml.size(); ++i) {
        for (std::size_t v = 0; v < ml[i].size(); ++v) {
            if (ml[i][v] > rounding * (more.empty() ? 0 : more[i][v])) return false;
        }
    }
    return true;
}

/// For each layer and vat, the larger of both.
CarriedOff larger(CarriedOff a, const CarriedOff& b) {
    if (a.empty()) return b;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t v = 0; v < a[i].size(); ++v) a[i][v] = std::max(a[i][v], b[i][v]);
    }
    return a;
}

/// The area that an image cures from its vat. A pixel that two images expose is cured in the vat that comes first. The
/// manifest does not say with which image one shares its pixels: among more than two they count for the other one.
double newly_cured_mm2(const Plan& plan, const job::Manifest& job, std::size_t layer, std::size_t k) {
    const std::vector<job::LayerImage>& images = job.layers[layer].images;
    const job::LayerImage& image = images[k];
    double elsewhere_mm2 = image.shared_mm2;
    if (images.size() == 2) {
        const std::vector<int>& vats = plan.vat_of_image[layer];
        const int other = vats[1 - k];
        const bool first = vats[k] == other ? k == 0 : plan.order[layer].front() == vats[k];
        elsewhere_mm2 = first ? 0 : image.shared_mm2 + images[1 - k].shared_mm2;
    }
    return std::max(0.0, image.area_mm2 - elsewhere_mm2);
}

/// What a layer prints from a vat.
double taken_ml(const Plan& plan, const job::Manifest& job, std::size_t layer, int vat) {
    double ml = 0;
    for (std::size_t k = 0; k < job.layers[layer].images.size(); ++k) {
        if (plan.vat_of_image[layer][k] == vat)
            ml += newly_cured_mm2(plan, job, layer, k) * job.layers[layer].thickness_um / 1e6;
    }
    return ml;
}

/// Of every vat, and what it needs up to its first refill. `carried`: what the part carries off in this plan.
void reckon_needs(Plan& plan, const job::Manifest& job, const Printer& printer, const CarriedOff& carried) {
    for (VatUse& use : plan.vats) {
        const std::vector<int> refills = plan.refills_of(use.slot);
        const std::size_t end = refills.empty() ? job.layers.size() : static_cast<std::size_t>(refills.front());
        use.needed_ml = printer.vat_shape.least_ml;
        use.resin_ml = 0;
        for (std::size_t i = 0; i < job.layers.size(); ++i) {
            const double printed_ml = taken_ml(plan, job, i, use.vat);
            use.resin_ml += printed_ml;
            if (i < end) use.needed_ml += printed_ml + carried[i][static_cast<std::size_t>(use.vat)];
        }
    }
}

/// No refill helps where a layer needs more than a vat as full as the printer file says gives.
Status check_fills(const Plan& plan, const job::Manifest& job, const Printer& printer) {
    for (std::size_t i = 0; i < job.layers.size(); ++i) {
        for (const VatUse& use : plan.vats) {
            const double fill_ml = printer.filled_ml(printer.vats[static_cast<std::size_t>(use.vat)]);
            const double gives_ml = std::max(0.0, fill_ml - printer.vat_shape.least_ml);
            const double needs_ml = taken_ml(plan, job, i, use.vat);
            if (needs_ml <= gives_ml + 1e-6 * (1 + gives_ml)) continue;
            return input_error(
                "{}: layer {} needs {} of \"{}\", the vat of slot {} gives {}: of its fill of {:g} ml, {:g} ml must "
                "stay in it",
                job.name, i + 1, ml_text(needs_ml), use.resin, use.slot, ml_text(gives_ml), fill_ml,
                printer.vat_shape.least_ml);
        }
    }
    return {};
}

/// The resin that the part carries off decides how long a vat lasts, and so which vats a layer uses; their order
/// decides what is carried off. Repeated until what was allowed for covers what is carried off. If the rounds go in a
/// circle, allows for the most of them.
Result<Plan> assign_and_order(const job::Manifest& job, const Printer& printer, OrderRule rule) {
    constexpr int rounds = 6, growing_rounds = 12;
    CarriedOff allowed;
    for (int round = 1;; ++round) {
        auto assignment = assign_vats(job, printer, allowed);
        if (!assignment) return tl::unexpected(assignment.error());
        Plan plan = ordered(std::move(*assignment), job, printer, rule);
        CarriedOff carried =
            carried_off(departures(plan.order, plan.vat_of_image, job, printer), job.layers.size(), printer);
        if (covers(allowed, carried)) {
            if (Status status = check_fills(plan, job, printer); !status) return tl::unexpected(status.error());
            reckon_needs(plan, job, printer, carried);
            return plan;
        }
        if (round < rounds)
            allowed = std::move(carried);
        else if (round < growing_rounds)
            allowed = larger(std::move(allowed), carried);
        else
            allowed = most_carried_off(job, printer);
    }
}

/// How deep the k-th image of a layer cures: by the resin's working curve, so that longer exposures count.
double depth_of_image_um(const job::Manifest& job, std::size_t layer, std::size_t k, const Printer& printer,
                         const machine::Resin& resin) {
    constexpr double rounding_um = 1e-6;
    return machine::cure_depth_um(printer, resin, job::exposure_s(job, layer, k)) + rounding_um;
}

/// A blank layer below a printed one leaves a gap that curing must bridge.
void warn_of_gaps(const job::Manifest& job, const Printer& printer, Plan& plan) {
    int below_um = 0;
    int gaps = 0;
    for (std::size_t i = 0; i < job.layers.size(); ++i) {
        const job::Layer& layer = job.layers[i];
        if (layer.images.empty()) continue;
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            const auto material = static_cast<std::size_t>(layer.images[k].material);
            const auto* resin = printer.find_resin(job.materials[material].resin);
            if (resin == nullptr || layer.z_um - below_um <= depth_of_image_um(job, i, k, printer, *resin)) continue;
            ++gaps;
            break;
        }
        below_um = layer.z_um;
    }
    if (gaps == 0) return;
    plan.warnings.push_back(fmt::format(
        "{} to be cured deeper than the cure depth of the resin: nothing will hold there",
        gaps == 1 ? "1 layer would have" : counted(static_cast<std::size_t>(gaps), "layer") + " would have"));
}

/// Two statements of a printer file about one thing.
void warn_of_curves(const job::Manifest& job, const Printer& printer, Plan& plan) {
    constexpr double far = 2;
    std::set<std::string> seen;
    for (const job::Material& material : job.materials) {
        const auto* resin = printer.find_resin(material.resin);
        if (resin == nullptr || !(resin->penetration_um > 0) || !seen.insert(resin->name).second) continue;
        const double depth = machine::cure_depth_um(printer, *resin, resin->exposure_s);
        if (depth * far >= resin->cure_depth_um && depth <= far * resin->cure_depth_um) continue;
        plan.warnings.push_back(
            fmt::format("resin \"{}\": the printer file gives a cure_depth of {} um, but by the working curve its "
                        "exposure of {:.4g} s cures {:.0f} um",
                        resin->name, resin->cure_depth_um, resin->exposure_s, depth));
    }
}

}  // namespace

Status check_height(const std::string& job, int top_um, const std::string& printer, int build_height_um) {
    if (top_um <= build_height_um) return {};
    return input_error("{} is {:.2f} mm tall, {} builds {:.2f} mm", job, top_um / 1000.0, printer,
                       build_height_um / 1000.0);
}

std::vector<int> Plan::refills_of(int slot) const {
    std::vector<int> found;
    for (const RefillBefore& refill : refills) {
        if (refill.slot == slot) found.push_back(refill.layer);
    }
    return found;
}

Result<Plan> make_plan(const job::Manifest& job, const Printer& printer, OrderRule rule) {
    if (Status status = check_job(job, printer); !status) return tl::unexpected(status.error());
    auto assigned = assign_and_order(job, printer, rule);
    if (!assigned) return assigned;
    Plan plan = std::move(*assigned);
    warn_of_gaps(job, printer, plan);
    warn_of_curves(job, printer, plan);
    PrintTimes times = print_times(plan, job, with_resins(plan, printer));
    plan.seconds = times.all;
    plan.layer_seconds = std::move(times.layers);
    reckon_solution(plan, job, with_resins(plan, printer));
    return plan;
}

std::string write_gcode(const Plan& plan, const job::Manifest& job, const Printer& printer) {
    const Printer filled = with_resins(plan, printer);
    return print_sequence(plan, job, filled).text();
}

Seconds program_seconds(const Plan& plan, const job::Manifest& job, const Printer& printer) {
    const Printer filled = with_resins(plan, printer);
    return print_sequence(plan, job, filled).seconds();
}

machine::Printer filled_printer(const Plan& plan, const job::Manifest& job, Printer printer) {
    printer = with_resins(plan, std::move(printer));
    for (const VatUse& use : plan.vats) {
        if (printer.find_resin(use.resin) != nullptr) continue;
        const job::Material& m = job.materials[static_cast<std::size_t>(use.materials.front())];
        const int cure_depth_um = 2 * printer.layer_um;
        const double critical_J_m2 = machine::irradiance_W_m2(printer) * m.exposure_s * std::exp(-2);
        printer.resins.push_back({use.resin, m.exposure_s, m.bottom_exposure_s, job::bottom_layers(job, m),
                                  cure_depth_um, 0.8, machine::assumed_penetration_um(printer), critical_J_m2});
    }
    return printer;
}

}  // namespace pliant::plan

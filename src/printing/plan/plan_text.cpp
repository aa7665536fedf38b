#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/counted.hpp"
#include "base/core/json.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::plan {
namespace {

using Json = nlohmann::ordered_json;

/// Three decimals are enough for seconds and millilitres, and keep the text identical everywhere.
double rounded(double value) {
    return std::round(value * 1000) / 1000;
}

int planned_slot(const Plan& plan, int vat) {
    for (const VatUse& use : plan.vats) {
        if (use.vat == vat) return use.slot;
    }
    return 0;
}

Json seconds_json(const Seconds& s) {
    return {{"total", rounded(s.total)},
            {"swap", rounded(s.swap)},
            {"clean", rounded(s.clean)},
            {"expose", rounded(s.expose)},
            {"move", rounded(s.move)}};
}

Json order_json(const Plan& plan) {
    Json order = Json::array();
    for (const VatList& layer : plan.order) {
        Json slots = Json::array();
        for (const int vat : layer) slots.push_back(planned_slot(plan, vat));
        order.push_back(std::move(slots));
    }
    return order;
}

Json orders_json(const Plan& plan) {
    Json orders = Json::object();
    for (const OrderCost& c : plan.compared) {
        orders[std::string(rule_name(c.rule))] = {
            {"swaps", c.swaps}, {"change_s", rounded(c.change_s)}, {"penalty_s", rounded(c.penalty_s)}};
    }
    return orders;
}

Json layers_json(const Plan& plan) {
    Json total = Json::array(), swap = Json::array(), clean = Json::array(), expose = Json::array(),
         move = Json::array();
    for (const Seconds& s : plan.layer_seconds) {
        total.push_back(rounded(s.total));
        swap.push_back(rounded(s.swap));
        clean.push_back(rounded(s.clean));
        expose.push_back(rounded(s.expose));
        move.push_back(rounded(s.move));
    }
    return {{"total", std::move(total)},
            {"swap", std::move(swap)},
            {"clean", std::move(clean)},
            {"expose", std::move(expose)},
            {"move", std::move(move)}};
}

Json refills_json(const Plan& plan, int slot) {
    Json refills = Json::array();
    for (const int layer : plan.refills_of(slot)) refills.push_back({{"layer", layer}});
    return refills;
}

Json vat_json(const Plan& plan, const VatUse& use) {
    return {{"slot", use.slot},
            {"resin", use.resin},
            {"materials", use.materials},
            {"needed_ml", rounded(use.needed_ml)},
            {"refill", use.refill},
            {"refills", refills_json(plan, use.slot)},
            {"first_layer", use.first_layer},
            {"last_layer", use.last_layer},
            {"waste_ml", rounded(use.waste_ml)},
            {"brushed_ml", rounded(use.brushed_ml)}};
}

Json solution_json(const SolutionUse& s) {
    Json care = Json::array();
    for (const CareBefore& c : s.care)
        care.push_back({{"layer", c.layer}, {"text", std::string(machine::care_text(c.care))}});
    return {{"goes_round", s.goes_round},
            {"pumped_ml", rounded(s.pumped_ml)},
            {"used_ml", rounded(s.used_ml)},
            {"liquid_ml", rounded(s.liquid_ml)},
            {"resin_share", std::round(s.resin_share * 1e6) / 1e6},
            {"filter_ml", rounded(s.filter_ml)},
            {"care", std::move(care)}};
}

/// The consumption of solution, and when it must be serviced.
std::string solution_text(const SolutionUse& s) {
    if (s.pumped_ml <= 0) return "";
    if (!s.goes_round) return fmt::format("  {:<10}{:>7.0f} ml\n", "solution", s.used_ml);
    std::string text = fmt::format(
        "  {:<10}{:>7.0f} ml   used up, of {:.0f} ml pumped; at the "
        "end {:.0f} ml with {:.2f} % of resin (spent at {:g} %)\n",
        "solution", s.used_ml, s.pumped_ml, s.liquid_ml, 100 * s.resin_share, 100 * s.spent_share);
    constexpr std::size_t most = 5;
    for (std::size_t i = 0; i < std::min(most, s.care.size()); ++i)
        text += fmt::format("  {:<10}{:>10}   {}\n", "before", fmt::format("layer {}", s.care[i].layer + 1),
                            machine::care_text(s.care[i].care));
    if (s.care.size() > most) text += fmt::format("  and {} more\n", counted(s.care.size() - most, "time"));
    return text;
}

std::string orders_text(const Plan& plan) {
    std::string text;
    for (const OrderCost& c : plan.compared) {
        const bool chosen = c.rule == plan.rule;
        const std::string penalty = c.penalty_s >= 0.5 ? ", penalties of " + clock_text(c.penalty_s) : "";
        text +=
            fmt::format("  {:<14}{:>6} {:<5}{:>12} of changing vats{}{}\n", rule_name(c.rule), c.swaps,
                        c.swaps == 1 ? "swap" : "swaps", clock_text(c.change_s), penalty, chosen ? "   (planned)" : "");
    }
    return text;
}

/// ", 2.4 ml brushed back and 3.6 ml wasted"
std::string waste_text(const VatUse& use) {
    if (use.brushed_ml <= 0)
        return use.waste_ml > 0 ? fmt::format(", and {} wasted", ml_text(use.waste_ml)) : std::string();
    return fmt::format(", {} brushed back and {} wasted", ml_text(use.brushed_ml), ml_text(use.waste_ml));
}

}  // namespace

std::string plan_json(const Plan& plan) {
    Json resin = Json::object();
    Json vats = Json::array();
    for (const VatUse& use : plan.vats) {
        resin[std::to_string(use.slot)] = rounded(use.resin_ml);
        vats.push_back(vat_json(plan, use));
    }
    const Json json = {{"job", plan.job},
                       {"printer", plan.printer},
                       {"layers", plan.layers},
                       {"swaps", plan.swaps},
                       {"swap_lower_bound", plan.swap_lower_bound},
                       {"order_rule", std::string(rule_name(plan.rule))},
                       {"orders", orders_json(plan)},
                       {"seconds", seconds_json(plan.seconds)},
                       {"layer_seconds", layers_json(plan)},
                       {"resin_ml", std::move(resin)},
                       {"waste_ml", rounded(plan.waste_ml)},
                       {"brushed_ml", rounded(plan.brushed_ml)},
                       {"solvent_ml", rounded(plan.solvent_ml)},
                       {"solution", solution_json(plan.solution)},
                       {"vats", std::move(vats)},
                       {"order", order_json(plan)},
                       {"warnings", plan.warnings}};
    return json_text(json, 1) + "\n";
}

std::vector<std::string> vat_lines(const Plan& plan) {
    std::vector<std::string> lines;
    for (const VatUse& use : plan.vats) {
        const std::string waste = use.waste_ml > 0 ? fmt::format(", {} wasted", ml_text(use.waste_ml)) : "";
        std::string line = fmt::format("slot {}: {}, {} ({} printed{})", use.slot, use.resin, needed_text(use),
                                       ml_text(use.resin_ml), waste);
        if (use.refill) line += ", to be filled in: the printer file has another resin there, or none";
        const std::size_t refills = plan.refills_of(use.slot).size();
        if (refills > 0) line += fmt::format(", refilled {} during the print", counted(refills, "time"));
        lines.push_back(std::move(line));
    }
    return lines;
}

std::string needed_text(const VatUse& use) {
    constexpr double noise = 1e-9;
    return fmt::format("at least {:.0f} ml", std::ceil(use.needed_ml - noise));
}

std::string ml_text(double ml) {
    std::string text = fmt::format("{:.1f} ml", ml);
    return ml > 0 && text == "0.0 ml" ? "under 0.1 ml" : text;
}

std::string clock_text(double seconds) {
    const auto whole = static_cast<long long>(std::llround(seconds));
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string plan_text(const Plan& plan) {
    std::string text = fmt::format("{} on {}\n", plan.job, plan.printer);
    text += fmt::format("  {:<10}{:>10}\n", "layers", plan.layers);
    text += fmt::format("  {:<10}{:>10}   minimum {}\n", "swaps", plan.swaps, plan.swap_lower_bound);
    text += orders_text(plan);
    const Seconds& s = plan.seconds;
    for (const auto& [name, value] :
         {std::pair{"time", s.total}, std::pair{" swap", s.swap}, std::pair{" clean", s.clean},
          std::pair{" expose", s.expose}, std::pair{" move", s.move}}) {
        text += fmt::format("  {:<10}{:>10}\n", name, clock_text(value));
    }
    for (const VatUse& use : plan.vats) {
        text += fmt::format("  {:<8}{:>12}   {}{}\n", fmt::format("slot {}", use.slot), ml_text(use.resin_ml),
                            use.resin, waste_text(use));
    }
    text += solution_text(plan.solution);
    for (const std::string& warning : plan.warnings) text += fmt::format("  warning: {}\n", warning);
    return text;
}

}  // namespace pliant::plan

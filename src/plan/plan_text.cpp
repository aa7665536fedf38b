#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "plan/plan.hpp"

namespace pliant::plan {
namespace {

using Json = nlohmann::ordered_json;

/// Thousandths are enough for seconds and millilitres, and keep the text the same everywhere.
double rounded(double value) {
    return std::round(value * 1000) / 1000;
}

int slot_of(const Plan& plan, int vat) {
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
        for (const int vat : layer) slots.push_back(slot_of(plan, vat));
        order.push_back(std::move(slots));
    }
    return order;
}

}  // namespace

std::string plan_json(const Plan& plan) {
    Json resin = Json::object();
    Json vats = Json::array();
    for (const VatUse& use : plan.vats) {
        resin[std::to_string(use.slot)] = rounded(use.resin_ml);
        vats.push_back(
            {{"slot", use.slot}, {"resin", use.resin}, {"materials", use.materials}, {"refill", use.refill}});
    }
    const Json json = {{"job", plan.job},
                       {"printer", plan.printer},
                       {"layers", plan.layers},
                       {"swaps", plan.swaps},
                       {"swap_lower_bound", plan.swap_lower_bound},
                       {"seconds", seconds_json(plan.seconds)},
                       {"resin_ml", std::move(resin)},
                       {"vats", std::move(vats)},
                       {"order", order_json(plan)},
                       {"warnings", plan.warnings}};
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string clock_text(double seconds) {
    const auto whole = static_cast<long long>(std::llround(seconds));
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string plan_text(const Plan& plan) {
    std::string text = fmt::format("{} on {}\n", plan.job, plan.printer);
    text += fmt::format("  {:<10}{:>10}\n", "layers", plan.layers);
    text += fmt::format("  {:<10}{:>10}   no order needs fewer than {}\n", "swaps", plan.swaps, plan.swap_lower_bound);
    const Seconds& s = plan.seconds;
    for (const auto& [name, value] :
         {std::pair{"time", s.total}, std::pair{" swap", s.swap}, std::pair{" clean", s.clean},
          std::pair{" expose", s.expose}, std::pair{" move", s.move}}) {
        text += fmt::format("  {:<10}{:>10}\n", name, clock_text(value));
    }
    for (const VatUse& use : plan.vats) {
        text += fmt::format("  {:<10}{:>7.1f} ml   {}\n", fmt::format("slot {}", use.slot), use.resin_ml, use.resin);
    }
    for (const std::string& warning : plan.warnings) text += fmt::format("  warning: {}\n", warning);
    return text;
}

}  // namespace pliant::plan

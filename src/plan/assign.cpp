#include "plan/assign.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pliant::plan {
namespace {

using machine::Printer;

std::vector<bool> printed_materials(const job::Manifest& job) {
    std::vector<bool> printed(job.materials.size());
    for (const job::Layer& layer : job.layers) {
        for (const job::LayerImage& image : layer.images) printed[static_cast<std::size_t>(image.material)] = true;
    }
    return printed;
}

/// The resins of the printed materials, each once, in the order of the materials.
std::vector<std::string> needed_resins(const job::Manifest& job, const std::vector<bool>& printed) {
    std::vector<std::string> resins;
    for (std::size_t m = 0; m < job.materials.size(); ++m) {
        const std::string& resin = job.materials[m].resin;
        if (printed[m] && std::find(resins.begin(), resins.end(), resin) == resins.end()) resins.push_back(resin);
    }
    return resins;
}

/// Index of the vat for each resin, -1 where none holds it.
std::vector<int> matching_vats(const std::vector<std::string>& resins, const Printer& printer) {
    std::vector<int> vats;
    for (const std::string& resin : resins) {
        const auto found = std::find_if(printer.vats.begin(), printer.vats.end(),
                                        [&](const machine::Vat& v) { return !resin.empty() && v.resin == resin; });
        vats.push_back(found == printer.vats.end() ? -1 : static_cast<int>(found - printer.vats.begin()));
    }
    return vats;
}

/// The next vat that no resin has taken: an empty one, else the first.
int free_vat(const std::vector<int>& taken, const Printer& printer) {
    int best = -1;
    for (int v = 0; v < static_cast<int>(printer.vats.size()); ++v) {
        if (std::find(taken.begin(), taken.end(), v) != taken.end()) continue;
        if (printer.vats[static_cast<std::size_t>(v)].resin.empty()) return v;
        if (best < 0) best = v;
    }
    return best;
}

std::string refill_warning(const std::string& resin, const machine::Vat& vat) {
    const std::string holds = vat.resin.empty() ? "is empty" : fmt::format("holds \"{}\"", vat.resin);
    return fmt::format("no vat holds \"{}\": fill it into the vat of slot {}, which {}", resin, vat.slot, holds);
}

void collect(const job::Manifest& job, const Printer& printer, const std::vector<bool>& printed,
             const std::vector<std::string>& resins, const std::vector<int>& vats, Assignment& assignment) {
    assignment.vat_of_material.assign(job.materials.size(), -1);
    for (std::size_t r = 0; r < resins.size(); ++r) {
        const machine::Vat& vat = printer.vats[static_cast<std::size_t>(vats[r])];
        VatUse use{vats[r], vat.slot, resins[r], {}, 0, vat.resin != resins[r]};
        for (std::size_t m = 0; m < job.materials.size(); ++m) {
            if (!printed[m] || job.materials[m].resin != resins[r]) continue;
            assignment.vat_of_material[m] = vats[r];
            use.materials.push_back(static_cast<int>(m));
        }
        assignment.vats.push_back(std::move(use));
    }
    std::sort(assignment.vats.begin(), assignment.vats.end(),
              [](const auto& a, const auto& b) { return a.vat < b.vat; });
}

}  // namespace

Result<Assignment> assign_vats(const job::Manifest& job, const Printer& printer) {
    const std::vector<bool> printed = printed_materials(job);
    const std::vector<std::string> resins = needed_resins(job, printed);
    if (resins.size() > printer.vats.size()) {
        return input_error("{} needs {} resins, {} has {} vats", job.name, resins.size(), printer.name,
                           printer.vats.size());
    }
    Assignment assignment;
    for (std::size_t m = 0; m < printed.size(); ++m) {
        if (printed[m]) continue;
        assignment.warnings.push_back(fmt::format("material \"{}\" prints nothing", job.materials[m].name));
    }
    std::vector<int> vats = matching_vats(resins, printer);
    for (std::size_t r = 0; r < resins.size(); ++r) {
        if (vats[r] >= 0) continue;
        vats[r] = free_vat(vats, printer);
        assignment.warnings.push_back(refill_warning(resins[r], printer.vats[static_cast<std::size_t>(vats[r])]));
    }
    collect(job, printer, printed, resins, vats, assignment);
    return assignment;
}

}  // namespace pliant::plan

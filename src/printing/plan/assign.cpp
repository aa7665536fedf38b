#include "printing/plan/assign.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/core/counted.hpp"
#include "base/core/text.hpp"

namespace pliant::plan {
namespace {

using machine::Printer;

/// A resin of the job and the vats that hold it, in the order of use.
struct Supply {
    std::string resin;
    std::vector<int> vats;
    std::size_t in_use = 0;
    double left_ml = 0;
};

std::vector<bool> printed_materials(const job::Manifest& job) {
    std::vector<bool> printed(job.materials.size());
    for (const job::Layer& layer : job.layers) {
        for (const job::LayerImage& image : layer.images) printed[static_cast<std::size_t>(image.material)] = true;
    }
    return printed;
}

/// The resins of the printed materials, without duplicates, in the order of the materials.
std::vector<Supply> needed_resins(const job::Manifest& job, const std::vector<bool>& printed) {
    std::vector<Supply> supplies;
    for (std::size_t m = 0; m < job.materials.size(); ++m) {
        const std::string& resin = job.materials[m].resin;
        const auto known = std::find_if(supplies.begin(), supplies.end(), [&](auto& s) { return s.resin == resin; });
        if (printed[m] && known == supplies.end()) supplies.push_back({resin, {}, 0, 0});
    }
    return supplies;
}

const machine::Vat& vat_at(const Printer& printer, int vat) {
    return printer.vats[static_cast<std::size_t>(vat)];
}

void match_vats(std::vector<Supply>& supplies, const Printer& printer) {
    for (Supply& supply : supplies) {
        for (int v = 0; v < static_cast<int>(printer.vats.size()); ++v) {
            if (!supply.resin.empty() && vat_at(printer, v).resin == supply.resin) supply.vats.push_back(v);
        }
    }
}

bool is_taken(const std::vector<Supply>& supplies, int vat) {
    return std::any_of(supplies.begin(), supplies.end(),
                       [vat](const Supply& s) { return std::find(s.vats.begin(), s.vats.end(), vat) != s.vats.end(); });
}

/// The next vat without a resin of this job: an empty one, else the first. -1 if there is none.
int free_vat(const std::vector<Supply>& supplies, const Printer& printer) {
    int best = -1;
    for (int v = 0; v < static_cast<int>(printer.vats.size()); ++v) {
        if (is_taken(supplies, v)) continue;
        if (vat_at(printer, v).resin.empty()) return v;
        if (best < 0) best = v;
    }
    return best;
}

/// A resin with several vats gives one up if another resin has none.
int give_up_duplicate(std::vector<Supply>& supplies) {
    for (Supply& supply : supplies) {
        if (supply.vats.size() < 2) continue;
        const int vat = supply.vats.back();
        supply.vats.pop_back();
        return vat;
    }
    return -1;
}

std::string fill_warning(const std::string& resin, const machine::Vat& vat) {
    const std::string holds = vat.resin.empty() ? "is empty" : fmt::format("holds \"{}\"", vat.resin);
    return fmt::format("no vat holds \"{}\": fill it into the vat of slot {}, which {}", resin, vat.slot, holds);
}

/// "no vat of tower holds "semiflex", ...": with the nearest known name, if any.
Error no_vat_holds(const std::string& resin, const std::vector<job::Material>& job, const Printer& printer) {
    std::vector<std::string> held, materials;
    for (const machine::Vat& vat : printer.vats) {
        if (!vat.resin.empty() && std::find(held.begin(), held.end(), vat.resin) == held.end())
            held.push_back(vat.resin);
    }
    for (const job::Material& m : job) {
        if (m.resin == resin) materials.push_back(m.name);
    }
    const std::string meant = nearest_name(resin, held);
    const std::string hint = !meant.empty() ? fmt::format("did you mean \"{}\"?", meant)
                             : held.empty() ? std::string("all are empty")
                                            : fmt::format("they hold {}", join_names(held));
    return {Cause::input,
            fmt::format("no vat of {} holds the resin \"{}\" of \"{}\": {} Slice with --resin MATERIAL=RESIN, or with "
                        "--any-vat to fill it into a free vat",
                        printer.name, resin, join_names(materials), hint.back() == '?' ? hint : hint + ".")};
}

double usable_ml(const Printer& printer, int vat) {
    return std::max(0.0, printer.filled_ml(vat_at(printer, vat)) - printer.vat_shape.least_ml);
}

/// Tracks consumption from layer to layer, and which resin runs out when.
class Consumption {
public:
    Consumption(const job::Manifest& job, const Printer& printer, const CarriedOff& carried,
                std::vector<Supply> supplies, Assignment& assignment)
        : job_(job), printer_(printer), carried_(carried), supplies_(std::move(supplies)), assignment_(assignment) {
        for (Supply& s : supplies_) s.left_ml = usable_ml(printer, s.vats.front());
        refills_.resize(supplies_.size());
        uses_.resize(printer.vats.size());
        for (const job::Material& m : job.materials) {
            const auto found =
                std::find_if(supplies_.begin(), supplies_.end(), [&](auto& s) { return s.resin == m.resin; });
            supply_of_.push_back(static_cast<std::size_t>(found - supplies_.begin()));
        }
    }

    void follow() {
        assignment_.vat_of_material.assign(job_.materials.size(), -1);
        std::vector<double> needed(supplies_.size());
        for (std::size_t i = 0; i < job_.layers.size(); ++i) {
            const job::Layer& layer = job_.layers[i];
            std::fill(needed.begin(), needed.end(), 0);
            for (const job::LayerImage& image : layer.images) needed[supply_of(image)] += volume_ml(layer, image);
            for (std::size_t s = 0; s < needed.size(); ++s) {
                if (needed[s] > 0) draw(s, needed[s], i);
            }
            use(layer, static_cast<int>(i));
        }
        for (VatUse& use : uses_) {
            if (!use.materials.empty()) assignment_.vats.push_back(std::move(use));
        }
        for (std::size_t s = 0; s < supplies_.size(); ++s) warn_of_refills(s);
    }

private:
    /// Pixels that two images expose count for both: which vat cures them depends on the order, which is not known yet.
    static double volume_ml(const job::Layer& layer, const job::LayerImage& image) {
        return image.area_mm2 * layer.thickness_um / 1e6;
    }
    std::size_t supply_of(const job::LayerImage& image) const {
        return supply_of_[static_cast<std::size_t>(image.material)];
    }

    /// What the part carries off the vat after its share of the layer.
    double carried_ml(std::size_t layer, int vat) const {
        return carried_.empty() ? 0 : carried_[layer][static_cast<std::size_t>(vat)];
    }

    /// What the part may carry off after a refill that comes before it has left the vat.
    double late_ml(int vat) const {
        const VatUse& use = uses_[static_cast<std::size_t>(vat)];
        return use.materials.empty() ? 0 : carried_ml(static_cast<std::size_t>(use.last_layer), vat);
    }

    /// Takes the layer's resin from the vat in use, from the next one, or after a refill.
    void draw(std::size_t s, double printed_ml, std::size_t layer) {
        Supply& supply = supplies_[s];
        const auto ml = [&] { return printed_ml + carried_ml(layer, supply.vats[supply.in_use]); };
        while (ml() > supply.left_ml && supply.in_use + 1 < supply.vats.size()) {
            supply.left_ml = usable_ml(printer_, supply.vats[++supply.in_use]);
        }
        const int vat = supply.vats[supply.in_use];
        if (ml() > supply.left_ml) {
            refills_[s].push_back(static_cast<int>(layer));
            assignment_.refills.push_back({static_cast<int>(layer), vat_at(printer_, vat).slot, supply.resin});
            supply.left_ml = std::max(ml(), usable_ml(printer_, vat) - late_ml(vat));
        }
        supply.left_ml -= ml();
    }

    void use(const job::Layer& layer, int index) {
        std::vector<int> vats;
        for (const job::LayerImage& image : layer.images) {
            const Supply& supply = supplies_[supply_of(image)];
            const int vat = supply.vats[supply.in_use];
            vats.push_back(vat);
            VatUse& use = uses_[static_cast<std::size_t>(vat)];
            if (use.materials.empty()) {
                use.vat = vat;
                use.slot = vat_at(printer_, vat).slot;
                use.resin = supply.resin;
                use.first_layer = index;
                use.refill = vat_at(printer_, vat).resin != supply.resin;
            }
            if (std::find(use.materials.begin(), use.materials.end(), image.material) == use.materials.end())
                use.materials.insert(std::upper_bound(use.materials.begin(), use.materials.end(), image.material),
                                     image.material);
            use.last_layer = index;
            int& first = assignment_.vat_of_material[static_cast<std::size_t>(image.material)];
            if (first < 0) first = vat;
        }
        assignment_.vat_of_image.push_back(std::move(vats));
    }

    void warn_of_refills(std::size_t s) {
        const std::vector<int>& layers = refills_[s];
        if (layers.empty()) return;
        constexpr std::size_t most_named = 8;
        std::vector<std::string> named;
        for (std::size_t i = 0; i < std::min(layers.size(), most_named); ++i)
            named.push_back(std::to_string(layers[i] + 1));
        if (layers.size() > most_named) named.push_back(fmt::format("{} more", layers.size() - most_named));
        const Supply& supply = supplies_[s];
        const int vat = supply.vats[supply.in_use];
        assignment_.warnings.push_back(
            fmt::format("the vat of slot {} gives {} of \"{}\" at a time: refill it before {} {}",
                        vat_at(printer_, vat).slot, ml_text(usable_ml(printer_, vat)), supply.resin,
                        layers.size() == 1 ? "layer" : "layers", join_names(named)));
    }

    const job::Manifest& job_;
    const Printer& printer_;
    const CarriedOff& carried_;
    std::vector<Supply> supplies_;
    std::vector<std::size_t> supply_of_;  ///< by material
    std::vector<std::vector<int>> refills_;
    std::vector<VatUse> uses_;  ///< by vat
    Assignment& assignment_;
};

}  // namespace

Status check_resins(const std::vector<job::Material>& materials, const Printer& printer) {
    for (const job::Material& m : materials) {
        const bool held =
            !m.resin.empty() && std::any_of(printer.vats.begin(), printer.vats.end(),
                                            [&](const machine::Vat& vat) { return vat.resin == m.resin; });
        if (!held) return tl::unexpected(no_vat_holds(m.resin, materials, printer));
    }
    return {};
}

Result<Assignment> assign_vats(const job::Manifest& job, const Printer& printer, const CarriedOff& carried) {
    const std::vector<bool> printed = printed_materials(job);
    std::vector<Supply> supplies = needed_resins(job, printed);
    if (supplies.size() > printer.vats.size()) {
        return input_error("{} needs {}, {} has {}", job.name, counted(supplies.size(), "resin"), printer.name,
                           counted(printer.vats.size(), "vat"));
    }
    Assignment assignment;
    for (std::size_t m = 0; m < printed.size(); ++m) {
        if (printed[m]) continue;
        assignment.warnings.push_back(fmt::format("material \"{}\" prints nothing", job.materials[m].name));
    }
    match_vats(supplies, printer);
    for (Supply& supply : supplies) {
        if (!supply.vats.empty()) continue;
        if (!job.any_vat) return tl::unexpected(no_vat_holds(supply.resin, job.materials, printer));
        int vat = free_vat(supplies, printer);
        if (vat < 0) vat = give_up_duplicate(supplies);
        supply.vats.push_back(vat);
        assignment.warnings.push_back(fill_warning(supply.resin, vat_at(printer, vat)));
    }
    Consumption(job, printer, carried, std::move(supplies), assignment).follow();
    return assignment;
}

}  // namespace pliant::plan

#include "printing/twin/planned_cure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace pliant::twin {

Result<Cure> planned_cure(const machine::Printer& printer, const job::Manifest& job, const RunSource& images,
                          const Screen& screen, Progress& progress) {
    Cure cure(printer, Keep::counts);
    for (std::size_t vat = 0; vat < printer.vats.size(); ++vat)
        cure.set_level_ml(static_cast<int>(vat), std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < job.layers.size(); ++k) {
        if (progress.cancelled()) return cancelled();
        progress.advance("overcure", static_cast<double>(k) / static_cast<double>(job.layers.size()));
        const job::Layer& layer = job.layers[k];
        for (std::size_t i = 0; i < layer.images.size(); ++i) {
            const int material = layer.images[i].material;
            const std::string& resin = job.materials[static_cast<std::size_t>(material)].resin;
            const auto vat = std::find_if(printer.vats.begin(), printer.vats.end(),
                                          [&](const machine::Vat& v) { return v.resin == resin; });
            if (vat == printer.vats.end()) continue;
            const Result<Runs> image = images(static_cast<int>(k), material);
            if (!image) return tl::unexpected(image.error());
            cure.expose(screen.coverage(*image).runs, static_cast<int>(vat - printer.vats.begin()),
                        job::exposure_s(job, k, i), layer.z_um);
        }
    }
    cure.finish();
    return cure;
}

std::vector<std::string> overcure_warnings(const Cure& cure, const machine::Printer& printer) {
    std::vector<std::string> warnings;
    const Cure::Place& place = cure.deepest_overcure();
    for (std::size_t vat = 0; vat < printer.vats.size(); ++vat) {
        const machine::Resin* resin = printer.find_resin(printer.vats[vat].resin);
        const double beyond_mm3 = cure.overcure_beyond_mm3()[vat];
        if (resin == nullptr || beyond_mm3 <= 0) continue;
        warnings.push_back(fmt::format(
            "overcure: light will cure {:.3f} mm^3 of {} more than {:.0f} um below undersides (deepest of "
            "all: {:.0f} um at row {}, column {} of z {} um); \"print --twin\" fails unless --accept overcure "
            "says that it is meant; less light, more absorber or bleed_compensation in the printer file helps",
            beyond_mm3, resin->name, allowed_overcure_um(*resin), cure.deepest_overcure_um(), place.row, place.column,
            place.z_um));
    }
    return warnings;
}

}  // namespace pliant::twin

#include "printing/twin/sprayed_part.hpp"

#include "printing/twin/coarse_part.hpp"
#include "printing/twin/wet_part.hpp"

namespace pliant::twin {
namespace {

constexpr int most_sprayed_cells = 32;  // maximum in any direction of the part
constexpr double growth_share = 1.05;   // growth after which rays are traced again

}  // namespace

void SprayedPart::look(const std::vector<CuredLayer>& layers) {
    const machine::Projector& projector = printer_->projector;
    seen_um_ = layers.back().top_um;
    CoarsePart part(projector.width_px, projector.height_px, projector.pixel_um, seen_um_);
    for (const CuredLayer& layer : layers) {
        for (const VatLayer& vat : layer.vats) part.add(layer.top_um - layer.thickness_um, layer.top_um, 0, vat.runs);
    }
    const wash::PartCells fine = wet_part(part, projector);
    const wash::PartCells cells = fine.columns > 0 ? wash::coarsened(fine, most_sprayed_cells) : fine;
    faces_ = wash::wet_faces(cells);
    rates_ = wash::washed_rates(cells, faces_, *printer_, wash::strokes_of(*printer_));
}

std::optional<double> SprayedPart::removed(const Cure& cure, double seconds) {
    const machine::Cleaning& cleaning = printer_->cleaning;
    const bool known =
        !printer_->sprinklers.empty() && cleaning.method == machine::CleaningMethod::spray && cleaning.solvent_ml_s > 0;
    const std::vector<CuredLayer>& layers = cure.layers();
    if (!known || layers.empty()) return std::nullopt;
    if (seen_um_ == 0 || layers.back().top_um > growth_share * seen_um_) look(layers);
    if (faces_.empty()) return std::nullopt;
    return wash::cleanness(faces_, rates_, seconds).removed;
}

void SprayedPart::clear() {
    *this = SprayedPart(*printer_);
}

}  // namespace pliant::twin

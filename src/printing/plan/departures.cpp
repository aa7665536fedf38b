#include "printing/plan/departures.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant::plan {
namespace {

using machine::Printer;

double film_ml(double area_mm2, const Printer& printer) {
    return area_mm2 * printer.cleaning.film_um / 1e6;
}

/// The area that resin adheres to when the part leaves a vat: its lower end. It is the area cured in the current layer
/// or, while that is smaller, in the layer before. The virtual printer uses the same rule (printing/twin/cure.hpp).
class LowerEnd {
public:
    LowerEnd(std::span<const std::vector<int>> vat_of_image, const job::Manifest& job)
        : vat_of_image_(vat_of_image), job_(job) {}

    /// `vat` has finished its part of a layer.
    void print(std::size_t layer, int vat) {
        if (layer != layer_) before_mm2_ = std::exchange(now_mm2_, 0);
        layer_ = layer;
        const std::vector<job::LayerImage>& images = job_.layers[layer].images;
        for (std::size_t k = 0; k < images.size(); ++k) {
            if (vat_of_image_[layer][k] == vat) now_mm2_ += images[k].area_mm2;
        }
    }
    [[nodiscard]] double area_mm2() const { return std::max(now_mm2_, before_mm2_); }

private:
    std::span<const std::vector<int>> vat_of_image_;
    const job::Manifest& job_;
    std::size_t layer_ = 0;
    double now_mm2_ = 0, before_mm2_ = 0;
};

double cured_mm2(const job::Layer& layer) {
    return std::accumulate(layer.images.begin(), layer.images.end(), 0.0,
                           [](double sum, const job::LayerImage& image) { return sum + image.area_mm2; });
}

}  // namespace

std::vector<Departure> departures(std::span<const VatList> order, std::span<const std::vector<int>> vat_of_image,
                                  const job::Manifest& job, const Printer& printer) {
    std::vector<Departure> all;
    LowerEnd end(vat_of_image, job);
    int loaded = -1;
    std::size_t printed = 0;
    const auto leave = [&](int next, std::size_t layer) {
        if (loaded >= 0 && loaded != next)
            all.push_back({loaded, next, printed, layer, film_ml(end.area_mm2(), printer)});
    };
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (const int vat : order[i]) {
            leave(vat, i);
            end.print(i, vat);
            loaded = vat;
            printed = i;
        }
    }
    if (printer.store() != machine::Store::none) leave(-1, printed);
    return all;
}

CarriedOff carried_off(std::span<const Departure> departures, std::size_t layers, const Printer& printer) {
    CarriedOff ml(layers, std::vector<double>(printer.vats.size()));
    for (const Departure& d : departures)
        ml[d.printed][static_cast<std::size_t>(d.vat)] += d.film_ml * (1 - printer.brushed_share());
    return ml;
}

CarriedOff most_carried_off(const job::Manifest& job, const Printer& printer) {
    CarriedOff ml;
    double before_mm2 = 0;
    for (const job::Layer& layer : job.layers) {
        const double mm2 = cured_mm2(layer);
        const double most = film_ml(std::max(mm2, before_mm2), printer) * (1 - printer.brushed_share());
        ml.emplace_back(printer.vats.size(), most);
        if (!layer.images.empty()) before_mm2 = mm2;
    }
    return ml;
}

}  // namespace pliant::plan

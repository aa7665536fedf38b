#include "twin/cure.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pliant::twin {
namespace {

constexpr std::size_t most_faults = 1000;

std::vector<Run> runs_of(const std::vector<std::uint16_t>& values, int width) {
    std::vector<Run> runs;
    const int height = static_cast<int>(values.size() / static_cast<std::size_t>(width));
    for (int row = 0; row < height; ++row) {
        const std::uint16_t* line = values.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
        for (int begin = 0; begin < width;) {
            int end = begin + 1;
            while (end < width && line[end] == line[begin]) ++end;
            if (line[begin] > 0) runs.push_back({row, begin, end, line[begin]});
            begin = end;
        }
    }
    return runs;
}

}  // namespace

Cure::Cure(const machine::Printer& printer) : printer_(&printer) {
    for (const machine::Vat& vat : printer.vats) left_ml_.push_back(vat.fill_ml);
}

/// Whether the exposure leaves something solid that holds on to the part; if not, why not is recorded.
bool Cure::cures(int vat, double seconds, int z_um) {
    const machine::Vat& place = printer_->vats[static_cast<std::size_t>(vat)];
    const machine::Resin* resin = printer_->find_resin(place.resin);
    std::string fault;
    if (resin == nullptr) {
        fault = fmt::format("slot {} holds no resin", place.slot);
    } else if (seconds < resin->critical_share * resin->exposure_s - 1e-6) {
        fault = fmt::format("{:.3f} s of light are too short for {}", seconds, resin->name);
    } else if (z_um - top_um_ > resin->cure_depth_um) {
        fault = fmt::format("a gap of {} um at {} um is deeper than {} cures", z_um - top_um_, z_um, resin->name);
    } else if (z_um <= top_um_) {
        fault = fmt::format("no gap is left at {} um", z_um);
    }
    if (fault.empty()) return true;
    if (faults_.size() < most_faults) faults_.push_back(std::move(fault));
    return false;
}

void Cure::open(int z_um) {
    if (open_ && open_->top_um == z_um) return;
    finish();
    open_ = OpenLayer{z_um, z_um - top_um_, {}};
    open_->values.resize(printer_->vats.size());
}

void Cure::expose(const job::Image& image, int vat, double seconds, int z_um) {
    if (open_ && open_->top_um != z_um) finish();
    if (!cures(vat, seconds, z_um)) return;
    open(z_um);
    auto& values = open_->values[static_cast<std::size_t>(vat)];
    values.resize(image.pixels.size());
    long long light = 0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        constexpr int most = 65535;
        values[i] = static_cast<std::uint16_t>(std::min(most, values[i] + image.pixels[i]));
        light += image.pixels[i];
    }
    const double pixel_mm = printer_->projector.pixel_um / 1000;
    const double cured_mm3 = static_cast<double>(light) / 255 * pixel_mm * pixel_mm * open_->thickness_um / 1000;
    double& left = left_ml_[static_cast<std::size_t>(vat)];
    if (left >= 0 && left < cured_mm3 / 1000) {
        const int slot = printer_->vats[static_cast<std::size_t>(vat)].slot;
        faults_.push_back(fmt::format("the vat of slot {} ran dry", slot));
    }
    left -= cured_mm3 / 1000;
}

void Cure::count_double(const OpenLayer& layer) {
    const std::size_t pixels = static_cast<std::size_t>(printer_->projector.width_px) *
                               static_cast<std::size_t>(printer_->projector.height_px);
    for (std::size_t i = 0; i < pixels; ++i) {
        int sum = 0;
        for (const auto& values : layer.values) sum += values.empty() ? 0 : values[i];
        if (sum > 255) ++pixels_lit_twice_;
    }
}

void Cure::finish() {
    if (!open_) return;
    CuredLayer layer{open_->top_um, open_->thickness_um, {}};
    for (std::size_t vat = 0; vat < open_->values.size(); ++vat) {
        if (open_->values[vat].empty()) continue;
        layer.vats.push_back({static_cast<int>(vat), runs_of(open_->values[vat], printer_->projector.width_px)});
    }
    count_double(*open_);
    top_um_ = layer.top_um;
    layers_.push_back(std::move(layer));
    open_.reset();
}

}  // namespace pliant::twin

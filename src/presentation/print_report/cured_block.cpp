#include "presentation/print_report/cured_block.hpp"

#include <algorithm>
#include <map>

namespace pliant::report {
namespace {

using twin::Runs;

/// Pixels by which `wanted` exceeds `have`.
Runs lacking(const Runs& wanted, const Runs& have, int width_px) {
    Runs rest;
    std::vector<int> row(static_cast<std::size_t>(width_px));
    std::size_t at = 0;
    for (std::size_t i = 0; i < wanted.size();) {
        const int number = wanted[i].row;
        const auto at_run = [&](const twin::Run& run, int sign) {
            for (int x = run.begin; x < run.end; ++x) row[static_cast<std::size_t>(x)] += sign * run.value;
        };
        const std::size_t first = i;
        for (; i < wanted.size() && wanted[i].row == number; ++i) at_run(wanted[i], 1);
        while (at < have.size() && have[at].row < number) ++at;
        for (; at < have.size() && have[at].row == number; ++at) at_run(have[at], -1);
        for (int x = wanted[first].begin; x < wanted[i - 1].end; ++x) {
            const int value = row[static_cast<std::size_t>(x)];
            if (value > 0) rest.push_back({number, x, x + 1, static_cast<std::uint16_t>(value)});
        }
        std::fill(row.begin(), row.end(), 0);
    }
    return rest;
}

/// Compares the layers of a job with those of the block, one after the other.
class Comparison {
public:
    Comparison(twin::Twin& twin, const job::Manifest& job, CuredBlock& block)
        : twin_(twin), job_(job), block_(block), width_px_(twin.printer().projector.width_px) {
        for (const machine::Vat& vat : twin.printer().vats) resin_of_vat_.push_back(resin(vat.resin));
        for (const job::Material& material : job.materials) {
            resin_of_material_.push_back(resin(material.resin));
            const auto first =
                std::find(resin_of_material_.begin(), resin_of_material_.end(), resin_of_material_.back());
            shown_.emplace(resin_of_material_.back(), static_cast<int>(first - resin_of_material_.begin()));
        }
    }

    Status compare(const twin::RunSource& images) {
        int below_um = 0;
        for (std::size_t i = 0; i < job_.layers.size(); ++i) {
            const job::Layer& layer = job_.layers[i];
            if (layer.images.empty()) continue;
            std::map<int, std::vector<Runs>> wanted;
            for (const job::LayerImage& image : layer.images) {
                auto runs = images(static_cast<int>(i), image.material);
                if (!runs) return tl::unexpected(runs.error());
                Runs solid = twin_.screen().coverage(*runs).runs;
                block_.asked.add(below_um, layer.z_um, image.material, solid);
                wanted[resin_of_material_[static_cast<std::size_t>(image.material)]].push_back(std::move(solid));
            }
            differ(below_um, layer.z_um, wanted);
            below_um = layer.z_um;
        }
        for (const twin::CuredLayer& layer : twin_.cured().layers()) {
            for (const twin::VatLayer& vat : layer.vats) {
                const auto shown = shown_.find(resin_of_vat_[static_cast<std::size_t>(vat.vat)]);
                const int material = shown == shown_.end() ? static_cast<int>(job_.materials.size()) : shown->second;
                block_.cured.add(layer.top_um - layer.thickness_um, layer.top_um, material, vat.runs);
            }
        }
        return {};
    }

private:
    int resin(const std::string& name) { return resins_.emplace(name, static_cast<int>(resins_.size())).first->second; }

    void differ(int below_um, int z_um, const std::map<int, std::vector<Runs>>& wanted) {
        std::map<int, std::vector<Runs>> have;
        const auto& layers = twin_.cured().layers();
        const auto cured = std::find_if(layers.begin(), layers.end(), [&](auto& l) { return l.top_um == z_um; });
        if (cured != layers.end()) {
            for (const twin::VatLayer& vat : cured->vats)
                have[resin_of_vat_[static_cast<std::size_t>(vat.vat)]].push_back(vat.runs);
        }
        std::vector<Runs> surplus, missing;
        for (int r = 0; r < static_cast<int>(resins_.size()); ++r) {
            const Runs is = summed(have, r), shall = summed(wanted, r);
            if (is == shall) continue;
            surplus.push_back(lacking(is, shall, width_px_));
            missing.push_back(lacking(shall, is, width_px_));
        }
        // Also if nothing differs: all three must have the same slabs.
        block_.off.add(below_um, z_um, 0, surplus.empty() ? Runs{} : twin::sum_of(surplus, width_px_));
        block_.off.add(below_um, z_um, 1, missing.empty() ? Runs{} : twin::sum_of(missing, width_px_));
    }

    Runs summed(const std::map<int, std::vector<Runs>>& of_resin, int resin) const {
        const auto found = of_resin.find(resin);
        return found == of_resin.end() ? Runs{} : twin::sum_of(found->second, width_px_);
    }

    twin::Twin& twin_;
    const job::Manifest& job_;
    CuredBlock& block_;
    int width_px_;
    std::map<std::string, int> resins_;
    std::vector<int> resin_of_vat_, resin_of_material_;
    std::map<int, int> shown_;  ///< the material whose colour is used for a resin
};

}  // namespace

Result<CuredBlock> cured_block(twin::Twin& twin, const job::Manifest& job, const twin::RunSource& images,
                               const twin::Judgement& judgement) {
    constexpr double any_share = 1e-3;
    Result<twin::Report> report = twin::inspect(twin, job, images, judgement);
    if (!report) return tl::unexpected(report.error());
    const machine::Projector& p = twin.printer().projector;
    const int high_um = job.layers.empty() ? 0 : job.layers.back().z_um;
    const twin::CoarsePart part(p.width_px, p.height_px, p.pixel_um, high_um);
    CuredBlock block{std::move(*report), part, part,
                     twin::CoarsePart(p.width_px, p.height_px, p.pixel_um, high_um, any_share)};
    if (Status status = Comparison(twin, job, block).compare(images); !status) return tl::unexpected(status.error());
    return block;
}

}  // namespace pliant::report

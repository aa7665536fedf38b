#include "studio/print/growing_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/core/files.hpp"
#include "presentation/scene/packet.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/operate/job_file.hpp"
#include "studio/base/limits.hpp"

namespace pliant::studio {
namespace {

constexpr std::size_t most_at_once = 50;  // layers or images, so that pages are updated in between

twin::CoarsePart empty_part(const operate::ReadyJob& job) {
    const machine::Projector& p = job.printer.projector;
    const auto& layers = job.archive->manifest().layers;
    return {p.width_px, p.height_px, p.pixel_um, layers.empty() ? 0 : layers.back().z_um};
}

/// The first material printed in each vat; an index past the end for unused vats.
std::vector<int> materials_of_vats(const operate::ReadyJob& job) {
    std::vector<int> materials(job.printer.vats.size(), static_cast<int>(job.job.materials.size()));
    for (const plan::VatUse& use : job.plan.vats) {
        if (!use.materials.empty()) materials[static_cast<std::size_t>(use.vat)] = use.materials.front();
    }
    return materials;
}

}  // namespace

GrowingPart::GrowingPart(std::filesystem::path file, const operate::ReadyJob& job)
    : file_(std::move(file)), material_of_vat_(materials_of_vats(job)), empty_(empty_part(job)), part_(empty_) {
    for (const job::Layer& layer : job.archive->manifest().layers)
        heights_.emplace_back(layer.z_um - layer.thickness_um, layer.z_um);
}

void GrowingPart::clear() {
    {
        const std::lock_guard lock(waiting_mutex_);
        waiting_.clear();
    }
    const std::lock_guard lock(mutex_);
    revisions_before_ = revision() + 1;
    part_ = empty_;
    seen_ = 0;
    lights_seen_.clear();
    grown_ = true;
}

void GrowingPart::exposed(const host::Given& given) {
    if (!given.complete) return;
    const std::lock_guard lock(waiting_mutex_);
    waiting_.push_back(given);
}

void GrowingPart::recall(const std::filesystem::path& journal) {
    const Result<std::string> text = read_file(journal, largest_journal);
    if (!text) return;
    const Result<host::JournalText> records = host::parse_journal(*text, journal.string());
    const auto facts = records ? host::facts_of(records->records) : tl::unexpected(records.error());
    if (!facts) return;
    for (const auto& [step, light] : facts->lights) exposed({light.layer, light.material, light.lit_s, light.complete});
}

/// Adds what is new of the layer after those that have been seen: of a vat all at once, or further exposures of it.
void GrowingPart::add_cured(const twin::CuredLayer& layer) {
    const int bottom_um = layer.top_um - layer.thickness_um;
    lights_seen_.resize(material_of_vat_.size());
    for (const twin::VatLayer& vat : layer.vats) {
        const auto index = static_cast<std::size_t>(vat.vat);
        std::size_t& seen = lights_seen_[index];
        if (seen == 0) part_.add(bottom_um, layer.top_um, material_of_vat_[index], vat.runs);
        for (std::size_t k = seen; seen > 0 && k < vat.lit.size(); ++k)
            part_.add(bottom_um, layer.top_um, material_of_vat_[index], vat.lit[k].light);
        seen = vat.lit.size();
    }
}

void GrowingPart::look_at(PacedTwin& twin, bool is_over) {
    const std::lock_guard lock(mutex_);
    cured_ = true;
    std::vector<twin::CuredLayer> fresh;
    std::optional<twin::CuredLayer> growing;
    const std::size_t lights = std::accumulate(lights_seen_.begin(), lights_seen_.end(), std::size_t{0});
    twin.with([&](twin::Twin& t) {
        if (is_over) (void)t.cured();
        const auto& layers = t.closed_layers();
        const auto first = layers.begin() + static_cast<std::ptrdiff_t>(std::min(seen_, layers.size()));
        const auto count = std::min<std::ptrdiff_t>(layers.end() - first, most_at_once);
        fresh.assign(first, first + count);
        if (first + count == layers.end() && t.open_lights() > (fresh.empty() ? lights : 0)) growing = t.open_layer();
    });
    for (const twin::CuredLayer& layer : fresh) {
        add_cured(layer);
        lights_seen_.clear();
    }
    if (growing) add_cured(*growing);
    seen_ += fresh.size();
    grown_ = grown_ || !fresh.empty() || growing;
}

/// Precondition: archive_mutex_ is held.
Result<job::Archive*> GrowingPart::archive() {
    if (!archive_) {
        Result<operate::OpenJob> open = operate::open_job(file_);
        if (!open) return tl::unexpected(open.error());
        archive_ = std::make_unique<job::Archive>(std::move(open->archive));
    }
    return archive_.get();
}

Result<std::string> GrowingPart::image(int layer, int material) {
    const std::lock_guard lock(archive_mutex_);
    const auto open = archive();
    if (!open) return tl::unexpected(open.error());
    const auto& layers = (*open)->manifest().layers;
    if (layer >= 0 && layer < static_cast<int>(layers.size())) {
        for (const job::LayerImage& entry : layers[static_cast<std::size_t>(layer)].images) {
            if (entry.material == material) return (*open)->file(entry.file);
        }
    }
    return input_error("layer {} has no image of material {}", layer, material);
}

/// Decodes the exposed images; unreadable ones are skipped.
void GrowingPart::take_exposed() {
    for (std::size_t k = 0; k < most_at_once; ++k) {
        host::Given given;
        {
            const std::lock_guard lock(waiting_mutex_);
            if (waiting_.empty()) return;
            given = waiting_.front();
            waiting_.pop_front();
        }
        const Result<job::Image> image = [&]() -> Result<job::Image> {
            const std::lock_guard lock(archive_mutex_);
            const auto open = archive();
            if (!open) return tl::unexpected(open.error());
            return operate::image_of(**open, given.layer, given.material);
        }();
        if (!image) continue;
        const twin::Runs runs = twin::runs_of(*image);
        const auto [bottom_um, top_um] = heights_[static_cast<std::size_t>(given.layer)];
        const std::lock_guard lock(mutex_);
        part_.add(bottom_um, top_um, given.material, runs);
        grown_ = true;
    }
}

std::string GrowingPart::news() {
    take_exposed();
    const std::lock_guard lock(mutex_);
    if (!std::exchange(grown_, false)) return "";
    return fmt::format(R"({{"type":"part","revision":{},"height_mm":{:.4f}}})", revision(), part_.top_um() / 1000.0);
}

std::string GrowingPart::packet(int known, std::size_t from) const {
    const std::lock_guard lock(mutex_);
    from = known == revision() ? std::min(from, part_.closed()) : 0;
    return part_packet(part_, cured_ ? "cured" : "exposed", revision(), from);
}

std::string part_packet(const twin::CoarsePart& part, std::string_view kind, std::int64_t revision, std::size_t from) {
    const auto& slabs = part.slabs();
    std::vector<float> heights;
    for (std::size_t s = from; s < slabs.size(); ++s) {
        heights.push_back(static_cast<float>(slabs[s].bottom_um) / 1000);
        heights.push_back(static_cast<float>(slabs[s].top_um) / 1000);
    }
    std::vector<std::uint32_t> words;
    for (std::size_t r = from < slabs.size() ? slabs[from].first : part.runs().size(); r < part.runs().size(); ++r) {
        const twin::CoarsePart::CellRun& run = part.runs()[r];
        words.push_back(run.slab | static_cast<std::uint32_t>(run.material) << 24U);
        words.push_back(run.row);
        words.push_back(run.begin | static_cast<std::uint32_t>(run.end) << 16U);
    }
    view::Packet packet;
    packet.add("slabs", heights);
    packet.add("runs", words);
    return packet.finish(
        fmt::format(R"({{"kind":"{}","revision":{},"from":{},"closed":{},"cell_px":{},"height_mm":{:.4f}}})", kind,
                    revision, from, part.closed(), part.cell_px(), part.top_um() / 1000.0));
}

std::shared_ptr<const report::CuredBlock> block_of(PacedTwin& twin, const std::filesystem::path& file) {
    const Result<operate::OpenJob> open = operate::open_job(file);
    if (!open) return nullptr;
    const twin::RunSource runs = [&](int layer, int material) {
        return operate::image_of(open->archive, layer, material).map(twin::runs_of);
    };
    Result<report::CuredBlock> block =
        twin.with([&](twin::Twin& t) { return report::cured_block(t, open->archive.manifest(), runs); });
    return block ? std::make_shared<const report::CuredBlock>(std::move(*block)) : nullptr;
}

}  // namespace pliant::studio

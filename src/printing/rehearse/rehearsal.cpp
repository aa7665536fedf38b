#include "printing/rehearse/rehearsal.hpp"

#include <optional>

#include "printing/operate/job_file.hpp"

namespace pliant::rehearse {

class Rehearsal::Images {
public:
    explicit Images(std::shared_ptr<job::Archive> archive) : archive_(std::move(archive)) {}
    [[nodiscard]] Result<job::Image> show(int layer, int material) {
        Result<job::Image> image = operate::image_of(*archive_, layer, material);
        if (!image) return image;
        twin::Runs runs = twin::runs_of(*image);
        runs.shrink_to_fit();  // they are kept
        shown_[{layer, material}] = std::move(runs);
        return image;
    }
    [[nodiscard]] Result<twin::Runs> runs(int layer, int material) const {
        if (const auto known = shown_.find({layer, material}); known != shown_.end()) return known->second;
        return operate::image_of(*archive_, layer, material).map(twin::runs_of);
    }

private:
    std::shared_ptr<job::Archive> archive_;
    std::map<std::pair<int, int>, twin::Runs> shown_;
};

Rehearsal::Rehearsal(std::shared_ptr<const operate::ReadyJob> ready, std::shared_ptr<Images> images,
                     std::unique_ptr<VirtualPrint> print)
    : ready_(std::move(ready)), images_(std::move(images)), print_(std::move(print)) {}

Result<Rehearsal> Rehearsal::make(operate::ReadyJob ready_job, Options options) {
    auto ready = std::make_shared<const operate::ReadyJob>(std::move(ready_job));
    Result<std::optional<job::Image>> mask = operate::mask_of(*ready->archive, ready->printer.projector);
    if (!mask) return tl::unexpected(mask.error());
    options.printer.mask = std::move(*mask);
    if (Status status = twin::check_faults(options.printer.faults, ready->printer); !status)
        return tl::unexpected(status.error());
    auto images = std::make_shared<Images>(ready->archive);
    host::PrintJob job = ready->job;
    job.images = [images](int layer, int material) { return images->show(layer, material); };
    auto print = VirtualPrint::make(ready->printer, std::move(job), std::move(options));
    if (!print) return tl::unexpected(print.error());
    for (const plan::CareBefore& care : ready->plan.solution.care) {
        if (care.layer == 0) (*print)->twin().care(care.care);
    }
    return Rehearsal(std::move(ready), std::move(images), std::move(*print));
}

twin::RunSource Rehearsal::runs() const {
    return [images = images_](int layer, int material) { return images->runs(layer, material); };
}

Result<twin::Report> Rehearsal::inspect(const twin::Judgement& judgement) {
    return twin::inspect(print_->twin(), ready_->archive->manifest(), runs(), judgement);
}

}  // namespace pliant::rehearse

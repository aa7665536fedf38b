// Prints a job file on the virtual printer and inspects the part.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/rehearse/virtual_print.hpp"
#include "printing/twin/inspect.hpp"

namespace pliant::rehearse {

/// Everything set up: the projector's mask, and what the plan requires before the print.
class Rehearsal {
public:
    /// `options.printer.mask` is replaced by the job's. Errors: the mask is missing from the job; no memory for the
    /// journal.
    [[nodiscard]] static Result<Rehearsal> make(operate::ReadyJob ready, Options options);

    [[nodiscard]] VirtualPrint& print() { return *print_; }
    [[nodiscard]] const operate::ReadyJob& job() const { return *ready_; }
    /// The images of the job as shown.
    [[nodiscard]] twin::RunSource runs() const;
    /// Call after the print.
    [[nodiscard]] Result<twin::Report> inspect(const twin::Judgement& judgement = {});

private:
    /// Caches decoded images: decoding is most of the work.
    class Images;
    Rehearsal(std::shared_ptr<const operate::ReadyJob> ready, std::shared_ptr<Images> images,
              std::unique_ptr<VirtualPrint> print);

    std::shared_ptr<const operate::ReadyJob> ready_;
    std::shared_ptr<Images> images_;
    std::unique_ptr<VirtualPrint> print_;
};

}  // namespace pliant::rehearse

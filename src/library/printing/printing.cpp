#include "pliant/printing.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "library/base/calls.hpp"
#include "library/printing/cured_block.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "printing/machine/printer.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/proved_job.hpp"
#include "printing/plan/plan.hpp"
#include "printing/prepare/drawing.hpp"
#include "printing/prepare/slice_job.hpp"
#include "printing/rehearse/rehearsal.hpp"

namespace pliant {
namespace {

using library::value_of;

PrintPlan plan_of(const plan::Plan& plan) {
    PrintPlan out{plan.layers,
                  plan.swaps,
                  plan.seconds.total,
                  plan.seconds.swap,
                  plan.seconds.clean,
                  plan.seconds.expose,
                  plan.seconds.move,
                  plan.solution.used_ml,
                  {},
                  plan.warnings};
    for (const plan::VatUse& vat : plan.vats) {
        out.vats.push_back({vat.slot, vat.resin, vat.resin_ml, vat.refill, plan.refills_of(vat.slot)});
    }
    return out;
}

prepare::PrinterFile printer_of(const std::filesystem::path& file) {
    std::string text = value_of(machine::read_printer_text(file.string()));
    machine::Printer printer = value_of(machine::parse_printer(text, file.string()));
    auto mask = value_of(operate::load_mask(printer.projector, file.string()));
    return {std::move(printer), std::move(text), std::move(mask)};
}

prepare::Order order_of(const SliceOptions& options) {
    prepare::Order order;
    order.inputs = options.inputs;
    order.assignments = options.changes;
    order.resins = options.resins;
    order.layer = options.layer;
    order.copies = options.copies;
    order.any_vat = options.any_vat;
    order.support = options.support;
    order.version = std::string(version());
    return order;
}

}  // namespace

PrintPlan slice_job(const SliceOptions& options, const std::filesystem::path& job, const Watch& watch) {
    if (options.inputs.empty()) throw Failure(Failure::Kind::input, "nothing is given to be sliced");
    if (options.printer.empty()) throw Failure(Failure::Kind::input, "no printer is named to slice for");
    if (job.empty()) throw Failure(Failure::Kind::input, "the name of the job file is empty");
    library::check(prepare::check_job_name(job, options.inputs, options.printer));
    const prepare::PrinterFile printer = printer_of(options.printer);
    library::WatchedProgress progress(watch, "slice");
    auto drawing = prepare::read_drawing(options.inputs, options.changes, progress);
    progress.rethrow();
    auto made = prepare::slice_job(order_of(options), printer, value_of(std::move(drawing)), job, progress);
    progress.rethrow();
    return plan_of(value_of(std::move(made)).plan);
}

PrintPlan plan_job(const std::filesystem::path& job) {
    const operate::OpenJob open = value_of(operate::open_job(job));
    return plan_of(value_of(plan::make_plan(open.archive.manifest(), open.printer)));
}

std::vector<std::string> check_job(const std::filesystem::path& job, const Watch& watch) {
    library::WatchedProgress progress(watch, "check");
    auto proved = operate::prove_job(job, operate::Pixels::areas, nullptr, &progress);
    progress.rethrow();
    return value_of(std::move(proved)).warnings;
}

VirtualPrint print_virtually(const std::filesystem::path& job, const Watch& watch, const VirtualPrintOptions& options) {
    library::WatchedProgress progress(watch, "print");
    auto rehearsal = value_of(rehearse::Rehearsal::make(value_of(operate::load_job(job)), {}));
    const Status printed = rehearsal.print().print(progress);
    progress.rethrow();
    library::check(printed);
    const twin::Report report = value_of(rehearsal.inspect());
    VirtualPrint out;
    out.passed = report.passed;
    out.seconds = report.clock_s;
    out.layers = report.layers;
    out.reasons = report.reasons;
    for (const twin::MaterialReport& material : report.materials)
        out.cured_mm3.emplace_back(material.name, material.cured_mm3);
    out.journal = value_of(rehearsal.print().journal());
    if (options.block) {
        twin::Twin& printer = rehearsal.print().twin();
        out.block =
            std::make_shared<const CuredBlock>(library::cured_block(printer.cured().layers(), printer.printer()));
    }
    return out;
}

}  // namespace pliant

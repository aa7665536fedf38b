// Jobs: slicing, planning, checking, virtual printing.
#include "pliant/printing.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "interpreter.hpp"
#include "parts.hpp"
#include "watcher.hpp"

namespace pliant::python {
namespace {

py::dict plan_dict(const PrintPlan& plan) {
    using namespace py::literals;
    py::list vats;
    for (const PrintPlan::Vat& vat : plan.vats)
        vats.append(py::make_tuple(vat.slot, vat.resin, vat.resin_ml, vat.refill, vat.refills));
    return py::dict("layers"_a = plan.layers, "swaps"_a = plan.swaps, "seconds"_a = plan.seconds,
                    "swap_s"_a = plan.swap_s, "clean_s"_a = plan.clean_s, "expose_s"_a = plan.expose_s,
                    "move_s"_a = plan.move_s, "solution_ml"_a = plan.solution_ml, "vats"_a = vats,
                    "warnings"_a = plan.warnings);
}

py::dict slice(std::vector<std::string> inputs, const std::filesystem::path& printer, const std::filesystem::path& job,
               std::vector<std::string> changes, std::vector<std::string> resins, std::string layer, int copies,
               bool any_vat, std::string support, py::object progress) {
    const SliceOptions options{std::move(inputs), printer,           std::move(changes),
                               std::move(resins), std::move(layer),  copies,
                               any_vat,           std::move(support)};
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    PrintPlan plan;
    {
        const Unlocked unlocked;
        plan = slice_job(options, job, watch);
    }
    return plan_dict(plan);
}

py::dict plan(const std::filesystem::path& job) {
    PrintPlan plan;
    {
        const Unlocked unlocked;
        plan = plan_job(job);
    }
    return plan_dict(plan);
}

std::vector<std::string> check_file(const std::filesystem::path& job, py::object progress) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    const Unlocked unlocked;
    return check_job(job, watch);
}

/// (layers, y, x) voxels with their resins.
py::object block_of(std::shared_ptr<const CuredBlock> block) {
    if (!block) return py::none();
    const Shape shape = {static_cast<py::ssize_t>(block->size[2]), static_cast<py::ssize_t>(block->size[1]),
                         static_cast<py::ssize_t>(block->size[0])};
    return py::make_tuple(view(block->resin.data(), shape, block), view(block->share.data(), shape, block),
                          block->resins, array_of(block->corner_mm), block->pixel_mm,
                          array_of(std::vector<double>(block->bottoms_mm)),
                          array_of(std::vector<double>(block->tops_mm)));
}

py::dict print_job(const std::filesystem::path& job, bool block, py::object progress) {
    using namespace py::literals;
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    VirtualPrint print;
    {
        const Unlocked unlocked;
        print = print_virtually(job, watch, {block});
    }
    return py::dict("passed"_a = print.passed, "reasons"_a = print.reasons, "seconds"_a = print.seconds,
                    "layers"_a = print.layers, "cured_mm3"_a = print.cured_mm3, "journal"_a = print.journal,
                    "block"_a = block_of(print.block));
}

}  // namespace

void add_printing(py::module_& module) {
    module.def("slice", &slice);
    module.def("plan", &plan);
    module.def("check", &check_file);
    module.def("print_virtually", &print_job);
}

}  // namespace pliant::python

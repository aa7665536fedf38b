// pliant compare-printers: compares machines; the comparison of the thesis, recomputed.
#include <fmt/core.h>

#include <string>
#include <vector>

#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "presentation/print_report/printers_page.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::app {
namespace {

struct ComparisonOptions {
    std::vector<std::string> files;
    std::string page;
    Output output;
};

Status compare(const ComparisonOptions& options) {
    std::vector<machine::Printer> printers;
    for (const std::string& file : options.files) {
        Result<machine::Printer> printer = read_printer(file);
        if (!printer) return tl::unexpected(printer.error());
        printers.push_back(std::move(*printer));
    }
    if (!options.page.empty()) {
        const Result<std::string> page = report::printers_page(printers);
        if (!page) return tl::unexpected(page.error());
        if (Status status = write_file(options.page, *page); !status) return status;
    }
    if (options.output.json)
        fmt::print("{}", report::printers_json(printers));
    else if (!options.output.quiet)
        fmt::print("{}", report::printers_text(printers));
    return {};
}

}  // namespace

void add_compare_printers(CLI::App& app, int& status) {
    auto options = std::make_shared<ComparisonOptions>();
    CLI::App* command = app.add_subcommand("compare-printers", "compare printers: swaps, cleaning, packing");
    command->add_option("printers", options->files, "printer files (TOML)")->required();
    command->add_option("-o,--output", options->page, "HTML report (.html)");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant compare-printers examples/printers/*.toml -o printers.html");
    on_call(*command, status, [options] { return compare(*options); });
}

}  // namespace pliant::app

// Prints on a machine in real time, with progress, keys and Ctrl-C.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "command.hpp"
#include "printing/host/control_types.hpp"
#include "printing/twin/fault.hpp"
#include "printing/twin/finding.hpp"

namespace pliant::app {

struct LiveOptions {
    std::string job;
    std::string port;       ///< device; "": the built-in virtual printer
    std::string projector;  ///< folder for the projected images
    std::string journal;    ///< "": beside the job
    std::string after_layer;
    std::string emergency_line;  ///< "": that of the printer file
    std::string report;          ///< file for the HTML report of the print; "": none
    std::string verdict;         ///< file for the verdict on the virtual printer's part, as JSON; "": none
    bool resume = false;
    std::optional<double> assume_lit_s;
    bool assume_vats_untouched = false;
    bool yes = false;  ///< the vats are in place: do not ask
    double speed = 1;
    std::vector<twin::Finding::Kind> accepted;  ///< findings that do not fail a print on the virtual printer
    std::vector<twin::Fault> faults;            ///< of the virtual printer
    std::string clock_file;                     ///< of the virtual printer; "": the wall clock
    Output output;
};

/// The hook for `--after-layer`; empty without it.
[[nodiscard]] host::LayerHook layer_hook(const LiveOptions& options);

/// Returns the exit status.
[[nodiscard]] Result<int> print_live(const LiveOptions& options);

}  // namespace pliant::app

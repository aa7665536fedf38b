// A print on a machine that takes real time: progress, keys, Ctrl-C.
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
    std::string port;       ///< device; "": the virtual printer in this program
    std::string projector;  ///< folder for the pictures
    std::string journal;    ///< "": beside the job
    std::string after_layer;
    std::string emergency_line;  ///< "": the printer file's
    std::string report;          ///< file for the report of the print (HTML); "": none
    bool resume = false;
    std::optional<double> assume_lit_s;
    bool assume_vats_untouched = false;
    bool yes = false;  ///< the vats are in place: nobody is asked
    double speed = 1;
    std::vector<twin::Finding::Kind> accepted;  ///< what may be wrong with a print on the virtual printer
    std::vector<twin::Fault> faults;            ///< of the virtual printer
    std::string clock_file;                     ///< of the virtual printer; "": the wall's clock
    Output output;
};

/// What `--after-layer` asks for; empty: nothing.
[[nodiscard]] host::LayerHook layer_hook(const LiveOptions& options);

/// The exit status.
[[nodiscard]] Result<int> print_live(const LiveOptions& options);

}  // namespace pliant::app

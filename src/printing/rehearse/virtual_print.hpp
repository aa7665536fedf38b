// A whole print on the virtual printer, by the same engine that prints on machines: control, interlocks, journal,
// prompts and guard, with the virtual printer's wire, light and clock as devices. Hours of machine time take a second.
//
//     auto print = VirtualPrint::make(ready->printer, ready->job, {});
//     if (Status done = (*print)->print(progress); done) twin::inspect((*print)->twin(), manifest, images);
//     (*print)->journal();  // what `pliant print --port` would have left beside the job
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "printing/host/control.hpp"
#include "printing/host/journal.hpp"
#include "printing/machine/printer.hpp"
#include "printing/rehearse/memory_file.hpp"
#include "printing/rehearse/operator.hpp"
#include "printing/rehearse/virtual_devices.hpp"
#include "printing/twin/twin.hpp"

namespace pliant::rehearse {

struct Options {
    twin::Options printer{};  ///< release of Marlin, and faults
    /// Wraps the wire to the virtual printer, for example to damage lines. May be empty.
    std::function<std::unique_ptr<host::Wire>(std::unique_ptr<host::Wire>)> wire{};
    std::optional<host::LinkOptions> link{};  ///< nullopt: from the printer file
    host::LayerHook after_layer{};            ///< may be empty
    /// Called whenever the host listens, so that the print can be paused, cancelled or given another exposure. May be
    /// empty.
    std::function<void(host::Control&)> meanwhile{};
};

class VirtualPrint {
public:
    /// The vats hold what `printer` says: pass plan::filled_printer. `job.journal` is not used: the journal is in
    /// memory, and an interruption of the program leaves nothing behind. Errors: no memory for it.
    [[nodiscard]] static Result<std::unique_ptr<VirtualPrint>> make(const machine::Printer& printer, host::PrintJob job,
                                                                    Options options);
    VirtualPrint(const VirtualPrint&) = delete;
    VirtualPrint& operator=(const VirtualPrint&) = delete;

    /// Prints the whole job; call once. Prompts are answered by a WillingOperator. If `progress` is cancelled, so is
    /// the print, as on a machine: dark, parked. Errors: input (the job), failed (the engine's message), cancelled.
    /// Results up to that point remain available.
    [[nodiscard]] Status print(Progress& progress);

    [[nodiscard]] twin::Twin& twin() { return twin_; }
    /// State at the end of the print.
    [[nodiscard]] host::Snapshot snapshot() const { return control_.snapshot(); }
    /// All pieces of exposures that have ended, in order.
    [[nodiscard]] const std::vector<host::Given>& lights() const { return lights_; }
    /// The journal so far, as text and parsed.
    [[nodiscard]] Result<std::string> journal() const;
    [[nodiscard]] Result<std::vector<host::JournalRecord>> records() const;

private:
    VirtualPrint(const machine::Printer& printer, host::PrintJob job, Options options, MemoryFile journal);
    [[nodiscard]] host::ControlSetup setup(const machine::Printer& printer);
    [[nodiscard]] std::unique_ptr<host::Wire> open_wire();
    void look();
    void note(const host::Given& given);

    twin::Twin twin_;
    TwinProjector projector_{twin_};
    TwinClock clock_{twin_};
    TwinGuard guard_{twin_};
    MemoryFile journal_;
    host::PrintJob job_;
    WillingOperator operator_;
    Options options_;
    std::vector<host::Given> lights_;
    Progress* progress_ = nullptr;  ///< of print()
    bool cancelling_ = false;
    host::Control control_;
};

}  // namespace pliant::rehearse

// A whole print on the virtual printer, by the engine that prints on machines: the same control, interlocks, journal,
// prompts and guard, with the virtual printer's wire, light and clock as devices. Hours of the machine take a second.
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
    twin::Options printer{};  ///< which Marlin it is, and what goes wrong
    /// Makes of the wire to the virtual printer the one that the host gets: one that damages lines. May be empty.
    std::function<std::unique_ptr<host::Wire>(std::unique_ptr<host::Wire>)> wire{};
    std::optional<host::LinkOptions> link{};  ///< nullopt: as the printer file says
    host::LayerHook after_layer{};            ///< may be empty
    /// Called whenever the host listens, with what may be asked of the print then: somebody who pauses it, cancels it,
    /// changes a light. May be empty.
    std::function<void(host::Control&)> meanwhile{};
};

class VirtualPrint {
public:
    /// The vats hold what `printer` says: give it plan::filled_printer. `job.journal` is not used: the journal lives in
    /// memory, and what interrupts the program leaves nothing behind. Errors: no memory for it.
    [[nodiscard]] static Result<std::unique_ptr<VirtualPrint>> make(const machine::Printer& printer, host::PrintJob job,
                                                                    Options options);
    VirtualPrint(const VirtualPrint&) = delete;
    VirtualPrint& operator=(const VirtualPrint&) = delete;

    /// From the first line to the last; once. Prompts are answered by a WillingOperator. If `progress` says so, the
    /// print is cancelled as at a machine: dark, parked. Errors: input (the job), failed (the engine's line),
    /// cancelled. What happened up to there can be asked for afterwards.
    [[nodiscard]] Status print(Progress& progress);

    [[nodiscard]] twin::Twin& twin() { return twin_; }
    /// As it was when the print ended.
    [[nodiscard]] host::Snapshot snapshot() const { return control_.snapshot(); }
    /// Every piece of light that has ended, in order.
    [[nodiscard]] const std::vector<host::Given>& lights() const { return lights_; }
    /// The journal as it stands, as text and read.
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

// Control of a print: what a person, a page or a program may request of a machine, and what they can query.
//
//     Control control(setup);                       // devices, machine, programs
//     std::thread worker([&] { control.serve(); }); // all device input and output happens here
//     control.connect();
//     control.load(job);
//     control.start({});
//     control.snapshot().seconds_left; control.events_since(n);
//     control.quit(); worker.join();
//
// Every function but serve() and serve_until_idle() may be called from any thread. A request returns at once and says
// only whether the present state allows it; its progress shows in the snapshot and in the events. The library starts no
// thread: the owner provides one that runs serve().
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"

namespace pliant::host {

class Control {
public:
    explicit Control(ControlSetup setup);
    ~Control();
    Control(const Control&) = delete;
    Control& operator=(const Control&) = delete;

    // The working thread.

    /// Carries out requests until quit().
    void serve();
    /// The same, but returns when there is nothing left to do: no request pending, no print running or paused.
    void serve_until_idle();
    /// Ends serve(). A running print is suspended first: dark, parked, ready to be resumed.
    void quit();

    // Connection.

    [[nodiscard]] Status connect();
    /// Refused while a print is running.
    [[nodiscard]] Status disconnect();

    // The print.

    /// Replaces the previous job. Refused while a print is running. Errors: invalid G-code.
    [[nodiscard]] Status load(PrintJob job);
    [[nodiscard]] Status start(const StartOptions& options);
    [[nodiscard]] Status pause(PauseWhen when);
    /// Ends a pause, also one for a resin refill.
    [[nodiscard]] Status resume();
    /// Ends the print for good: light and pump off, platform up, the vat back in its slot.
    [[nodiscard]] Status cancel();
    /// Like cancel(), but the job may be resumed later.
    [[nodiscard]] Status suspend();
    /// From any state, within 100 ms: light off, hardware emergency line if there is one, M112. The controller then
    /// needs a reset.
    void emergency_stop();

    /// Sets the exposure of one material in normal layers from the next layer on, in seconds; recorded in the journal.
    /// Bottom layers and others with their own exposure change by the same factor, up to what the machine allows.
    /// Errors: a material that the job does not have, a time that the machine does not allow.
    [[nodiscard]] Status set_exposure(int material, double seconds);
    /// Skips the exposures of a layer that has not begun; recorded in the journal.
    [[nodiscard]] Status skip_layer(int layer);

    // Manual control, while no print is running.

    /// Moves to an absolute position; refused if the interlocks forbid it. During such a move or a jog(), another call
    /// stops that move at once (M410) and is itself refused: the axes must then be homed. `feed_mm_s`: 0 for the axis'
    /// own speed, which is also the fastest. Errors: a feed below 0.01 mm/s.
    [[nodiscard]] Status move_to(machine::Axis axis, int um, double feed_mm_s);
    /// Moves by `um` from the current position.
    [[nodiscard]] Status jog(machine::Axis axis, int um, double feed_mm_s);
    /// Homes the given axes, or all in the machine's order if none is given.
    [[nodiscard]] Status home(std::vector<machine::Axis> axes);
    /// Brings the vat of `slot`; 0: puts the present vat away.
    [[nodiscard]] Status bring_vat(int slot);
    [[nodiscard]] Status clean(double seconds);
    /// The same as clean(), to fill the pump's lines.
    [[nodiscard]] Status prime(double seconds);
    /// Deliberately resets the controller by DTR; needs a serial line that has it.
    [[nodiscard]] Status reset_controller();

    // Queries.

    [[nodiscard]] Snapshot snapshot() const;
    /// The state in the snapshot, cheaper for frequent calls.
    [[nodiscard]] State state() const;
    /// Events with numbers above `number`, oldest first; the last 2000 are kept.
    [[nodiscard]] std::vector<Event> events_since(long number) const;

private:
    struct Task;
    struct Private;
    std::unique_ptr<Private> state_;
};

}  // namespace pliant::host

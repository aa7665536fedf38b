// A print under control: what a person, a page or a program may ask of a machine, and what they may know of it.
//
//     Control control(setup);                       // devices, machine, programs
//     std::thread worker([&] { control.serve(); }); // all talk to the devices happens here
//     control.connect();
//     control.load(job);
//     control.start({});
//     control.snapshot().seconds_left; control.events_since(n);
//     control.quit(); worker.join();
//
// Every function may be called from any thread. One that asks for something answers at once whether it can be had in
// the present state; what then happens shows in the snapshot and in the events. The library starts no thread: the owner
// gives serve() one.
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

    // --- the thread that works ---

    /// Carries out what is asked for until quit().
    void serve();
    /// The same in the calling thread, until nothing is left to do: nothing asked for, no print under way or paused.
    void serve_until_idle();
    /// Ends serve(). A print under way is suspended first: dark, parked, ready to be resumed.
    void quit();

    // --- connection ---

    [[nodiscard]] Status connect();
    /// Refused while a print is under way.
    [[nodiscard]] Status disconnect();

    // --- the print ---

    /// Takes the place of the job before. Refused while a print is under way. Errors: G-code that is none.
    [[nodiscard]] Status load(PrintJob job);
    [[nodiscard]] Status start(const StartOptions& options);
    [[nodiscard]] Status pause(PauseWhen when);
    /// Ends a pause, also one that asked for resin.
    [[nodiscard]] Status resume();
    /// Ends the print for good: dark, pump off, platform up, the vat back in its slot.
    [[nodiscard]] Status cancel();
    /// Like cancel(), but the job may be resumed later.
    [[nodiscard]] Status suspend();
    /// From any state, within 100 ms: dark, the hardware line if there is one, M112. The controller then needs a reset.
    void emergency_stop();

    /// Light of one material from the next layer on, in seconds; kept in the journal. Errors: a material that the job
    /// does not have, a time that the machine does not allow.
    [[nodiscard]] Status set_exposure(int material, double seconds);
    /// Leaves the light of a layer out that has not begun; kept in the journal.
    [[nodiscard]] Status skip_layer(int layer);

    // --- by hand, while no print is under way ---

    /// To an absolute position; refused if the interlocks forbid it. While such a move or jog() is under way, that one
    /// is stopped at once (M410) and the new one refused: the axes must then be homed.
    [[nodiscard]] Status move_to(machine::Axis axis, int um, double feed_mm_s);
    /// By so much from where the axis stands.
    [[nodiscard]] Status jog(machine::Axis axis, int um, double feed_mm_s);
    /// All axes in the machine's order, or those named.
    [[nodiscard]] Status home(std::vector<machine::Axis> axes);
    /// Brings the vat of `slot`; 0: puts the one away that is there.
    [[nodiscard]] Status bring_vat(int slot);
    [[nodiscard]] Status clean(double seconds);
    /// Runs the pump over the drain, to fill its lines.
    [[nodiscard]] Status prime(double seconds);
    /// Light where the machine stands, homed or not and with no vat asked for: for a look at focus and dimensions. (A
    /// virtual printer objects to it before it is homed, or without a vat.)
    [[nodiscard]] Status expose_test(job::Image image, double seconds);
    /// Resets the controller by DTR, on purpose; needs a wire that can.
    [[nodiscard]] Status reset_controller();

    // --- what is known ---

    [[nodiscard]] Snapshot snapshot() const;
    /// That of the snapshot, for those who look often.
    [[nodiscard]] State state() const;
    /// Events with numbers above `number`, oldest first; the last 2000 are kept.
    [[nodiscard]] std::vector<Event> events_since(long number) const;

private:
    struct State_;
    std::unique_ptr<State_> state_;
};

}  // namespace pliant::host

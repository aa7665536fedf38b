// Writes the machine's commands and keeps track of axis positions and of the time spent on each activity. The planner's
// times and its G-code come from the same calls, so they agree.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "printing/machine/gcode.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/timeline.hpp"

namespace pliant::plan {

/// What time is counted as. Cleaning is the time that the pump runs; the rest of a vat change is `swap`.
enum class Activity { swap, clean, expose, move };

struct Seconds {
    double total = 0, swap = 0, clean = 0, expose = 0, move = 0;

    Seconds& operator+=(const Seconds& other);
    [[nodiscard]] Seconds operator-(const Seconds& other) const;
};

/// The printer must outlive it.
class Sequence {
public:
    explicit Sequence(const machine::Printer& printer) : printer_(&printer) {}

    /// Writes no text: for times only.
    void mute() { muted_ = true; }
    /// Sets the position without spending time.
    void stand_at(const machine::Position& position) { position_ = position; }

    /// From here on every stretch of a device's work is appended to `stretches`, which must outlive the recording;
    /// nullptr: stop recording.
    void record(std::vector<Stretch>* stretches);

    void activity(Activity activity) { activity_ = activity; }
    void comment(std::string_view text);
    void command(std::string_view line);  ///< takes no time; nothing if empty
    /// Counts the time from the far end of the travel, since the position is not known yet.
    void home(machine::Axis axis);
    void move(machine::Axis axis, int um, double feed_mm_s = 0);  ///< feed 0: as fast as the axis can
    void move_to(const machine::Position& to, double feed_mm_s = 0);
    void dwell(double seconds);
    void fence();  ///< waits until everything before is finished
    /// Switches the pump behind a fence; otherwise switching would be queued with the moves.
    void pump(bool on);
    /// Switches all fans of the machine, likewise.
    void fans(bool on);
    /// Switches the magnet, if there is one, and waits until it holds or releases.
    void magnet(bool holds);
    /// Extends or retracts the fork of a wall's retriever; the caller must wait `Wall::fork_s` before the next move.
    void fork(bool out);
    void expose(const machine::Expose& expose);

    [[nodiscard]] const machine::Printer& printer() const { return *printer_; }
    [[nodiscard]] const machine::Position& position() const { return position_; }
    [[nodiscard]] const Seconds& seconds() const { return seconds_; }
    [[nodiscard]] const std::string& text() const { return text_; }

    /// Records work from `begin_s` to `end_s` of a device that has no command of its own.
    void note(Device device, double begin_s, double end_s);

private:
    void spend(double seconds);
    void note_switch(Device device, bool on, double& on_s);

    const machine::Printer* printer_;
    bool muted_ = false;
    machine::Position position_;
    Activity activity_ = Activity::move;
    Seconds seconds_;
    std::string text_;
    std::vector<Stretch>* stretches_ = nullptr;
    std::array<std::size_t, device_count> last_stretch_{};  ///< of each device; SIZE_MAX: none
    double pump_on_s_ = -1;                                 ///< time when it was switched on; below 0: off
    double fans_on_s_ = -1;
};

/// Down into the resin: fast, then slowly over the last part, then a rest.
void approach(Sequence& sequence, int z_um);

}  // namespace pliant::plan

// The plain values of printing/host/control.hpp.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/solution.hpp"
#include "printing/machine/switches.hpp"
#include "printing/wire/devices.hpp"
#include "printing/wire/emergency_line.hpp"
#include "printing/wire/guard.hpp"
#include "printing/wire/link.hpp"

namespace pliant::host {

/// The image of a layer and a material (indices into the manifest).
using ImageSource = std::function<Result<job::Image>(int layer, int material)>;

/// Where an interrupted print stands, and where it has to go on.
struct Recovery {
    machine::Interlock state;   ///< as far as it is known; axes that are not homed may be anywhere
    machine::Interlock target;  ///< at the next light, or at the end if all of it has been given
    bool finished = false;      ///< no light is left: only park
    int last_lit_vat = -1;      ///< index of the vat that printed last, whose resin clings to the part; -1: none
    /// The controller has lost its position while a vat was taken or left: the tower stands half-way on the hooks.
    bool on_hooks = false;
};

/// What a machine must be told, given where it stands. The host knows no plan: whoever sets it up gives these (see
/// printing/operate/programs.hpp). Each returns G-code, or why there is none.
struct Programs {
    using Make = std::function<Result<std::string>(const machine::Interlock& state)>;
    Make cancel;       ///< everything off, platform up, the vat back in its slot
    Make pause_begin;  ///< everything off, platform clear of the vat
    /// From where pause_begin has left it back to `before`.
    std::function<Result<std::string>(const machine::Interlock& before)> pause_end;
    Make hold_begin;  ///< pump and fans off, and nothing moves
    Make hold_end;    ///< what ran before, runs again
    std::function<Result<std::string>(const machine::Interlock& state, int slot)> bring_vat;  ///< 0: put it away
    std::function<Result<std::string>(const machine::Interlock& state, double seconds)> clean;
    /// From where an interrupted print has left the machine to where its light goes on next.
    std::function<Result<std::string>(const Recovery& recovery)> resume;
};

/// Ask for resin, or for care of the cleaning solution, before a layer.
struct Refill {
    int layer = 0;
    int slot = 0;      ///< of the vat; 0: none, `care` is asked for
    std::string text;  ///< "refill the vat of slot 2 with rigid-flex"; all that is asked for before that layer
    machine::SolutionCare care = machine::SolutionCare::change;
};

/// A job as the host needs it.
struct PrintJob {
    std::string name;
    std::string digest;  ///< of its bytes, see job_digest()
    std::string gcode;
    ImageSource images;
    std::vector<std::string> materials;  ///< their names
    int layers = 0;
    std::vector<Refill> refills;    ///< by layer
    std::string vats;               ///< what must be in the slots, for people; goes into the journal
    std::filesystem::path journal;  ///< "": none is kept, and nothing can be resumed
    bool sync_journal = true;       ///< false: a power cut may lose the end of the journal; for tests
};

/// Light of one image that has ended.
struct Given {
    int layer = 0, material = 0;
    double seconds = 0;     ///< in all its pieces
    bool complete = false;  ///< nothing of it is missing
};

/// Called by the working thread when a light has ended. Must not take long: nothing moves meanwhile.
using LightHook = std::function<void(const Given& given)>;

/// Called by the working thread when a layer has been lit and the platform has risen from it.
using LayerHook = std::function<void(int layer)>;

struct ControlSetup {
    machine::Printer printer;
    std::function<Result<std::unique_ptr<Wire>>()> open_wire;
    Projector& projector;
    Clock& clock;
    Programs programs;
    LinkOptions link;
    EmergencyLine* emergency_line = nullptr;  ///< the hardware's; may be null
    LayerHook after_layer{};                  ///< may be empty
    Guard* guard = nullptr;                   ///< who makes dark if this program dies; may be null
    LightHook after_light{};                  ///< may be empty
    /// Names the run of the clock: sessions of the same one have their times in common. nullopt: the computer's.
    std::optional<std::string> clock_name{};
};

/// What to take for granted where the journal proves nothing.
struct Assume {
    /// How long a light was on that was burning when the host died: seconds.
    std::optional<double> lit_s;
    /// Another program has spoken to the controller since, but has moved no vat.
    bool vats_untouched = false;
};

struct StartOptions {
    bool resume = false;  ///< go on with what the journal says was interrupted
    Assume assume;
};

enum class PauseWhen {
    after_exposure,  ///< a light that is on burns to its end, and the layer is peeled
    now,             ///< dark at once; what is missing of the light is given later
};

enum class State {
    offline,     ///< no wire
    connecting,  ///< waiting for the controller
    idle,        ///< connected, nothing to do
    working,     ///< moves by hand
    printing,
    pausing,
    paused,
    cancelling,  ///< parking, also when suspended
    halted,      ///< after an emergency stop or a restart: connect again
};

/// "Operational", "Printing", ...: as OctoPrint's users know them.
[[nodiscard]] std::string_view state_text(State state);

struct Snapshot {
    State state = State::offline;
    std::string message;      ///< why it stands still, or what it waits for; for people
    bool failed = false;      ///< the last print ended by an error
    bool finished = false;    ///< the last print is complete
    std::string firmware;     ///< as M115 names it
    std::string job;          ///< "": none is loaded
    bool can_resume = false;  ///< the journal holds an interrupted print of this job
    int layer = -1;           ///< from 0; -1: none yet
    int layers = 0;
    int material = -1;  ///< of the current or last light
    std::string image;  ///< entry of the job's archive
    bool lit = false;
    double lit_s = 0;                 ///< how long this light has been on
    double exposure_s = 0;            ///< how long it shall be
    double completion = 0;            ///< share of the print's time, 0 to 1
    double seconds_done = 0;          ///< since the print began, pauses included
    std::optional<double> begun_s;    ///< when that was, on the devices' clock; nullopt: none has begun
    double seconds_left = 0;          ///< as planned
    std::vector<double> exposures_s;  ///< by material, where they have been changed; else 0
    machine::Position position;       ///< after the last command
    std::array<bool, machine::axis_count> homed{};
    int slot = 0;  ///< of the vat in use; 0: none
    bool pump = false;
    std::optional<bool> door_open;                 ///< nullopt: not known, or the machine has no switch at its door
    std::vector<machine::SwitchReading> switches;  ///< limit switches that the printer file lists, as last heard
    std::string prompt;                            ///< what a person is asked to do before resume()
    long lines_sent = 0;
    long resends = 0;
    long last_event = 0;  ///< number of the newest event
};

struct Event {
    long number = 0;     ///< from 1, without gaps
    double clock_s = 0;  ///< of the devices' clock
    std::string kind;    ///< "state", "layer", "light", "dark", "log", "prompt", "error"
    std::string text;
};

/// 16 hexadecimal digits that name these bytes (FNV-1a): tells jobs apart, protects against nothing.
[[nodiscard]] std::string job_digest(std::string_view bytes);

}  // namespace pliant::host

// The plain values of control.hpp.
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

/// State of an interrupted print, and the state from which it has to continue.
struct Recovery {
    machine::Interlock state;   ///< as far as known; axes that are not homed may be anywhere
    machine::Interlock target;  ///< at the next exposure, or at the end if none is left
    bool finished = false;      ///< no exposure is left: only park
    int last_lit_vat = -1;      ///< index of the last vat used for printing, whose resin is still on the part; -1: none
    /// The controller lost its position while a vat was being taken or left: the tower is part-way through the stroke
    /// of the hooks.
    bool on_hooks = false;
};

/// G-code for the machine, given its present state. The host does not know the planner: whoever sets it up provides
/// these (see printing/operate/programs.hpp). Each returns G-code, or why there is none.
struct Programs {
    using Make = std::function<Result<std::string>(const machine::Interlock& state)>;
    Make cancel;       ///< everything off, platform up, the vat back in its slot
    Make pause_begin;  ///< everything off, platform clear of the vat
    /// From where pause_begin left the machine back to `before`.
    std::function<Result<std::string>(const machine::Interlock& before)> pause_end;
    Make hold_begin;  ///< pump and fans off, no motion
    Make hold_end;    ///< restores what was running before
    std::function<Result<std::string>(const machine::Interlock& state, int slot)> bring_vat;  ///< slot 0: put the vat
                                                                                              ///< away
    std::function<Result<std::string>(const machine::Interlock& state, double seconds)> clean;
    /// From where an interrupted print left the machine to the state for its next exposure.
    std::function<Result<std::string>(const Recovery& recovery)> resume;
};

/// A request for resin, or for service of the cleaning solution, before a layer.
struct Refill {
    int layer = 0;
    int slot = 0;      ///< of the vat; 0: none, the request is for `care`
    std::string text;  ///< "refill the vat of slot 2 with rigid-flex"; all requests before that layer
    machine::SolutionCare care = machine::SolutionCare::change;
};

/// A job as the host needs it.
struct PrintJob {
    std::string name;
    std::string digest;  ///< of the job's bytes, see job_digest()
    std::string gcode;
    ImageSource images;
    std::vector<std::string> materials;  ///< names of the materials
    /// Of a normal layer, by material: a change of it changes all other exposures of the material by the same factor.
    /// Where it is missing, all become alike.
    std::vector<double> exposures_s;
    int layers = 0;
    std::vector<Refill> refills;    ///< in order of layers
    std::string vats;               ///< what each slot must hold, for people; recorded in the journal
    std::filesystem::path journal;  ///< "": no journal, so no resume
    bool sync_journal = true;       ///< false: a power cut may lose the end of the journal; for tests
};

/// One exposure that has ended.
struct Given {
    int layer = 0, material = 0;
    double seconds = 0;     ///< total over all its pieces
    bool complete = false;  ///< nothing of it is missing
};

/// Called by the working thread when an exposure has ended. Must return quickly: nothing moves meanwhile.
using LightHook = std::function<void(const Given& given)>;

/// Called by the working thread when a layer has been exposed and the platform has risen from it.
using LayerHook = std::function<void(int layer)>;

struct ControlSetup {
    machine::Printer printer;
    std::function<Result<std::unique_ptr<Wire>>()> open_wire;
    Projector& projector;
    Clock& clock;
    Programs programs;
    LinkOptions link;
    EmergencyLine* emergency_line = nullptr;  ///< hardware emergency line; may be null
    LayerHook after_layer{};                  ///< may be empty
    Guard* guard = nullptr;                   ///< turns the light off if this program dies; may be null
    LightHook after_light{};                  ///< may be empty
    /// Identifies a run of the clock: times of sessions with the same name are comparable. nullopt: the computer's.
    std::optional<std::string> clock_name{};
};

/// What to assume where the journal proves nothing.
struct Assume {
    /// How long an exposure lasted that was in progress when the host died: seconds.
    std::optional<double> lit_s;
    /// Another program has talked to the controller since, but has not moved a vat.
    bool vats_untouched = false;
};

struct StartOptions {
    bool resume = false;  ///< continue the print that the journal shows as interrupted
    Assume assume;
    /// With `resume`: a person has done what the print asked for before it was interrupted, such as to fill a vat.
    bool has_refilled = false;
};

enum class PauseWhen {
    after_exposure,  ///< the current exposure ends normally, and the layer is peeled
    now,             ///< light off at once; the missing exposure is given later
};

enum class State {
    offline,     ///< not connected
    connecting,  ///< waiting for the controller
    idle,        ///< connected, nothing to do
    working,     ///< a manual operation
    printing,
    pausing,
    paused,
    cancelling,  ///< parking, also when suspended
    halted,      ///< after an emergency stop or a restart: connect again
};

struct Snapshot;

/// "Operational", "Printing", ...: OctoPrint's names.
[[nodiscard]] std::string_view state_text(State state);
/// The same; "Connecting" while a print that was started waits for the controller.
[[nodiscard]] std::string_view state_text(const Snapshot& snapshot);
/// True from the request to print until the print has ended, also while it is paused.
[[nodiscard]] bool is_printing(State state);

struct Snapshot {
    State state = State::offline;
    bool connecting = false;  ///< a print has been started, and the controller has yet to answer
    std::string message;      ///< reason for a stop or wait; for people
    bool failed = false;      ///< the last print ended with an error
    bool finished = false;    ///< the last print is complete
    std::string firmware;     ///< as reported by M115
    std::string job;          ///< "": none loaded
    bool can_resume = false;  ///< the journal holds an interrupted print of this job
    int layer = -1;           ///< from 0; -1: none yet
    int layers = 0;
    int material = -1;  ///< of the current or last exposure
    std::string image;  ///< entry of the job's archive that is or was last shown
    bool lit = false;
    double lit_s = 0;                 ///< of this exposure so far, or of the last one, all its pieces together
    double exposure_s = 0;            ///< planned duration of this exposure
    double completion = 0;            ///< fraction of the print's time, 0 to 1
    double seconds_done = 0;          ///< since the print began, pauses included
    std::optional<double> begun_s;    ///< start of the print on the devices' clock; nullopt: none has begun
    double seconds_left = 0;          ///< as planned
    double seconds_planned = 0;       ///< of the whole job, without pauses
    std::vector<double> exposures_s;  ///< by material; 0 if unchanged
    machine::Position position;       ///< after the last command
    std::array<bool, machine::axis_count> homed{};
    std::array<bool, machine::axis_count> has_axis{};  ///< whether the machine has it at all
    int slot = 0;                                      ///< of the vat in use; 0: none
    bool pump = false;
    std::optional<bool> door_open;                 ///< nullopt: unknown, or the machine has no door switch
    std::vector<machine::SwitchReading> switches;  ///< limit switches listed in the printer file, last known states
    std::string prompt;                            ///< what the operator should do before resume()
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

/// 16 hexadecimal digits that identify these bytes (FNV-1a): tells jobs apart; not cryptographic.
[[nodiscard]] std::string job_digest(std::string_view bytes);

}  // namespace pliant::host

// What a journal proves: which exposures were given, what was in progress, where the machine is.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/journal.hpp"
#include "printing/machine/follow.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::host {

/// Encodes a state as one word of a journal, and decodes it. Errors: an invalid word.
[[nodiscard]] std::string write_state(const machine::Interlock::State& state);
[[nodiscard]] Result<machine::Interlock::State> read_state(std::string_view word);

/// The exposure of one step, all its pieces together.
struct LightFact {
    int layer = 0;
    int material = 0;
    double planned_s = 0;
    double lit_s = 0;  ///< proven exposure
    bool complete = false;
    long open_light = 0;      ///< number of the record of an exposure without an end in the journal; 0: none
    double open_since_s = 0;  ///< when it began, on the devices' clock
    long record = 0;          ///< of its last piece
};

/// At most as many lines that are no steps (fences, questions) follow a GoFact before the next one.
constexpr long most_questions = 100;

/// The last point where the machine stood still, and what was sent from there on.
struct GoFact {
    long program = 0;      ///< 0: the job itself; -1: nothing was sent; else the record number of a program
    std::size_t step = 0;  ///< of the job, or line of the program
    long line = 0;         ///< line number of that step on the wire; each further step has the next number
    machine::Interlock::State state;
    long most = 0;  ///< maximum number of steps sent from there before the next entry; 0: up to the next phase
    long record = 0;
};

struct ChangeFact {
    int material = 0;
    double seconds = 0;
    int from_layer = 0;
    long record = 0;
};

/// The last layer for which the command of the operator was run.
struct HookFact {
    int layer = 0;
    long record = 0;
};

struct JournalFacts {
    std::string job, digest, printer;
    std::string boot;      ///< boot identifier of the computer in the last session
    long base = 0;         ///< first line number of the last session
    long before_base = 0;  ///< the controller's last line number before that; -1: none of ours
    bool begun = false;
    bool ended = false;          ///< the print is complete
    bool cancelled = false;      ///< for good
    bool moved = false;          ///< a command that may move the machine was about to be sent
    bool halted = false;         ///< the last session ended with a halted controller, which answers only after a reset
    bool was_reset = false;      ///< the last session ended because the controller restarted: its position is lost
    bool stopped_short = false;  ///< motion was stopped midway (M410): the position is unknown
    std::map<std::size_t, LightFact> lights;            ///< by step of the job
    std::optional<std::size_t> last_light;              ///< step of the last exposure
    std::map<long, std::vector<std::string>> programs;  ///< commands of inserted programs, by record
    std::optional<GoFact> go;
    std::optional<HookFact> hook;
    std::vector<std::string> asked;  ///< what pauses since the last exposure began have asked a person to do
    std::vector<ChangeFact> changes;
    std::vector<int> skipped_layers;
    std::vector<long> skip_records;  ///< parallel to those that the journal holds
};

/// Whether there is a print to resume. One without any motion or exposure has not begun: its port may have been the
/// wrong one.
[[nodiscard]] bool is_interrupted(const JournalFacts& facts);

/// Errors name the record.
[[nodiscard]] Result<JournalFacts> facts_of(const std::vector<JournalRecord>& records);

/// The commands of a program text, without comments and directives.
[[nodiscard]] std::vector<std::string> commands_of(std::string_view program);

}  // namespace pliant::host

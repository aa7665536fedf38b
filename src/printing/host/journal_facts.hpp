// What a journal proves: which light has been given, what was under way, where the machine stands.
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

/// A state as one word of a journal, and back. Errors: no such word.
[[nodiscard]] std::string write_state(const machine::Interlock::State& state);
[[nodiscard]] Result<machine::Interlock::State> read_state(std::string_view word);

/// Light of one step, all its pieces together.
struct LightFact {
    int layer = 0;
    int material = 0;
    double planned_s = 0;
    double lit_s = 0;  ///< that is proven
    bool complete = false;
    long open_light = 0;      ///< number of the record of a light whose end is not in the journal; 0: none
    double open_since_s = 0;  ///< when it began, on the devices' clock
};

/// The last place where the machine stood still, and what was sent from there on.
struct GoFact {
    long program = 0;      ///< 0: the job itself; -1: nothing was sent; else the number of a program's record
    std::size_t step = 0;  ///< of the job, or line of the program
    long line = 0;         ///< number on the wire of that step; each further step has the next
    machine::Interlock::State state;
    long most = 0;  ///< steps sent from there at most, before the next entry; 0: up to the next phase
};

struct ChangeFact {
    int material = 0;
    double seconds = 0;
    int from_layer = 0;
};

struct JournalFacts {
    std::string job, digest, printer;
    std::string boot;      ///< of the computer, in the last session
    long base = 0;         ///< line number with which the last session began
    long before_base = 0;  ///< number of the controller's last line before that; -1: it did not know any of ours
    bool begun = false;
    bool ended = false;          ///< the print is complete
    bool cancelled = false;      ///< for good
    bool moved = false;          ///< a command that may move the machine was about to be sent
    bool halted = false;         ///< the last session ended with a halted controller, which answers only after a reset
    bool stopped_short = false;  ///< motion was stopped on the way (M410): nobody knows where
    std::map<std::size_t, LightFact> lights;            ///< by step of the job
    std::optional<std::size_t> last_light;              ///< step of the last one
    std::map<long, std::vector<std::string>> programs;  ///< commands of inserted programs, by record
    std::optional<GoFact> go;
    std::vector<ChangeFact> changes;
    std::vector<int> skipped_layers;
};

/// Whether there is a print to go on with. One of which nothing has moved and nothing was lit has not begun: its port
/// may have been the wrong one.
[[nodiscard]] bool is_interrupted(const JournalFacts& facts);

/// Errors name the record.
[[nodiscard]] Result<JournalFacts> facts_of(const std::vector<JournalRecord>& records);

/// The commands of a program text, without comments and directives.
[[nodiscard]] std::vector<std::string> commands_of(std::string_view program);

}  // namespace pliant::host

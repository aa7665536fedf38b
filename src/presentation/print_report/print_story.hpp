// What a journal tells of a print, as people would tell it: which light was given when, what went wrong, how it went
// on.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/journal.hpp"

namespace pliant::report {

/// Light of one image, all its pieces together.
struct GivenLight {
    double planned_s = 0;
    double lit_s = 0;
    double at_s = 0;  ///< when it began, counted from the first light of the print
    int pieces = 0;
    bool complete = false;
};

/// Something that was not just the next light.
struct Happening {
    long record = 0;   ///< of the journal
    double at_s = -1;  ///< of the light before it, counted from the first light; -1: before all light
    int layer = -1;    ///< of that light
    bool fault = false;
    std::string text;
    std::string then;  ///< how it went on
};

enum class PrintEnd { not_begun, complete, cancelled, interrupted };

struct PrintStory {
    std::string job, digest, printer;
    PrintEnd end = PrintEnd::not_begun;
    int sessions = 0;                                  ///< hosts that have worked on it
    std::map<std::pair<int, int>, GivenLight> lights;  ///< by layer and material
    std::map<std::pair<int, int>, int> order;          ///< of those: which came first, from 0
    std::vector<Happening> happenings;
    int faults = 0;
};

/// The clock counts on over sessions of one run of the computer; over a restart the time between counts as none.
/// Errors: a record without the values of its kind.
[[nodiscard]] Result<PrintStory> story_of(const std::vector<host::JournalRecord>& records);

}  // namespace pliant::report

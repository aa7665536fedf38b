// The course of a print, extracted from its journal: which exposure was given when, what went wrong, and how it
// continued.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/journal.hpp"

namespace pliant::report {

/// Exposure of one image, all its pieces together.
struct GivenLight {
    double planned_s = 0;
    double lit_s = 0;
    double at_s = 0;  ///< start time, counted from the first exposure of the print
    int pieces = 0;
    bool complete = false;
};

/// An event other than the next exposure.
struct Happening {
    long record = 0;   ///< record number in the journal
    double at_s = -1;  ///< time of the exposure before it, counted from the first exposure; -1: before any
    int layer = -1;    ///< layer of that exposure
    bool fault = false;
    std::string text;  ///< for people: counts layers from 1
    std::string then;  ///< how the print continued
};

enum class PrintEnd { not_begun, complete, cancelled, interrupted };

struct PrintStory {
    std::string job, digest, printer;
    PrintEnd end = PrintEnd::not_begun;
    int sessions = 0;                                  ///< number of hosts that have worked on it
    std::map<std::pair<int, int>, GivenLight> lights;  ///< by layer and material
    std::map<std::pair<int, int>, int> order;          ///< for the same keys: the order of the exposures, from 0
    std::vector<Happening> happenings;
    int faults = 0;
};

/// Time accumulates over sessions within one boot of the computer; the time between boots counts as zero. Errors: a
/// record without the values of its kind. `materials`: their names in the job, for the texts.
[[nodiscard]] Result<PrintStory> story_of(const std::vector<host::JournalRecord>& records,
                                          const std::vector<std::string>& materials = {});

}  // namespace pliant::report

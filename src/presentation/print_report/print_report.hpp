// report.html of a print: what was printed, plan and actual times, exposure per layer, faults and how they were
// handled, resin, journal; one page that needs no network.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "presentation/print_report/cured_block.hpp"
#include "printing/host/journal.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::report {

/// Facts that the journal does not hold; empty or below 0: unknown.
struct PrintExtras {
    std::string machine;   ///< "virtual printer", "/dev/ttyACM0"
    std::string firmware;  ///< as reported by M115
    long lines_sent = -1;
    long resends = -1;
    std::shared_ptr<const CuredBlock> block;  ///< of the virtual printer; null: none
};

/// The page. Errors: a job that cannot be planned or drawn, a journal of another job. Cost: every image is decoded
/// twice.
[[nodiscard]] Result<std::string> print_report(const job::Archive& archive, const machine::Printer& printer,
                                               const std::vector<host::JournalRecord>& journal,
                                               const PrintExtras& extras);

/// For a job file and the journal beside it. Errors: one of them cannot be read; the journal is of another job, or one
/// of its records is about a step, layer, material or vat that there is not.
[[nodiscard]] Result<std::string> print_report(const std::filesystem::path& job, const std::filesystem::path& journal,
                                               const PrintExtras& extras);

}  // namespace pliant::report

// What a study found: tables for people, programs and numpy.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "loop/study/folder.hpp"
#include "loop/study/plan.hpp"
#include "loop/study/run.hpp"
#include "loop/study/sensitivity.hpp"

namespace pliant::study {

/// A result over all rows that gave it.
struct ResultFigures {
    std::string name;
    std::size_t count = 0;
    double least = 0, most = 0, mean = 0, deviation = 0;  ///< of the sample; 0 where there are none
    Sensitivity sensitivity;                              ///< of a study of sensitivity; else empty
};

[[nodiscard]] std::vector<ResultFigures> figures_of(const Plan& plan, const Collected& rows);

/// Keys with their units, results, status and reason, a row each; the same bytes wherever the rows ran.
[[nodiscard]] std::string results_csv(const Plan& plan, const Collected& rows);
/// Wall and processor time of each row.
[[nodiscard]] std::string times_csv(const Collected& rows);
/// First and total indices with their intervals; "" for another study.
[[nodiscard]] std::string sensitivity_csv(const Plan& plan, const std::vector<ResultFigures>& figures);
/// All figures. `account`: of this process, where it ran rows.
[[nodiscard]] std::string summary_json(const Plan& plan, const Collected& rows,
                                       const std::vector<ResultFigures>& figures, const RunAccount* account);

/// results.csv, results.npz, times.csv, summary.json and, of a sensitivity, sensitivity.csv: each whole or not at all.
[[nodiscard]] Status write_outcome(const Plan& plan, const std::filesystem::path& folder, const Collected& rows,
                                   const std::vector<ResultFigures>& figures, const std::string& summary);

}  // namespace pliant::study

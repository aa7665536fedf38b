// Results of a study: tables for people, programs and numpy.
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

/// Statistics of a result over all rows that have it.
struct ResultFigures {
    std::string name;
    std::size_t count = 0;
    double least = 0, most = 0, mean = 0, deviation = 0;  ///< of the sample; 0 if it is empty
    Sensitivity sensitivity;                              ///< for a sensitivity study; otherwise empty
};

[[nodiscard]] std::vector<ResultFigures> figures_of(const Plan& plan, const Collected& rows);

/// Title of the column of a key: "modulus (MPa)".
[[nodiscard]] std::string column_of(const Key& key);
/// One line per row: keys with their units, results, status, reason and warning; the same bytes wherever the rows ran.
[[nodiscard]] std::string results_csv(const Plan& plan, const Collected& rows);
/// Wall and processor time of each row.
[[nodiscard]] std::string times_csv(const Collected& rows);
/// First-order and total indices with their intervals; "" for other studies.
[[nodiscard]] std::string sensitivity_csv(const Plan& plan, const std::vector<ResultFigures>& figures);
/// All figures. `account`: of this process, if it ran rows.
[[nodiscard]] std::string summary_json(const Plan& plan, const Collected& rows,
                                       const std::vector<ResultFigures>& figures, const RunAccount* account);

/// Writes results.csv, times.csv, for a sensitivity study sensitivity.csv, summary.json and results.npz, each
/// atomically.
[[nodiscard]] Status write_outcome(const Plan& plan, const std::filesystem::path& folder, const Collected& rows,
                                   const std::vector<ResultFigures>& figures, const std::string& summary);

}  // namespace pliant::study

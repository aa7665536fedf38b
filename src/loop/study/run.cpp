#include "loop/study/run.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <set>

#include "base/core/stopwatch.hpp"
#include "loop/study/folder.hpp"
#include "loop/study/record.hpp"

namespace pliant::study {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// A chunk locked by this process.
struct OpenChunk {
    RecordFile file;
    std::deque<std::size_t> waiting;
    std::size_t running = 0;
    TaskRecord account;
    Clock::time_point begun = Clock::now();
    Clock::time_point synced = Clock::now();
};

/// Tells from the first rows whether every row fails because of its input: a key that is misspelt, a file that is not
/// there. A single row may be wrong by its values, so each key must have had three of them, or all that it has.
class FirstRows {
public:
    FirstRows(const Plan& plan, bool looks) : plan_(plan), met_(plan.keys.size()), looks_(looks) {
        for (std::size_t k = 0; looks && k < met_.size(); ++k) {
            std::set<std::string> values;
            for (std::size_t row = 0; row < plan.rows.size() && values.size() < enough; ++row)
                values.insert(plan.rows[row][k]);
            wanted_.push_back(values.size());
        }
    }
    /// Takes a row that has ended; true: all rows are wrong.
    bool take(const RowRecord& record) {
        looks_ = looks_ && record.wrong_input;
        if (!looks_) return false;
        bool all = true;
        for (std::size_t k = 0; k < met_.size(); ++k) {
            if (met_[k].size() < wanted_[k]) met_[k].insert(plan_.rows[record.row][k]);
            all = all && met_[k].size() == wanted_[k];
        }
        return all;
    }

private:
    static constexpr std::size_t enough = 3;
    const Plan& plan_;
    std::vector<std::set<std::string>> met_;  ///< (keys) values of rows that failed so
    std::vector<std::size_t> wanted_;         ///< (keys) as many of them are enough
    bool looks_;                              ///< no row has ended in another way
};

/// Hands out the rows of one chunk after the other, and records their outcomes.
class Rows {
public:
    Rows(const Plan& plan, const fs::path& folder, const RunSettings& settings, Progress& progress)
        : plan_(plan), folder_(folder), settings_(settings), progress_(progress) {}

    Result<RunAccount> run() {
        Stopwatch watch;
        // A process that cannot get there would end before its first row, without a word.
        std::error_code ignored;
        if (!plan_.folder.empty() && !fs::is_directory(plan_.folder, ignored))
            return input_error("{}: the rows run in this folder, which is not there", plan_.folder.string());
        Follower follower(plan_, folder_);
        if (Status status = look(follower); !status) return tl::unexpected(status.error());
        judge_.emplace(plan_, settings_.stop_at_wrong_input && recorded_ == 0);
        to_visit_.assign(settings_.chunks.begin(), settings_.chunks.end());
        for (;;) {
            const auto cpu = run_pool(pool_options(), calls(), progress_);
            if (!cpu) return tl::unexpected(cpu.error());
            account_.workers_cpu_s += *cpu;
            if (held_by_others_.empty() || !settings_.wait_for_others) break;
            if (Status status = wait(follower); !status) return tl::unexpected(status.error());
        }
        account_.wall_s = watch.read_s();
        return account_;
    }

private:
    [[nodiscard]] PoolOptions pool_options() const {
        PoolOptions options{settings_.worker, {}, plan_.folder, settings_.jobs, plan_.row_limit_s};
        for (const Wanted& wanted : plan_.results) options.paths.push_back(wanted.path);
        return options;
    }

    PoolCalls calls() {
        return {[this] { return next(); }, [this](std::size_t row) { return begun(row); },
                [this](const RowRecord& record) { return ended(record); },
                [this](std::size_t row) { return open_.at(plan_.chunk_of(row)).file.append(given_up_line(row)); },
                [this] { show(); }};
    }

    void show() {
        const auto rows = static_cast<double>(plan_.rows.size());
        progress_.advance("study", std::min(1.0, static_cast<double>(recorded_) / rows));
    }

    Status look(Follower& follower) {
        const auto count = follower.look();
        if (!count) return tl::unexpected(count.error());
        recorded_ = count->recorded;
        any_done_ = any_done_ || count->done > 0;
        const auto open = follower.open_chunks();
        with_open_rows_ = std::set(open.begin(), open.end());
        return {};
    }

    /// Other processes work on the rest: waits until one of them has died or all rows are recorded.
    Status wait(Follower& follower) {
        constexpr auto pause_us = 200'000;
        for (;;) {
            if (progress_.cancelled()) return cancelled();
            ::usleep(pause_us);
            if (Status status = look(follower); !status) return status;
            show();
            to_visit_.clear();
            for (const std::size_t chunk : std::exchange(held_by_others_, {})) {
                if (with_open_rows_.contains(chunk)) to_visit_.push_back(chunk);
            }
            return {};
        }
    }

    Result<std::optional<RowOrder>> next() {
        for (;;) {
            for (auto& [chunk, open] : open_) {
                if (open.waiting.empty()) continue;
                const std::size_t row = open.waiting.front();
                open.waiting.pop_front();
                ++open.running;
                const fs::path row_folder = fs::absolute(folder_) / "rows" / fmt::format("{:06}", row);
                return std::optional(RowOrder{row, row_words(plan_, row, row_folder),
                                              wants_row_folder(plan_) ? row_folder.string() : ""});
            }
            if (to_visit_.empty()) return std::optional<RowOrder>{};
            const std::size_t chunk = to_visit_.front();
            to_visit_.pop_front();
            if (!with_open_rows_.contains(chunk)) continue;
            if (Status status = visit(chunk); !status) return tl::unexpected(status.error());
        }
    }

    Status visit(std::size_t chunk) {
        auto claimed = RecordFile::claim(plan_, folder_, chunk);
        if (!claimed) return tl::unexpected(claimed.error());
        if (!*claimed) {
            held_by_others_.push_back(chunk);
            return {};
        }
        OpenChunk open{std::move(**claimed), {}, 0, {settings_.place}};
        std::set<std::size_t> known;
        for (const RowRecord& row : open.file.records().rows) known.insert(row.row);
        for (std::size_t row = plan_.chunk_begin(chunk); row < plan_.chunk_end(chunk); ++row) {
            if (known.contains(row)) continue;
            if (ends_tasks(open.file.records().begun, row)) {
                if (Status status = give_up_for_good(open, row); !status) return status;
            } else {
                open.waiting.push_back(row);
            }
        }
        if (!open.waiting.empty()) open_.emplace(chunk, std::move(open));
        return {};
    }

    [[nodiscard]] bool ends_tasks(const std::vector<std::size_t>& begun, std::size_t row) const {
        return settings_.most_begun > 0 && std::count(begun.begin(), begun.end(), row) >= settings_.most_begun;
    }

    Status give_up_for_good(OpenChunk& open, std::size_t row) {
        RowRecord record{
            row,
            false,
            false,
            fmt::format("{} tasks ended while it ran; was there too little memory or time?", settings_.most_begun),
            {}};
        record.values.assign(plan_.results.size(), std::nan(""));
        ++recorded_;
        return open.file.append(record_line(record));
    }

    Status begun(std::size_t row) { return open_.at(plan_.chunk_of(row)).file.append(begun_line(row)); }

    Status ended(const RowRecord& record) {
        if (record.missing_path && !any_done_ && settings_.stop_at_missing_path) return no_such_result(record);
        any_done_ = any_done_ || record.done;
        const std::size_t chunk = plan_.chunk_of(record.row);
        OpenChunk& open = open_.at(chunk);
        if (Status status = open.file.append(record_line(record)); !status) return status;
        ++recorded_;
        ++account_.rows;
        account_.rows_cpu_s += record.cpu_s;
        open.account.rows_cpu_s += record.cpu_s;
        --open.running;
        if (judge_->take(record) && recorded_ < plan_.rows.size()) return every_row_is_wrong(record);
        if (open.waiting.empty() && open.running == 0) return close(chunk);
        constexpr auto sync_every = std::chrono::seconds(2);
        if (Clock::now() - open.synced < sync_every) return {};
        open.synced = Clock::now();
        return open.file.sync();
    }

    Status close(std::size_t chunk) {
        OpenChunk& open = open_.at(chunk);
        open.account.wall_s = std::chrono::duration<double>(Clock::now() - open.begun).count();
        open.account.cpu_s = open.account.rows_cpu_s;
        Status status = open.file.append(record_line(open.account));
        if (status) status = open.file.sync();
        open_.erase(chunk);
        with_open_rows_.erase(chunk);
        return status;
    }

    [[nodiscard]] Status every_row_is_wrong(const RowRecord& record) const {
        return input_error(
            "{}: all of the first {} rows fail because of their input, row {} by: {}; the study stops "
            "here, and --resume runs the other rows in spite of this",
            plan_.study_file, account_.rows, record.row, record.reason);
    }

    /// Adds to the row's reason, which lists the results present, the place in the study file that asks for the result.
    [[nodiscard]] Status no_such_result(const RowRecord& record) const {
        for (const Wanted& wanted : plan_.results) {
            const std::string key = "result." + wanted.name;
            if (!std::isnan(record.values[static_cast<std::size_t>(&wanted - plan_.results.data())])) continue;
            return tl::unexpected(error_of(Cause::input, {{plan_.study_file, wanted.line, key, record.reason}}));
        }
        return input_error("{}: {}", plan_.study_file, record.reason);
    }

    const Plan& plan_;
    const fs::path& folder_;
    const RunSettings& settings_;
    Progress& progress_;
    std::deque<std::size_t> to_visit_;
    std::vector<std::size_t> held_by_others_;
    std::set<std::size_t> with_open_rows_;
    std::map<std::size_t, OpenChunk> open_;
    std::size_t recorded_ = 0;
    bool any_done_ = false;
    std::optional<FirstRows> judge_;
    RunAccount account_;
};

}  // namespace

Result<RunAccount> run_rows(const Plan& plan, const fs::path& folder, const RunSettings& settings, Progress& progress) {
    return Rows(plan, folder, settings, progress).run();
}

std::vector<std::size_t> all_chunks(const Plan& plan, std::size_t share, std::size_t shares) {
    const std::size_t count = plan.chunk_count();
    std::vector<std::size_t> chunks(count);
    for (std::size_t k = 0; k < count; ++k) chunks[k] = (k + share * count / std::max<std::size_t>(shares, 1)) % count;
    return chunks;
}

std::vector<std::size_t> chunks_from(const Plan& plan, std::size_t first, std::size_t count, bool others) {
    const std::size_t all = plan.chunk_count(), own = std::min(count, all - first);
    std::vector<std::size_t> chunks(others ? all : own);
    for (std::size_t k = 0; k < chunks.size(); ++k) chunks[k] = (first + k) % all;
    return chunks;
}

}  // namespace pliant::study

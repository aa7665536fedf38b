#include "loop/study/slurm.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <system_error>

#include "base/core/digest.hpp"
#include "base/core/files.hpp"
#include "base/core/letters.hpp"
#include "base/core/process.hpp"
#include "loop/study/folder.hpp"
#include "loop/study/tool.hpp"

namespace pliant::study {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double patience_s = 120;  // per call; Slurm's own limits are shorter

/// The last line logged by one of these tasks.
std::string last_words(const fs::path& folder, const std::vector<std::size_t>& tasks) {
    for (const std::size_t task : tasks) {
        const auto text = read_file(folder / "slurm" / fmt::format("{}.out", task), std::uintmax_t{16} << 20);
        if (!text) continue;
        std::string_view rest = trimmed(*text);
        if (rest.empty()) continue;
        const std::size_t line = rest.rfind('\n');
        return std::string(line == std::string_view::npos ? rest : rest.substr(line + 1));
    }
    return "nothing";
}

/// Its lines as one sentence after the other.
std::string joined_lines(std::string_view text) {
    std::string joined;
    for (text = trimmed(text); !text.empty();) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = trimmed(text.substr(0, end));
        if (!line.empty()) joined += (joined.empty() ? "" : "; ") + std::string(line);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return joined;
}

enum class Jobs { some, none, unknown };

class Slurm {
public:
    Slurm(const Plan& plan, const fs::path& folder, const SlurmSettings& settings, Progress& progress)
        : plan_(plan),
          folder_(fs::absolute(folder)),
          settings_(settings),
          progress_(progress),
          follower_(plan, folder_) {}

    Result<SlurmAccount> run() {
        for (;;) {
            if (Status status = look(); !status) return tl::unexpected(status.error());
            if (complete()) return account_;
            if (progress_.cancelled()) return cancel();
            const Result<Jobs> jobs = ask();
            if (progress_.cancelled()) return cancel();
            if (!jobs) return tl::unexpected(jobs.error());
            if (*jobs == Jobs::none) {
                // Read the records again: a task that has left the queue has written all of its rows, perhaps since the
                // last look.
                Status status = look();
                if (status && !complete()) status = submit();
                if (!status) return give_up(std::move(status));
            }
            if (Status status = wait(); !status) return give_up(std::move(status));
        }
    }

private:
    [[nodiscard]] bool complete() const { return count_.recorded == plan_.rows.size(); }

    Status write_script(std::size_t chunks_of_task) {
        std::error_code error;
        fs::create_directories(folder_ / "slurm", error);
        return write_file(folder_ / "slurm" / "task.sh",
                          task_script(plan_, settings_.program, folder_, chunks_of_task));
    }

    /// Number of tasks that may run at a time; 0: unknown.
    [[nodiscard]] std::size_t most_at_a_time() const {
        std::vector<std::string> words{"--noheader", "--format=%C"};
        if (!plan_.slurm.partition.empty()) words.push_back("--partition=" + plan_.slurm.partition);
        const auto answer = run_tool("sinfo", words, patience_s, progress_);
        if (!answer || answer->status != 0) return 0;
        const std::size_t tasks =
            total_processors(answer->output) / static_cast<std::size_t>(std::max(plan_.slurm.cpus_per_task, 1));
        const auto most = static_cast<std::size_t>(settings_.most_tasks);
        return most > 0 ? std::min(most, tasks) : tasks;
    }

    Status look() {
        auto count = follower_.look();
        if (!count) return tl::unexpected(count.error());
        count_ = std::move(*count);
        progress_.advance("study", static_cast<double>(count_.recorded) / static_cast<double>(plan_.rows.size()));
        if (count_.missing_path > 0 && count_.done == 0)
            return input_error("{}: {}", plan_.study_file, count_.missing_reason);
        return {};
    }

    /// Errors: Slurm is not installed, or has not responded since the start.
    Result<Jobs> ask() {
        const auto answer = run_tool("squeue", {"--noheader", "--format=%i", "--name=" + job_name(plan_, folder_)},
                                     patience_s, progress_);
        if (answer && answer->status == 0) {
            answered_ = true;
            return trimmed(answer->output).empty() ? Jobs::none : Jobs::some;
        }
        if (answered_) return Jobs::unknown;
        if (!answer) return tl::unexpected(answer.error());
        constexpr auto first_patience = std::chrono::minutes(5);
        if (!passes_later(answer->errors) || Clock::now() - begun_ > first_patience)
            return failure("Slurm does not answer: {}", joined_lines(answer->errors));
        progress_.advance("waiting for Slurm", 0);
        return Jobs::unknown;
    }

    Status submit() {
        constexpr int most_idle = 6;
        idle_ = account_.submissions > 0 && count_.recorded == recorded_at_submission_ ? idle_ + 1 : 0;
        const auto chunks = follower_.open_chunks();
        const std::size_t chunks_of_task = chunks_for_each_task(chunks.size(), most_at_a_time());
        const auto tasks = tasks_of(chunks, chunks_of_task);
        if (idle_ >= most_idle)
            return failure("the tasks of {} submissions in turn ended without a row; the last words of one: {}",
                           most_idle, last_words(folder_, tasks));
        if (Status status = write_script(chunks_of_task); !status) return status;
        recorded_at_submission_ = count_.recorded;
        const auto answer =
            run_tool("sbatch", sbatch_words(plan_, folder_, tasks, settings_.most_tasks), patience_s, progress_);
        if (!answer) return {};  // timeout: squeue will tell below whether it was accepted
        if (answer->status != 0 && passes_later(answer->errors)) return {};  // squeue will tell whether it was accepted
        if (answer->status != 0) return failure("sbatch refuses the study: {}", trimmed(answer->errors));
        ++account_.submissions;
        account_.tasks += tasks.size();
        pause_s_ = 1;
        return {};
    }

    /// Waits until the next query of Slurm, or until all rows are recorded.
    Status wait() {
        const auto until =
            Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause_s_));
        pause_s_ = std::min(pause_s_ * 1.5, settings_.look_every_s);
        while (Clock::now() < until && !progress_.cancelled() && !complete()) {
            constexpr auto breath_us = 100'000;
            for (int k = 0; k < 10 && Clock::now() < until && !progress_.cancelled(); ++k) ::usleep(breath_us);
            if (Status status = look(); !status) return status;
        }
        return {};
    }

    void end_jobs() {
        const Progress patient;  // completes even after Ctrl-C
        (void)run_tool("scancel", {"--quiet", "--name=" + job_name(plan_, folder_)}, patience_s, patient);
    }
    Result<SlurmAccount> cancel() {
        end_jobs();
        return cancelled();
    }
    Result<SlurmAccount> give_up(Status status) {
        end_jobs();
        return tl::unexpected(status.error());
    }

    const Plan& plan_;
    fs::path folder_;
    const SlurmSettings& settings_;
    Progress& progress_;
    Follower follower_;
    Follower::Count count_;
    SlurmAccount account_;
    std::size_t recorded_at_submission_ = 0;
    int idle_ = 0;
    bool answered_ = false;  ///< Slurm has responded before: if it does not respond now, it will again
    Clock::time_point begun_ = Clock::now();
    double pause_s_ = 1;
};

}  // namespace

std::string job_name(const Plan& plan, const fs::path& folder) {
    Digest digest;
    const std::string path = fs::absolute(folder).lexically_normal().string();
    digest.add(path.data(), path.size());
    return fmt::format("pliant-{}-{}", plan.fingerprint.substr(0, 8), digest.text().substr(0, 8));
}

std::size_t total_processors(std::string_view text) {
    std::size_t total = 0;
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(line.size() + 1, text.size()));
        const std::string_view last = trimmed(line.substr(line.rfind('/') + 1));
        std::size_t count = 0;
        const auto read = std::from_chars(last.data(), last.data() + last.size(), count);
        if (read.ec == std::errc{}) total += count;
    }
    return total;
}

std::size_t chunks_for_each_task(std::size_t chunks, std::size_t at_a_time) {
    constexpr std::size_t tasks_in_turn = 2;  // they also take what others have not begun, so few are enough
    const std::size_t most_tasks = tasks_in_turn * at_a_time;
    if (at_a_time == 0 || chunks <= most_tasks) return 1;
    const auto quotient = [](std::size_t a, std::size_t b) { return (a + b - 1) / b; };
    const std::size_t least = quotient(chunks, most_tasks);
    for (std::size_t each = least; each <= 2 * least; ++each) {
        if (quotient(chunks, each) % at_a_time == 0) return each;  // no processor is left without a last task
    }
    return least;
}

std::vector<std::size_t> tasks_of(std::span<const std::size_t> chunks, std::size_t chunks_of_task) {
    std::vector<std::size_t> tasks;
    for (const std::size_t chunk : chunks) {
        const std::size_t task = chunk / chunks_of_task * chunks_of_task;
        if (tasks.empty() || tasks.back() != task) tasks.push_back(task);
    }
    return tasks;
}

std::string array_text(std::span<const std::size_t> tasks) {
    std::string text;
    for (std::size_t k = 0; k < tasks.size();) {
        std::size_t last = k;
        while (last + 1 < tasks.size() && tasks[last + 1] == tasks[last] + 1) ++last;
        text += text.empty() ? "" : ",";
        text += last == k ? fmt::format("{}", tasks[k]) : fmt::format("{}-{}", tasks[k], tasks[last]);
        k = last + 1;
    }
    return text;
}

std::vector<std::string> sbatch_words(const Plan& plan, const fs::path& folder, std::span<const std::size_t> tasks,
                                      int most_tasks) {
    const SlurmOptions& slurm = plan.slurm;
    std::vector<std::string> words{
        "--job-name=" + job_name(plan, folder),
        "--array=" + array_text(tasks) + (most_tasks > 0 ? fmt::format("%{}", most_tasks) : ""),
        "--nodes=1",
        "--ntasks=1",
        fmt::format("--cpus-per-task={}", slurm.cpus_per_task),
        "--no-requeue",  // missing rows are submitted anew instead
        "--chdir=" + folder.string(),
        "--output=" + (folder / "slurm" / "%a.out").string(),
    };
    const auto add = [&words](const std::string& option, const std::string& value) {
        if (!value.empty()) words.push_back(option + value);
    };
    add("--partition=", slurm.partition);
    add("--account=", slurm.account);
    add("--time=", slurm.time);
    add("--mem=", slurm.memory);
    words.insert(words.end(), slurm.options.begin(), slurm.options.end());
    words.push_back((folder / "slurm" / "task.sh").string());
    return words;
}

std::string task_script(const Plan& plan, const fs::path& program, const fs::path& folder, std::size_t chunks_of_task) {
    // Where a task has a time limit, it would end in the middle of another task's rows.
    const std::string_view others = plan.slurm.time.empty() ? " --others" : "";
    return fmt::format(
        "#!/bin/sh\n"
        "# One task of the study in this folder: the rows of some chunks that have no record yet.\n"
        "exec {} study {} --chunk \"$SLURM_ARRAY_TASK_ID\" --chunks {}{} --jobs \"${{SLURM_CPUS_PER_TASK:-1}}\" "
        "--quiet\n",
        in_shell_quotes(program.string()), in_shell_quotes(folder.string()), chunks_of_task, others);
}

bool passes_later(std::string_view errors) {
    constexpr std::array<std::string_view, 7> signs{
        "contact slurm controller", "Socket timed out", "Connection refused",
        "connect failure",          "Zero Bytes",       "temporarily",
        "Communication connection"};
    return std::any_of(signs.begin(), signs.end(),
                       [errors](std::string_view sign) { return errors.find(sign) != std::string_view::npos; });
}

Result<SlurmAccount> run_on_slurm(const Plan& plan, const fs::path& folder, const SlurmSettings& settings,
                                  Progress& progress) {
    return Slurm(plan, folder, settings, progress).run();
}

}  // namespace pliant::study

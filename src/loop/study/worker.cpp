#include "loop/study/worker.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/core/file_handle.hpp"
#include "base/core/json.hpp"
#include "base/core/stopwatch.hpp"
#include "loop/study/failure.hpp"
#include "loop/study/json_path.hpp"
#include "loop/study/wire.hpp"

namespace pliant::study {
namespace {

double seconds(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Processor time of this process and its ended child processes.
double cpu_s() {
    double sum = 0;
    for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        getrusage(who, &usage);
        sum += seconds(usage.ru_utime) + seconds(usage.ru_stime);
    }
    return sum;
}

/// Extracts the wanted numbers from a command's output; null if missing.
class Reading {
public:
    explicit Reading(const std::vector<JsonPath>& paths) : paths_(paths), values(nlohmann::json::array()) {}

    void read(const std::string& output) {
        json = parse_json(output);
        readable = !json.is_discarded();
        for (const JsonPath& path : paths_) {
            const Result<double> number = readable ? path.number_in(json) : Result<double>(0.0);
            values.push_back(readable && number ? nlohmann::json(*number) : nlohmann::json(nullptr));
            if (readable && !number && missing.empty()) missing = number.error().message;
        }
    }

private:
    const std::vector<JsonPath>& paths_;

public:
    nlohmann::json json, values;
    bool readable = false;
    std::string missing;  ///< error message of the first missing path
};

/// The list `warnings` of a command's output, of which every one may be the grave one; "" if it has none.
std::string warning_in(const nlohmann::json& output) {
    std::string all;
    if (!output.is_object() || !output.contains("warnings") || !output["warnings"].is_array()) return all;
    for (const auto& warning : output["warnings"]) {
        if (warning.is_string()) all += (all.empty() ? "" : "; ") + warning.get<std::string>();
    }
    return all;
}

constexpr int wrong_input = 2;  ///< exit status of a command whose files or options are wrong

nlohmann::json run_row(const std::vector<std::string>& words, const std::vector<JsonPath>& paths,
                       const RunCommand& run) {
    Stopwatch watch;
    const double cpu_before = cpu_s();
    const CommandOutcome outcome = run(words);
    Reading reading(paths);
    reading.read(outcome.output);
    std::string reason;
    bool missing_path = false;
    if (outcome.exit_status != 0) {
        reason = reason_of_failure(reading.json, outcome.errors, outcome.exit_status);
    } else if (!reading.readable) {
        reason = "the command printed no JSON";
    } else if (!reading.missing.empty()) {
        missing_path = true;
        reason = reading.missing;
    }
    return {{"done", reason.empty()},
            {"missing_path", missing_path},
            {"wrong_input", outcome.exit_status == wrong_input},
            {"reason", reason},
            {"warning", warning_in(reading.json)},
            {"values", std::move(reading.values)},
            {"wall_s", watch.read_s()},
            {"cpu_s", cpu_s() - cpu_before}};
}

FileHandle memory_file(const char* name) {
    return FileHandle(::memfd_create(name, MFD_CLOEXEC));
}

std::string file_contents(int file) {
    std::string text;
    std::array<char, 65536> piece{};
    off_t at = 0;
    for (ssize_t got = 0; (got = ::pread(file, piece.data(), piece.size(), at)) > 0; at += got)
        text.append(piece.data(), static_cast<std::size_t>(got));
    return text;
}

/// Redirects standard output or error to a file, temporarily.
class Redirected {
public:
    Redirected(int standard, int into) : standard_(standard), before_(::fcntl(standard, F_DUPFD_CLOEXEC, 3)) {
        ::dup2(into, standard_);
    }
    Redirected(const Redirected&) = delete;
    Redirected& operator=(const Redirected&) = delete;
    ~Redirected() {
        if (before_.is_open()) ::dup2(before_.number(), standard_);
    }

private:
    int standard_;
    FileHandle before_;
};

/// The first message: the wanted results of each row, and the working directory.
bool begin(const nlohmann::json& message, std::vector<JsonPath>& paths) {
    const auto work_in = message.at("work_in").get<std::string>();
    if (!work_in.empty() && ::chdir(work_in.c_str()) != 0) return false;
    for (const auto& text : message.at("paths")) {
        auto path = JsonPath::parse(text.get<std::string>());
        if (!path) return false;
        paths.push_back(std::move(*path));
    }
    return true;
}

/// False: not a message of a study.
bool answer(int file, const nlohmann::json& message, std::vector<JsonPath>& paths, const RunCommand& run) {
    if (message.contains("paths")) return begin(message, paths) && send_message(file, {{"ready", true}});
    const auto folder = message.at("folder").get<std::string>();
    std::error_code error;
    if (!folder.empty()) std::filesystem::create_directories(folder, error);
    return send_message(file, run_row(message.at("words").get<std::vector<std::string>>(), paths, run));
}

}  // namespace

CommandOutcome captured(const std::function<int()>& work) {
    const FileHandle output = memory_file("output"), errors = memory_file("errors");
    CommandOutcome outcome;
    std::fflush(stdout);
    std::fflush(stderr);
    {
        const Redirected out(STDOUT_FILENO, output.number());
        const Redirected err(STDERR_FILENO, errors.number());
        outcome.exit_status = work();
        std::fflush(stdout);
        std::fflush(stderr);
    }
    outcome.output = file_contents(output.number());
    outcome.errors = file_contents(errors.number());
    return outcome;
}

int serve_rows(int file, const RunCommand& run) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // even in the middle of a row: its result would be lost anyway
    Inbox inbox;
    std::vector<JsonPath> paths;
    try {
        while (inbox.read_some(file)) {
            while (const auto message = inbox.take()) {
                if (!answer(file, *message, paths, run)) return 1;
            }
            if (inbox.failed()) return 1;
        }
    } catch (const nlohmann::json::exception&) {
        return 1;
    }
    return 0;
}

}  // namespace pliant::study

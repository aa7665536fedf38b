#include "geometry/mesher/mesh_worker.hpp"

#include <dlfcn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "base/core/process.hpp"
#include "geometry/mesher/packing.hpp"

namespace pliant::mesh {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int look_every_ms = 50;  // interval of checks for cancellation
constexpr double start_s = 600;    // allows for loading Open CASCADE from a slow disk of a machine with much to do

constexpr double longest_s = 1e9, most_gigabytes = 1e9;  // more is as good as no limit
constexpr const char* seconds_name = "PLIANT_MESH_SECONDS";
constexpr const char* gigabytes_name = "PLIANT_MESH_GIGABYTES";

/// At most `most`. Error: the variable is no positive number.
Result<double> environment_number(const char* name, double otherwise, double most) {
    const char* const text = std::getenv(name);
    if (text == nullptr) return otherwise;
    double value = 0;
    const auto read = std::from_chars(text, text + std::strlen(text), value);
    if (read.ec == std::errc{} && *read.ptr == '\0' && std::isfinite(value) && value > 0) return std::min(value, most);
    return input_error("{} is \"{}\"; it must be a number over 0", name, text);
}

/// A process of pliant-mesh, idle or working on a request.
class Worker {
public:
    Worker(pid_t process, MessagePipe pipe) : process_(process), pipe_(std::move(pipe)) {}

    [[nodiscard]] ChildProcess& process() { return process_; }
    [[nodiscard]] MessagePipe& pipe() { return pipe_; }

private:
    ChildProcess process_;
    MessagePipe pipe_;
};

Result<std::unique_ptr<Worker>> start_worker(const MesherLimits& limits) {
    const Result<std::filesystem::path> program = mesher_program();
    if (!program) return tl::unexpected(program.error());
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
        return failure("no pipe to the mesher can be made: {}", std::strerror(errno));
    MessagePipe ours(ends[0]);
    const MessagePipe theirs(ends[1]);
    // It ends with this program, or when killed by it; Ctrl-C affects this program only.
    const Result<pid_t> process =
        start_process(*program, {fmt::format("{}", limits.gigabytes)}, {.input = theirs.file()});
    if (!process) return tl::unexpected(process.error());
    return std::make_unique<Worker>(*process, std::move(ours));
}

/// Processes that wait for a request, until the program ends.
class IdleWorkers {
public:
    std::unique_ptr<Worker> take() {
        const std::lock_guard lock(mutex_);
        // A program that was forked has copies of the pipes of the one before it, which still uses them.
        std::erase_if(idle_, [](const auto& worker) { return !worker->process().is_ours(); });
        if (idle_.empty()) return nullptr;
        std::unique_ptr<Worker> worker = std::move(idle_.back());
        idle_.pop_back();
        return worker;
    }
    void give_back(std::unique_ptr<Worker> worker) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(worker));
    }

private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<Worker>> idle_;
};

/// Shared by the whole program, because starting a process takes as long as meshing a small body.
IdleWorkers& idle_workers() {
    static IdleWorkers workers;
    return workers;
}

/// A cache of answers. The oldest are dropped when it is full.
class RememberedAnswers {
public:
    void set_room(std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        room_ = bytes;
        make_room(0);
    }
    std::optional<std::string> find(MessageKind kind, const std::string& request) {
        const std::lock_guard lock(mutex_);
        for (const Answer& answer : answers_) {
            if (answer.kind == kind && answer.request == request) return answer.bytes;
        }
        return std::nullopt;
    }
    void keep(MessageKind kind, const std::string& request, const std::string& bytes) {
        const std::lock_guard lock(mutex_);
        // Files may have changed by the next request.
        if (kind == MessageKind::read_step || request.size() + bytes.size() > room_) return;
        make_room(request.size() + bytes.size());
        answers_.push_back({kind, request, bytes});
    }

private:
    struct Answer {
        MessageKind kind;
        std::string request, bytes;
    };
    void make_room(std::size_t wanted) {
        std::size_t used = wanted;
        for (const Answer& answer : answers_) used += answer.request.size() + answer.bytes.size();
        while (used > room_ && !answers_.empty()) {
            used -= answers_.front().request.size() + answers_.front().bytes.size();
            answers_.pop_front();
        }
    }
    std::mutex mutex_;
    std::size_t room_ = 0;
    std::deque<Answer> answers_;
};

/// Shared by the whole program, like the processes.
RememberedAnswers& remembered_answers() {
    static RememberedAnswers answers;
    return answers;
}

constexpr const char* other_program =
    "pliant-mesh is of another version than this program, or what PLIANT_MESH names is another program; install both "
    "together";

/// How much of a message, and how long, is waited for.
struct Patience {
    Clock::time_point until;
    std::string late;  ///< the error after that
    std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max();
};

/// Why it closed its pipe. `crash`: what to say if it ended by itself.
tl::unexpected<Error> ended(const ProcessEnd& end, const std::string& crash) {
    if (!was_killed(end)) return failure("{} ({})", crash, end_text(end));
    return failure(
        "pliant-mesh was killed, as happens when memory runs out; take a larger mesh size, or end other programs ({})",
        end_text(end));
}

Clock::time_point in_seconds(double s) {
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

/// Waits for the next message, and checks for cancellation and timeout meanwhile.
Result<Message> next_message(Worker& worker, const Patience& patience, const std::string& crash,
                             const Progress& progress) {
    Message message;
    for (;;) {
        if (progress.cancelled()) return cancelled();
        const Received received = worker.pipe().receive(message, look_every_ms, patience.most_bytes);
        if (received == Received::too_large) return failure("{}", other_program);
        if (received == Received::message) return message;
        if (received == Received::closed) return ended(worker.process().let_end(), crash);
        if (Clock::now() > patience.until) return failure("{}", patience.late);
    }
}

std::string why_not_started() {
    const char* const gigabytes = std::getenv(gigabytes_name);
    if (gigabytes == nullptr) return "pliant-mesh does not start; run it by hand with --version to see why";
    return fmt::format("pliant-mesh does not start; {} is {}, and it needs about 0.3 to start", gigabytes_name,
                       gigabytes);
}

/// A new process identifies itself first.
Status greet(Worker& worker, const Progress& progress) {
    constexpr std::uint64_t most_bytes = 1000;
    const Patience patience{in_seconds(start_s), fmt::format("pliant-mesh did not start within {} s", start_s),
                            most_bytes};
    const Result<Message> hello = next_message(worker, patience, why_not_started(), progress);
    if (!hello) return tl::unexpected(hello.error());
    if (hello->kind != MessageKind::greeting || hello->bytes != mesher_greeting) return failure("{}", other_program);
    return {};
}

Error unpack_error(const std::string& bytes) {
    Unpacker in(bytes);
    Error error;
    unpack(in, error);
    return in.finished() ? error : Error{Cause::failed, "pliant-mesh answered with an error that cannot be read"};
}

void pass_on(const std::string& bytes, Progress& progress) {
    Unpacker in(bytes);
    const std::string stage = in.text();
    const double fraction = in.number<double>();
    if (in.finished()) progress.advance(stage, fraction);
}

/// The folder of the program, or of the shared library that contains this code.
std::filesystem::path folder_of_this_code() {
    Dl_info found{};
    if (::dladdr(reinterpret_cast<const void*>(&mesher_limits), &found) == 0 || found.dli_fname == nullptr) return {};
    const std::filesystem::path file = found.dli_fname;
    if (!file.has_parent_path()) return {};  // a program as it was typed, found on PATH
    std::error_code error;
    return std::filesystem::absolute(file, error).parent_path();
}

/// Possible paths of the program relative to a folder of programs or libraries (which may be two levels below lib).
std::vector<std::filesystem::path> mesher_near(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> paths{folder / "pliant-mesh"};
    for (const char* up : {"..", "../.."}) {
        paths.push_back(folder / up / "libexec/pliant/pliant-mesh");
        paths.push_back(folder / up / "bin/pliant-mesh");
    }
    return paths;
}

std::filesystem::path mesher_of(const std::filesystem::path& folder) {
    std::error_code error;
    for (const std::filesystem::path& path : mesher_near(folder)) {
        if (std::filesystem::is_regular_file(path, error)) return path;
    }
    return {};
}

/// That of the build tree that a folder is in: tests, benchmarks and Python modules run where they were built.
std::filesystem::path mesher_of_build(std::filesystem::path folder) {
    std::error_code error;
    for (;; folder = folder.parent_path()) {
        std::filesystem::path path = folder / "apps/pliant/pliant-mesh";
        if (std::filesystem::is_regular_file(folder / "CMakeCache.txt", error) &&
            std::filesystem::is_regular_file(path, error))
            return path;
        if (!folder.has_relative_path()) return {};
    }
}

}  // namespace

std::filesystem::path mesher_from(std::span<const std::filesystem::path> folders) {
    for (const std::filesystem::path& folder : folders) {
        if (!folder.is_absolute()) continue;  // the result must not depend on the current folder
        if (std::filesystem::path path = mesher_of(folder); !path.empty()) return path;
        if (std::filesystem::path path = mesher_of_build(folder.lexically_normal()); !path.empty()) return path;
    }
    return {};
}

std::filesystem::path mesher_on(std::string_view search_path) {
    while (!search_path.empty()) {
        const std::size_t end = std::min(search_path.find(':'), search_path.size());
        const std::filesystem::path folder = search_path.substr(0, end);
        search_path.remove_prefix(std::min(end + 1, search_path.size()));
        if (!folder.is_absolute()) continue;  // the result must not depend on the current folder
        if (std::filesystem::path path = mesher_of(folder); !path.empty()) return path;
    }
    return {};
}

Result<MesherLimits> mesher_limits() {
    const Result<double> seconds = environment_number(seconds_name, MesherLimits{}.seconds, longest_s);
    if (!seconds) return tl::unexpected(seconds.error());
    const double all = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
    const Result<double> gigabytes = environment_number(gigabytes_name, all / 1e9, most_gigabytes);
    if (!gigabytes) return tl::unexpected(gigabytes.error());
    return MesherLimits{*seconds, *gigabytes};
}

Result<std::filesystem::path> mesher_program() {
    namespace fs = std::filesystem;
    std::error_code error;
    if (const char* const named = std::getenv("PLIANT_MESH"); named != nullptr) {
        if (fs::is_regular_file(named, error)) return fs::path(named);
        return input_error("PLIANT_MESH names \"{}\", which is not a file; it must be the program pliant-mesh", named);
    }
    const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
    if (fs::path path = mesher_from(std::array{folder_of_this_code(), here}); !path.empty()) return path;
    if (const char* const search_path = std::getenv("PATH"); search_path != nullptr) {
        if (fs::path path = mesher_on(search_path); !path.empty()) return path;
    }
    return failure(
        "shapes and surfaces are meshed by the program pliant-mesh, which is not beside {} and not installed with a "
        "program of PATH; install it there, or set PLIANT_MESH to where it is",
        here.string());
}

Result<std::string> ask_mesher(MessageKind kind, const std::string& request, const std::string& crash,
                               Progress& progress) {
    if (auto known = remembered_answers().find(kind, request)) return std::move(*known);
    const Result<MesherLimits> found = mesher_limits();
    if (!found) return tl::unexpected(found.error());
    const MesherLimits limits = *found;
    std::unique_ptr<Worker> worker = idle_workers().take();
    if (worker == nullptr || !worker->pipe().send(kind, request)) {  // an idle process may have been killed
        Result<std::unique_ptr<Worker>> fresh = start_worker(limits);
        if (!fresh) return tl::unexpected(fresh.error());
        worker = std::move(*fresh);
        if (Status status = greet(*worker, progress); !status) return tl::unexpected(status.error());
        (void)worker->pipe().send(kind, request);  // if it dies now, the next message will tell
    }
    const Patience patience{
        in_seconds(limits.seconds),
        fmt::format("meshing took longer than {:g} s and was ended; take a larger mesh size, or more time ({})",
                    limits.seconds, seconds_name)};
    for (;;) {
        Result<Message> message = next_message(*worker, patience, crash, progress);
        if (!message) return tl::unexpected(message.error());
        if (message->kind == MessageKind::progress) {
            pass_on(message->bytes, progress);
            continue;
        }
        if (message->kind != MessageKind::answer && message->kind != MessageKind::error)
            return failure("pliant-mesh answered with something that cannot be read");
        idle_workers().give_back(std::move(worker));
        if (message->kind == MessageKind::error) return tl::unexpected(unpack_error(message->bytes));
        remembered_answers().keep(kind, request, message->bytes);
        return std::move(message->bytes);
    }
}

void remember_answers(std::size_t bytes) {
    remembered_answers().set_room(bytes);
}

}  // namespace pliant::mesh

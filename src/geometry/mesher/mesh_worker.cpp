#include "geometry/mesher/mesh_worker.hpp"

#include <dlfcn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
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
constexpr double start_s = 60;     // allows for loading Open CASCADE from a slow disk

double environment_number(const char* name, double otherwise) {
    const char* const text = std::getenv(name);
    if (text == nullptr) return otherwise;
    double value = 0;
    const auto read = std::from_chars(text, text + std::strlen(text), value);
    return read.ec == std::errc{} && *read.ptr == '\0' && value > 0 ? value : otherwise;
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

/// Waits for the next message, and checks for cancellation and timeout meanwhile.
Result<Message> next_message(Worker& worker, Clock::time_point until, const MesherLimits& limits,
                             const std::string& crash, const Progress& progress) {
    Message message;
    for (;;) {
        if (progress.cancelled()) return cancelled();
        const Received received = worker.pipe().receive(message, look_every_ms);
        if (received == Received::message) return message;
        if (received == Received::closed) return failure("{} ({})", crash, end_text(worker.process().let_end()));
        if (Clock::now() > until)
            return failure(
                "meshing took longer than {:g} s and was ended; take a larger mesh size, or more time "
                "(PLIANT_MESH_SECONDS)",
                limits.seconds);
    }
}

/// A new process identifies itself first.
Status greet(Worker& worker) {
    Progress silent;
    const MesherLimits limits{start_s, 0};
    const auto until =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(start_s));
    const Result<Message> hello = next_message(
        worker, until, limits, "pliant-mesh does not start; run it by hand with --version to see why", silent);
    if (!hello) return tl::unexpected(hello.error());
    if (hello->kind != MessageKind::greeting || hello->bytes != mesher_greeting)
        return failure("pliant-mesh is of another version than this program; install both together");
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

MesherLimits mesher_limits() {
    MesherLimits limits;
    limits.seconds = environment_number("PLIANT_MESH_SECONDS", limits.seconds);
    const double all = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
    limits.gigabytes = environment_number("PLIANT_MESH_GIGABYTES", all / 1e9);
    return limits;
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
    const MesherLimits limits = mesher_limits();
    std::unique_ptr<Worker> worker = idle_workers().take();
    if (worker == nullptr || !worker->pipe().send(kind, request)) {  // an idle process may have been killed
        Result<std::unique_ptr<Worker>> fresh = start_worker(limits);
        if (!fresh) return tl::unexpected(fresh.error());
        worker = std::move(*fresh);
        if (Status status = greet(*worker); !status) return tl::unexpected(status.error());
        (void)worker->pipe().send(kind, request);  // if it dies now, the next message will tell
    }
    const auto until =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limits.seconds));
    for (;;) {
        Result<Message> message = next_message(*worker, until, limits, crash, progress);
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

// Sends Ctrl-C and SIGTERM to the real program, at moments recognised by its output.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_processes.hpp"

using namespace pliant;
namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr auto patience = 240s;  // for a heavily loaded machine
const std::string finger = "examples/tutorial/finger.toml";
const std::string linear = "mesh.order=1";

bool wait_for(const std::function<bool()>& sign) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < end) {
        if (sign()) return true;
        std::this_thread::sleep_for(2ms);
    }
    return false;
}

/// `pliant` with standard error on a terminal, so that it shows its progress bar.
class Program {
public:
    explicit Program(std::vector<std::string> words) {
        words.insert(words.begin(), PLIANT_PROGRAM);
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        int terminal = -1;
        REQUIRE(::openpty(&master_, &terminal, nullptr, nullptr, nullptr) == 0);
        process_ = ::fork();
        REQUIRE(process_ >= 0);
        if (process_ == 0) {
            ::dup2(terminal, STDERR_FILENO);
            ::dup2(::open("/dev/null", O_WRONLY), STDOUT_FILENO);
            ::close(master_);
            ::execv(arguments[0], arguments.data());
            ::_exit(127);
        }
        ::close(terminal);
    }
    ~Program() {
        if (!ended()) ::kill(process_, SIGKILL);
        (void)exit_status();
        ::close(master_);
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    void send(int signal) const { ::kill(process_, signal); }
    bool says(const std::string& text) {
        listen();
        return said_.find(text) != std::string::npos;
    }
    /// True from one percent on; which percentage is shown first depends on the speed of the computer.
    bool has_converged_steps() {
        listen();
        static const std::regex bar(R"((simulate|finding inputs) \[[= ]*\] +[1-9][0-9]? %)");
        return std::regex_search(said_, bar);
    }
    /// Whether it has begun (before, it is a copy of this test) and has a handler for this signal, which would end it.
    [[nodiscard]] bool handles(int signal) const {
        std::ifstream file(fmt::format("/proc/{}/status", process_));
        bool begun = false;
        for (std::string line; std::getline(file, line);) {
            if (line == "Name:\tpliant") begun = true;
            if (line.rfind("SigCgt:", 0) != 0) continue;
            return begun && (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0;
        }
        return false;
    }
    /// Whether it has started the program of this name.
    [[nodiscard]] bool has_child(const std::string& name) const { return !test::children_of(process_, name).empty(); }
    bool ended() {
        listen();  // its output must be read, or it blocks
        if (!ended_ && ::waitpid(process_, &status_, WNOHANG) == process_) ended_ = true;
        return ended_;
    }
    /// Waits for the end; -1: killed by a signal, or it never ended.
    int exit_status() {
        const bool in_time = wait_for([&] { return ended(); });
        listen();
        return in_time && WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
    }
    /// The last line, without erased text.
    [[nodiscard]] std::string last_line() const {
        const std::string text = said_.substr(0, said_.find_last_not_of("\r\n") + 1);
        return text.substr(text.find_last_of("\nK") + 1);
    }

private:
    void listen() {
        pollfd wait{master_, POLLIN, 0};
        char buffer[4096];
        while (::poll(&wait, 1, 0) > 0 && (wait.revents & POLLIN) != 0) {
            const ssize_t count = ::read(master_, buffer, sizeof buffer);
            if (count <= 0) return;
            said_.append(buffer, static_cast<std::size_t>(count));
        }
    }

    pid_t process_ = -1;
    int master_ = -1, status_ = 0;
    bool ended_ = false;
    std::string said_;
};

nlohmann::json summary_in(const fs::path& folder) {
    return nlohmann::json::parse(read_file(folder / "summary.json").value());
}

}  // namespace

TEST_CASE("an interrupted simulation writes complete results of the steps that converged") {
    for (const auto& [signal, times] : std::vector<std::pair<int, int>>{{SIGINT, 1}, {SIGTERM, 1}, {SIGTERM, 2}}) {
        CAPTURE(signal);
        CAPTURE(times);  // as `timeout` does: at once
        const test::Folder folder("interrupt");
        const fs::path out = folder / "out";
        Program program({"simulate", finger, "-o", out, "--steps", "20000", "--set", linear});
        REQUIRE(wait_for([&] { return program.has_converged_steps(); }));
        for (int i = 0; i < times; ++i) program.send(signal);
        CHECK(program.exit_status() == 1);
        REQUIRE(fs::exists(out / "summary.json"));
        const auto summary = summary_in(out);
        const std::size_t kept = summary["steps"].size();
        CHECK(summary["converged"] == false);
        CHECK(summary["message"] == fmt::format("cancelled at step {} of 20000", kept + 1));
        CHECK(program.last_line() == fmt::format("{}: cancelled at step {} of 20000", finger, kept + 1));
        CHECK(kept > 0);
        CHECK(fs::exists(out / fmt::format("frames/frame_{:04}.vtu", kept)));
        CHECK(fs::exists(out / "report.html"));
        CHECK_FALSE(fs::exists(out / "pictures"));
        CHECK_FALSE(fs::exists(folder / "out.partial"));
    }
}

TEST_CASE("an interrupted search for inputs replaces older results by the waypoints found so far") {
    const test::Folder folder("interrupt");
    const std::string arm = "examples/inverse/writing_arm/robot.toml";
    const fs::path out = folder / "out";
    fs::create_directories(out);
    REQUIRE(write_file(out / "summary.json", "older"));
    const std::string word = read_file("examples/inverse/writing_arm/word.csv").value();
    const std::string points = word.substr(word.find('\n') + 1);
    std::string table = "x,y,z\n";
    for (int k = 0; k < 40; ++k) table += points;
    REQUIRE(write_file(folder / "long.csv", table));
    const auto wanted = std::count(table.begin(), table.end(), '\n') - 1;
    Program program(
        {"inverse", arm, "-o", out, "--set", fmt::format("goal.word.path=\"{}\"", (folder / "long.csv").string())});
    REQUIRE(wait_for([&] { return program.has_converged_steps(); }));
    program.send(SIGINT);
    CHECK(program.exit_status() == 1);
    const auto found = nlohmann::json::parse(read_file(out / "inverse.json").value());
    const auto& waypoints = found["waypoints"];
    const auto reached =
        std::count_if(waypoints.begin(), waypoints.end(), [](const auto& at) { return at["reached"] == true; });
    CHECK(reached > 0);
    CHECK(reached < wanted);
    const std::string message = found["message"];
    const auto cancelled_at = [&](std::ptrdiff_t k) {
        return message == fmt::format("cancelled at waypoint {} of {}", k, wanted);
    };
    // A waypoint that is reached is searched on for the least price, and may be cancelled there too.
    CHECK((cancelled_at(reached + 1) ||
           (waypoints.size() == static_cast<std::size_t>(reached) && cancelled_at(reached))));
    CHECK(program.last_line() == arm + ": " + message);
    if (!waypoints.back()["reached"])
        CHECK(waypoints.back()["reasons"] == nlohmann::json{"the search was cancelled here"});
    CHECK(summary_in(out)["steps"].size() == static_cast<std::size_t>(reached));
    CHECK_FALSE(fs::exists(out / "pictures"));
    CHECK_FALSE(fs::exists(folder / "out.partial"));
}

TEST_CASE("interrupted while meshing, a command writes nothing and prints one line") {
    for (const int signal : {SIGINT, SIGTERM}) {
        for (const std::string command : {"simulate", "mesh"}) {
            CAPTURE(signal);
            CAPTURE(command);
            const test::Folder folder("interrupt");
            Program program({command, finger, "-o", folder / "out.vtu", "--set", "mesh.size=0.3 mm"});
            REQUIRE(wait_for([&] { return program.has_child("pliant-mesh"); }));
            program.send(signal);
            CHECK(program.exit_status() == 1);
            CHECK(program.last_line() == "cancelled");
            CHECK(fs::is_empty(folder.path()));
        }
    }
}

TEST_CASE("interrupted while drawing, a simulation has written everything except the pictures") {
    const test::Folder folder("interrupt");
    const fs::path out = folder / "out";
    Program program({"simulate", finger, "-o", out, "--steps", "2", "--set", linear, "--pictures", "all",
                     "--picture-size", "8000x5000"});
    REQUIRE(wait_for([&] { return fs::exists(folder / "out.partial/robot.glb"); }));
    program.send(SIGTERM);
    CHECK(program.exit_status() == 1);
    CHECK(program.last_line() == finger + ": cancelled before all pictures were drawn; the other results are written");
    REQUIRE(fs::exists(out / "summary.json"));
    CHECK(summary_in(out)["converged"] == true);
    CHECK(summary_in(out)["steps"].size() == 2);
    CHECK(fs::exists(out / "report.html"));
    CHECK_FALSE(fs::exists(out / "pictures"));
    CHECK_FALSE(fs::exists(folder / "out.partial"));
}

TEST_CASE("a second signal while files are written leaves no partial results") {
    const test::Folder folder("interrupt");
    const fs::path out = folder / "out";
    bool put_away = false;
    for (int attempt = 0; attempt < 5 && !put_away; ++attempt) {  // it may finish before the second signal
        Program program({"simulate", finger, "-o", out, "--steps", "300", "--set", linear});
        REQUIRE(wait_for([&] { return fs::exists(folder / "out.partial/frames/frame_0001.vtu"); }));
        program.send(SIGTERM);
        std::this_thread::sleep_for(50ms);
        program.send(SIGTERM);
        CHECK(program.exit_status() == 1);
        CHECK_FALSE(fs::exists(folder / "out.partial"));
        put_away = !fs::exists(out);
        if (put_away) CHECK(program.last_line() == "cancelled");
        if (!put_away) CHECK(summary_in(out)["steps"].size() == 300);
        fs::remove_all(out);
    }
    CHECK(put_away);
}

TEST_CASE("interrupted slicing leaves neither a job nor a partial file") {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        CAPTURE(signal);
        const test::Folder folder("interrupt");
        Program program(
            {"slice", "examples/cable_gripper/gripper.toml", "--printer", "tower", "-o", folder / "job.zip"});
        REQUIRE(wait_for([&] { return fs::exists(folder / "job.zip.partial"); }));
        program.send(signal);
        CHECK(program.exit_status() == 1);
        CHECK(program.last_line() == "cancelled");
        CHECK(fs::is_empty(folder.path()));
    }
}

TEST_CASE("interrupted while it plans or exports, a command writes nothing and prints one line") {
    const test::Folder folder("interrupt");
    const std::string job = folder / "job.zip";
    Program slice({"slice", "semi-flex=examples/gripper_picks_up/egg.stl", "--printer", "tower", "-o", job, "-q"});
    REQUIRE(slice.exit_status() == 0);
    for (const int signal : {SIGINT, SIGTERM}) {
        CAPTURE(signal);
        Program plan({"plan", job, "--optimise-spray", "0.95", "-o", folder / "plan.png"});
        REQUIRE(wait_for([&] { return plan.handles(signal); }));
        plan.send(signal);
        CHECK(plan.exit_status() == 1);
        CHECK(plan.last_line() == "cancelled");
        Program vats({"export", job, "--as", "vats", "-o", folder / "vats"});
        REQUIRE(wait_for([&] { return vats.handles(signal); }));
        vats.send(signal);
        CHECK(vats.exit_status() == 1);
        CHECK(vats.last_line() == "cancelled");
        std::vector<std::string> left;
        for (const auto& entry : fs::directory_iterator(folder.path())) left.push_back(entry.path().filename());
        CHECK(left == std::vector<std::string>{"job.zip"});
    }
}

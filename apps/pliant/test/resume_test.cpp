// A run with checkpoints that is killed repeatedly ends with the same results as an uninterrupted one.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/process.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
namespace fs = std::filesystem;

namespace {

constexpr int kills = 10;

/// A bar that takes some ten milliseconds a step.
const std::string bar = R"(
    name = "bar"
    length_unit = "mm"
    material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45 }
    mesh = { order = 2, size = "4 mm" }
    body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [80, 10, 10]] } }]
    fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
    marker = [{ name = "tip", point = [80, 5, 5] }]
    cable = [{ name = "flexor", points = [[0, 5, 9], [40, 5, 9], [80, 5, 9]], target.shortening = "20 mm" }]
    program = { steps = 80 }
)";

pid_t started(std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    const auto process = start_process(PLIANT_PROGRAM, words, {});
    REQUIRE(process);
    return *process;
}

pid_t started(const fs::path& robot, const fs::path& results, const std::vector<std::string>& more) {
    return started({"simulate", robot.string(), "-o", results.string(), "--pictures", "none", "-q"}, more);
}

/// A process that does not go on until the end of the scope.
class Halted {
public:
    explicit Halted(pid_t process) : process_(process) { ::kill(process_, SIGSTOP); }
    Halted(const Halted&) = delete;
    Halted& operator=(const Halted&) = delete;
    ~Halted() { ::kill(process_, SIGCONT); }

private:
    pid_t process_;
};

int exit_status(pid_t process) {
    int status = 0;
    REQUIRE(::waitpid(process, &status, 0) == process);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Size of the checkpoint, bytes; 0 before the first one is complete.
std::uintmax_t kept(const fs::path& results) {
    std::error_code none;
    if (!fs::exists(results.string() + ".checkpoint/state", none)) return 0;
    const std::uintmax_t size = fs::file_size(results.string() + ".checkpoint/steps", none);
    return none ? 0 : size;
}

/// Waits until more than `bytes` are kept, for 20 s at most.
void wait_beyond(const fs::path& results, std::uintmax_t bytes) {
    for (int wait = 0; wait < 20000 && kept(results) <= bytes; ++wait)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// The whole file, without the column of wall times.
std::string table(const fs::path& file) {
    std::ifstream in(file);
    std::string line, out;
    std::getline(in, line);
    int wall = -1, column = 0;
    std::string cell;
    for (const char c : line + ',') {
        if (c != ',') {
            cell += c;
            continue;
        }
        if (cell.find("wall") != std::string::npos) wall = column;
        ++column;
        cell.clear();
    }
    while (std::getline(in, line)) {
        column = 0;
        for (const char c : line + ',') {
            if (column != wall) out += c;
            if (c == ',') ++column;
        }
        out += '\n';
    }
    return out;
}

}  // namespace

TEST_CASE("a run that is killed and resumed ten times ends with the same results") {
    const test::Folder folder;
    const fs::path robot = folder / "bar.toml", whole = folder / "whole", pieces = folder / "pieces";
    REQUIRE(write_file(robot, bar));
    CHECK(exit_status(started(robot, whole, {})) == 0);
    int killed = 0;
    std::vector<std::string> options{"--checkpoint-every", "1"};
    for (int k = 0; k < kills; ++k) {
        const pid_t process = started(robot, pieces, options);
        // Kills it once it has advanced, at a random moment within the next steps.
        const std::uintmax_t before = kept(pieces);
        wait_beyond(pieces, before);
        std::this_thread::sleep_for(std::chrono::milliseconds(3 * k));
        ::kill(process, SIGKILL);
        if (exit_status(process) == -SIGKILL) ++killed;
        options = {"--resume"};
        if (fs::exists(pieces)) break;  // it was quicker
    }
    CHECK(killed >= 3);
    if (!fs::exists(pieces)) CHECK(exit_status(started(robot, pieces, options)) == 0);
    CHECK_FALSE(fs::exists(pieces.string() + ".checkpoint"));
    for (const char* file : {"markers.csv", "iterations.csv", "robot.glb", "frames/frame_0080.vtu"}) {
        CAPTURE(file);
        CHECK(read_file(pieces / file).value() == read_file(whole / file).value());
    }
    CHECK(table(pieces / "steps.csv") == table(whole / "steps.csv"));
    CHECK(table(whole / "steps.csv").size() > 1000);
}

TEST_CASE("resuming without a checkpoint, or from one of another robot, is refused before anything is solved") {
    const test::Folder folder;
    const fs::path robot = folder / "bar.toml", results = folder / "out";
    REQUIRE(write_file(robot, bar));
    CHECK(exit_status(started(robot, results, {"--resume"})) == 2);
    const pid_t process = started(robot, results, {"--checkpoint-every", "1"});
    wait_beyond(results, 0);
    const fs::path state = results.string() + ".checkpoint/state";
    const std::string first = read_file(state).value();  // perhaps the rest state alone, which is nothing to lose
    for (int wait = 0; wait < 20000 && read_file(state).value() == first; ++wait)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(process, SIGKILL);
    CHECK(exit_status(process) == -SIGKILL);
    const std::string last = read_file(state).value();
    CHECK(exit_status(started(robot, results, {"--checkpoint-every", "1"})) == 2);  // --resume is forgotten
    CHECK(read_file(state).value() == last);
    CHECK(exit_status(started(robot, results, {"--resume", "--set", "program.tolerance=1e-5"})) == 2);
    const std::string plain = std::string(PLIANT_PROGRAM) + " simulate " + robot.string() + " -o " + results.string() +
                              " --pictures none -q 2>" + (folder / "said").string();
    CHECK(std::system(plain.c_str()) == 0);  // keeps no checkpoint, and leaves that one
    CHECK(read_file(state).value() == last);
    CHECK(read_file(folder / "said")
              .value()
              .find("note: " + results.string() + ".checkpoint holds this run up to step ") != std::string::npos);
    REQUIRE(write_file(robot, bar + "\n# changed\n"));
    CHECK(exit_status(started(robot, results, {"--resume"})) == 2);
}

TEST_CASE("a second run into the folder of one at work is refused, and the first ends as if alone") {
    const test::Folder folder;
    const fs::path robot = folder / "bar.toml", whole = folder / "whole", results = folder / "out";
    REQUIRE(write_file(robot, bar));
    CHECK(exit_status(started(robot, whole, {})) == 0);
    const pid_t first = started(robot, results, {"--checkpoint-every", "1"});
    wait_beyond(results, 0);
    {
        const Halted halted(first);
        CHECK(exit_status(started(robot, results, {"--checkpoint-every", "1", "--set", "program.steps=4"})) == 2);
        CHECK(exit_status(started(robot, results, {"--resume"})) == 2);
    }
    CHECK(exit_status(first) == 0);
    CHECK_FALSE(fs::exists(results.string() + ".checkpoint"));
    CHECK(read_file(results / "markers.csv").value() == read_file(whole / "markers.csv").value());
}

TEST_CASE("a second search of a workspace into the same folder is refused; a killed one is resumed") {
    const test::Folder folder;
    const fs::path robot = folder / "bar.toml";
    REQUIRE(write_file(robot, bar));
    const auto search = [&](const std::string& results, const std::vector<std::string>& more) {
        return started({"workspace", robot.string(), "-o", (folder / results).string(), "-q", "--side", "12", "--set",
                        "cable.flexor.range=['0 mm', '20 mm']"},
                       more);
    };
    CHECK(exit_status(search("whole", {})) == 0);
    const pid_t first = search("out", {});
    const fs::path origin = folder / "out.checkpoint" / "origin";
    for (int wait = 0; wait < 20000 && !fs::exists(origin); ++wait)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    {
        const Halted halted(first);
        CHECK(exit_status(search("out", {"--set", "material.soft.youngs_modulus=2 MPa"})) == 2);
        CHECK(exit_status(search("out", {"--resume"})) == 2);
    }
    ::kill(first, SIGKILL);
    CHECK(exit_status(first) == -SIGKILL);
    CHECK(exit_status(search("out", {"--resume"})) == 0);
    CHECK(read_file(folder / "out/workspace.csv").value() == read_file(folder / "whole/workspace.csv").value());
    CHECK_FALSE(fs::exists(folder / "out.checkpoint"));
}

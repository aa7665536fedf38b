#include "base/core/checkpoint_folder.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
namespace fs = std::filesystem;

namespace {

/// A process that has the lock of a folder until it is killed.
class OtherProcess {
public:
    explicit OtherProcess(const fs::path& folder) {
        std::array<int, 2> ready{};
        REQUIRE(::pipe(ready.data()) == 0);
        process_ = ::fork();
        if (process_ == 0) {
            const auto kept = CheckpointFolder::create(folder, "mark");
            const char told = kept && kept->write("mark", "") ? 'y' : 'n';
            (void)!::write(ready[1], &told, 1);
            for (;;) ::pause();
        }
        char told = 0;
        REQUIRE(::read(ready[0], &told, 1) == 1);
        CHECK(told == 'y');
        ::close(ready[0]);
        ::close(ready[1]);
    }
    OtherProcess(const OtherProcess&) = delete;
    OtherProcess& operator=(const OtherProcess&) = delete;
    ~OtherProcess() { kill(); }
    void kill() {
        if (process_ <= 0) return;
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
        process_ = 0;
    }

private:
    pid_t process_ = 0;
};

template <class T>
std::string message_of(const Result<T>& result) {
    return result ? "" : result.error().message;
}

}  // namespace

TEST_CASE("a folder in which another process works is refused and stays whole, until that process is killed") {
    const test::Folder folder;
    OtherProcess other(folder / "kept");
    const std::string refusal = (folder / "kept").string() + ": another process is at work on this checkpoint";
    CHECK(message_of(CheckpointFolder::create(folder / "kept", "mark")).starts_with(refusal));
    CHECK(message_of(CheckpointFolder::open(folder / "kept", "mark")).starts_with(refusal));
    CHECK(CheckpointFolder::released(folder / "kept", "mark").remove());
    CHECK(fs::exists(folder / "kept/mark"));
    other.kill();
    CHECK(CheckpointFolder::open(folder / "kept", "mark"));
    const auto kept = CheckpointFolder::create(folder / "kept", "mark");
    REQUIRE(kept);
    CHECK_FALSE(fs::exists(folder / "kept/mark"));
    CHECK(kept->remove());
    CHECK_FALSE(fs::exists(folder / "kept"));
    CHECK(kept->remove());
}

TEST_CASE("a folder with other files is refused; one that a killed process has just begun is not") {
    const test::Folder folder;
    fs::create_directories(folder / "begun");
    REQUIRE(write_file(folder / "begun/lock", ""));
    CHECK(CheckpointFolder::create(folder / "begun", "mark"));
    REQUIRE(write_file(folder / "begun/mine", "mine"));
    CHECK(message_of(CheckpointFolder::create(folder / "begun", "mark")) ==
          (folder / "begun").string() + ": is there already, and is not a checkpoint; move it away");
    CHECK(CheckpointFolder::released(folder / "begun", "mark").remove());
    CHECK(fs::exists(folder / "begun/mine"));
    CHECK_FALSE(CheckpointFolder::create(folder / "begun/mine", "mark"));
    CHECK_FALSE(CheckpointFolder::open(folder / "none", "mark"));
    CHECK_FALSE(fs::exists(folder / "none"));
}

TEST_CASE("files of a checkpoint are replaced whole, and what a killed process left is written over") {
    const test::Folder folder;
    const auto kept = CheckpointFolder::create(folder / "kept", "mark");
    REQUIRE(kept);
    REQUIRE(write_file(aside_of(folder / "kept/state"), "half a state, longer than the next"));
    REQUIRE(kept->write("state", "one"));
    REQUIRE(kept->write("state", "two"));
    CHECK(read_file(folder / "kept/state").value() == "two");
    CHECK_FALSE(fs::exists(aside_of(folder / "kept/state")));
    CHECK(kept->sync("state"));
    CHECK_FALSE(kept->sync("none"));
}

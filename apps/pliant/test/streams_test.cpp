// Standard streams that are closed or full, limits of file size, and two programs that write one file.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
namespace fs = std::filesystem;

namespace {

const std::string program = PLIANT_PROGRAM;
const std::string slice = program + " slice examples/tutorial/finger.toml --printer tower --layer '100 um' -q -o ";

/// Exit status of a line of the shell.
int status_of(const std::string& line) {
    const int ended = std::system(line.c_str());
    REQUIRE(WIFEXITED(ended));
    return WEXITSTATUS(ended);
}

}  // namespace

TEST_CASE("an error has its status although standard error is closed or full") {
    for (const char* where : {"2>&-", "2>/dev/full", "<&- >&- 2>&-"}) {
        CAPTURE(std::string(where));
        CHECK(status_of(program + " simulate none.toml " + where) == 2);
    }
    CHECK(status_of(program + " version >&- 2>&-") == 1);
    CHECK(status_of(program + " version 2>&- >/dev/null") == 0);
}

TEST_CASE("nothing that is printed gets into a file that takes the place of a closed standard output") {
    const test::Folder folder("streams");
    const std::string job = folder / "job.zip";
    // The summary cannot be printed, which is told by the status; the job is whole.
    CHECK(status_of(program + " slice examples/tutorial/finger.toml --printer tower --layer '100 um' -o " + job +
                    " >&- 2>/dev/null") == 1);
    CHECK(status_of(program + " check " + job + " -q") == 0);
    // A virtual print comes to its end, with its records.
    CHECK(status_of(program + " print " + job + " --twin -o " + (folder / "r.json").string() + " >&- 2>&-") == 0);
    CHECK(fs::exists(folder / "r.json"));
}

TEST_CASE("a limit of file size is an error like a full disk") {
    const test::Folder folder("streams");
    CHECK(status_of("ulimit -f 4; " + slice + (folder / "job.zip").string() + " 2>/dev/null") == 1);
    CHECK(fs::is_empty(folder.path()));
}

TEST_CASE("of two programs that write one job the second is refused, or comes later") {
    const test::Folder folder("streams");
    const std::string job = folder / "job.zip";
    for (int round = 0; round < 3; ++round) {
        const int status = status_of(slice + job + " 2>/dev/null & first=$!; " + slice + job +
                                     " 2>/dev/null; second=$?; wait $first; exit $((10 * $? + second))");
        CHECK((status == 0 || status == 1 || status == 10));
        CHECK(status_of(program + " check " + job + " -q") == 0);
        CHECK_FALSE(fs::exists(job + ".partial"));
    }
}

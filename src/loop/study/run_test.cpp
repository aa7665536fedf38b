#include "loop/study/run.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <set>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_processes.hpp"
#include "loop/study/folder.hpp"

using namespace pliant;
using namespace pliant::study;
namespace fs = std::filesystem;

namespace {

/// x = 0, 1, ...; the program of test_rows.cpp squares x, or fails as `kind` says at x = 3.
Plan squares(const std::string& kind, int rows = 8) {
    Plan plan;
    plan.study = "squares";
    plan.study_file = "squares.toml";
    plan.version = "1";
    plan.fingerprint = "0123456789abcdef";
    plan.command = {"square", kind};
    plan.keys = {{"x", "x", "", "", true}};
    plan.results = {{"square", "square", 7}};
    for (int x = 0; x < rows; ++x) plan.rows.push_back({std::to_string(x)});
    plan.rows_per_chunk = 3;
    return plan;
}

RunSettings settings(const Plan& plan, int jobs = 2) {
    return {.worker = {PLIANT_TEST_ROWS, {}}, .jobs = jobs, .chunks = all_chunks(plan), .place = ""};
}

Result<RunAccount> run(const Plan& plan, const fs::path& folder, const RunSettings& how) {
    Progress silent;
    return run_rows(plan, folder, how, silent);
}

Collected collected(const Plan& plan, const fs::path& folder) {
    auto found = collect(plan, folder);
    REQUIRE_MESSAGE(found, (found ? "" : found.error().message));
    return *found;
}

/// Checks that all rows except `except` are recorded with their squares, once each.
void check_squares(const Plan& plan, const Collected& found, std::size_t except = 1000000) {
    CHECK(found.doubled == 0);
    CHECK(found.damaged == 0);
    CHECK(found.recorded() == plan.rows.size());
    for (std::size_t row = 0; row < plan.rows.size(); ++row) {
        REQUIRE(found.rows[row]);
        CHECK(found.rows[row]->done == (row != except));
        if (row != except) CHECK(found.rows[row]->values == std::vector{static_cast<double>(row * row)});
    }
}

/// Runs a study in which row 3 fails, and returns the recorded reason.
std::string reason_of_row_3(Plan plan) {
    const pliant::test::Folder folder("study");
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    const auto account = run(plan, folder / "s", settings(plan));
    REQUIRE_MESSAGE(account, (account ? "" : account.error().message));
    const Collected found = collected(plan, folder / "s");
    check_squares(plan, found, 3);
    return found.rows[3]->reason;
}

class StopAfter final : public Progress {
public:
    explicit StopAfter(double share) : share_(share) {}
    void advance(std::string_view, double fraction) override { reached_ = reached_ || fraction >= share_; }
    [[nodiscard]] bool cancelled() const override { return reached_; }

private:
    double share_;
    bool reached_ = false;
};

}  // namespace

TEST_CASE("rows run in parallel, each once, several in one process") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("plain", 40);
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    const auto account = run(plan, folder / "s", settings(plan, 3));
    REQUIRE(account);
    CHECK(account->rows == 40);
    const Collected found = collected(plan, folder / "s");
    check_squares(plan, found);
    CHECK(found.tasks.size() == plan.chunk_count());
    const auto again = run(plan, folder / "s", settings(plan));
    REQUIRE(again);
    CHECK(again->rows == 0);
}

TEST_CASE("a task takes its own chunks first, then those after and before them") {
    Plan plan;
    plan.rows.resize(9);
    plan.rows_per_chunk = 2;
    using Chunks = std::vector<std::size_t>;
    CHECK(chunks_from(plan, 3, 1, false) == Chunks{3});
    CHECK(chunks_from(plan, 3, 4, false) == Chunks{3, 4});
    CHECK(chunks_from(plan, 3, 1, true) == Chunks{3, 4, 0, 1, 2});
}

TEST_CASE("an error in a row fails only that row, with its reason") {
    CHECK(reason_of_row_3(squares("fail")) == "finger.toml: step 4: no equilibrium");
    CHECK(reason_of_row_3(squares("silent")) == "the command printed no JSON");
    CHECK(reason_of_row_3(squares("crash")) == "crashed (signal 11: Segmentation fault)");
    CHECK(reason_of_row_3(squares("end")) == "crashed (exit status 7)");
    CHECK(reason_of_row_3(squares("killed")) == "was killed 3 times (signal 9: Killed); was there too little memory?");
}

TEST_CASE("a row that takes too long is ended") {
    Plan plan = squares("hang");
    plan.row_limit_s = 0.5;
    CHECK(reason_of_row_3(plan) == "took longer than 0.5 s");
}

TEST_CASE("a missing result stops a study at its first row, with the nearest name") {
    const pliant::test::Folder folder("study");
    Plan plan = squares("plain");
    plan.results[0].path = "sqare";
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    const auto account = run(plan, folder / "s", settings(plan));
    REQUIRE_FALSE(account);
    CHECK(account.error().cause == Cause::input);
    CHECK(account.error().message ==
          "squares.toml:7: result.square: the result has no \"sqare\"; did you mean \"square\"?: there is pid and "
          "square");
    CHECK(collected(plan, folder / "s").recorded() == 0);
}

TEST_CASE("a study whose first rows all fail because of their input stops, and --resume runs the others") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("wrong");
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    const auto account = run(plan, folder / "s", settings(plan, 1));
    REQUIRE_FALSE(account);
    CHECK(account.error().cause == Cause::input);
    CHECK(account.error().message ==
          "squares.toml: all of the first 3 rows fail because of their input, row 2 by: finger.toml:3: stepps: unknown "
          "key; the study stops here, and --resume runs the other rows in spite of this");
    CHECK(collected(plan, folder / "s").recorded() == 3);
    REQUIRE(run(plan, folder / "s", settings(plan)));
    CHECK(collected(plan, folder / "s").failed == 8);
}

TEST_CASE("rows that fail because of their own values do not stop a study") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("wrong-first");
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    REQUIRE(run(plan, folder / "s", settings(plan)));
    const Collected found = collected(plan, folder / "s");
    CHECK(found.failed == 2);
    CHECK(found.done == 6);
}

TEST_CASE("a program that cannot serve rows is an error at once") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("plain");
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    RunSettings how = settings(plan);
    how.worker.program = "/bin/false";
    const auto account = run(plan, folder / "s", how);
    REQUIRE_FALSE(account);
    CHECK(account.error().message == "/bin/false: worker exited before its first row (exit status 1)");
}

TEST_CASE("a cancelled study resumes where it was, and leaves no processes") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("slow", 60);
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    StopAfter stop(0.3);
    const auto first = run_rows(plan, folder / "s", settings(plan), stop);
    REQUIRE_FALSE(first);
    CHECK(first.error().cause == Cause::cancelled);
    CHECK(pliant::test::children_of(::getpid(), "pliant_test_row").empty());
    const Collected part = collected(plan, folder / "s");
    CHECK(part.recorded() >= 18);
    CHECK(part.recorded() < 60);
    CHECK_FALSE(open_folder(plan, folder / "s", Begin::fresh));
    REQUIRE(open_folder(plan, folder / "s", Begin::resume));
    const auto second = run(plan, folder / "s", settings(plan));
    REQUIRE(second);
    CHECK(second->rows == 60 - part.recorded());
    check_squares(plan, collected(plan, folder / "s"));
}

TEST_CASE("killed again and again at any time, a study loses and repeats no row") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("slow", 120);
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    int kills = 0;
    for (int turn = 0; turn < 40; ++turn) {
        const pid_t leader = ::fork();
        REQUIRE(leader >= 0);
        if (leader == 0) {
            Progress silent;
            ::_exit(run_rows(plan, folder / "s", settings(plan), silent) ? 0 : 1);
        }
        ::usleep(static_cast<useconds_t>(40000 + 7919 * turn % 90000));
        ::kill(leader, SIGKILL);
        int status = 0;
        ::waitpid(leader, &status, 0);
        if (WIFEXITED(status)) break;
        ++kills;
    }
    CHECK(kills > 3);
    REQUIRE(run(plan, folder / "s", settings(plan)));
    check_squares(plan, collected(plan, folder / "s"));
}

TEST_CASE("several processes share the chunks of one folder; others take over those of a killed one") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("slow", 60);
    std::vector<pid_t> ranks;
    for (std::size_t rank = 0; rank < 3; ++rank) {
        const pid_t process = ::fork();
        REQUIRE(process >= 0);
        if (process == 0) {
            const auto there = open_folder(plan, folder / "s", Begin::resume);
            RunSettings how = settings(plan, 1);
            how.chunks = all_chunks(plan, rank, 3);
            ::_exit(there && run(*there, folder / "s", how) ? 0 : 1);
        }
        ranks.push_back(process);
    }
    ::usleep(150000);
    ::kill(ranks[1], SIGKILL);  // the other ranks take over its rows
    for (const pid_t rank : ranks) {
        int status = 0;
        ::waitpid(rank, &status, 0);
        if (rank != ranks[1]) CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
    }
    check_squares(plan, collected(plan, folder / "s"));
}

TEST_CASE("a row that ends its whole task several times is recorded as failed") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("plain");
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    {
        auto file = RecordFile::claim(plan, folder / "s", 1);
        REQUIRE((file && *file));
        for (int k = 0; k < 4; ++k) REQUIRE((*file)->append(begun_line(3)));
        for (int k = 0; k < 3; ++k) REQUIRE((*file)->append(begun_line(4)));
    }
    RunSettings how = settings(plan);
    how.most_begun = 4;
    REQUIRE(run(plan, folder / "s", how));
    const Collected found = collected(plan, folder / "s");
    check_squares(plan, found, 3);
    CHECK(found.rows[3]->reason == "4 tasks ended while it ran; was there too little memory or time?");
}

TEST_CASE("a folder with another study or other files is not changed") {
    const pliant::test::Folder folder("study");
    Plan plan = squares("plain");
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    plan.fingerprint = "ffffffffffffffff";
    const auto other = open_folder(plan, folder / "s", Begin::resume);
    REQUIRE_FALSE(other);
    CHECK(other.error().message.ends_with(
        "s: holds another study, or this one before its files were changed; choose another folder with -o"));
    plan.version = "2";
    const auto newer = open_folder(plan, folder / "s", Begin::resume);
    REQUIRE_FALSE(newer);
    CHECK(newer.error().message.find("was begun with pliant 1, and this is 2") != std::string::npos);
    REQUIRE(write_file(folder / "notes.txt", "mine"));
    CHECK_FALSE(open_folder(plan, folder.path(), Begin::fresh));
    // No row has run, so the first study counts as a mistake and is replaced.
    CHECK(open_folder(plan, folder / "s", Begin::fresh));
    CHECK(load_plan(folder / "s")->version == "2");
    const auto leader = lead(folder / "s");
    REQUIRE(leader);
    CHECK_FALSE(lead(folder / "s"));
}

TEST_CASE("the rows of a copied study run where its file is now") {
    const pliant::test::Folder folder("study");
    const fs::path before = folder / "before", after = folder / "after";
    fs::create_directories(before);
    Plan plan = squares("plain");
    plan.folder = before;
    plan.study_file = (before / "squares.toml").string();
    REQUIRE(open_folder(plan, before / "s", Begin::fresh));
    fs::rename(before, after);
    const auto old = load_plan(after / "s");
    REQUIRE(old);
    const auto nowhere = run(*old, after / "s", settings(*old));
    REQUIRE_FALSE(nowhere);
    CHECK(nowhere.error().message == before.string() + ": the rows run in this folder, which is not there");
    plan.folder = after;
    plan.study_file = (after / "squares.toml").string();
    for (const Begin begin : {Begin::resume, Begin::fresh}) {
        const auto there = open_folder(plan, after / "s", begin);
        REQUIRE(there);
        CHECK(there->folder == after);
        CHECK(there->study_file == plan.study_file);
        CHECK(load_plan(after / "s")->folder == after);
    }
    REQUIRE(run(*load_plan(after / "s"), after / "s", settings(plan)));
    check_squares(plan, collected(plan, after / "s"));
}

TEST_CASE("warnings of a row not to trust its results are recorded with it") {
    const pliant::test::Folder folder("study");
    const Plan plan = squares("warn");
    REQUIRE(open_folder(plan, folder / "s", Begin::fresh));
    REQUIRE(run(plan, folder / "s", settings(plan)));
    const Collected found = collected(plan, folder / "s");
    check_squares(plan, found);
    CHECK(found.warned == 1);
    CHECK(found.rows[3]->warning == "below a vacuum; no balance");
    CHECK(found.rows[4]->warning.empty());
}

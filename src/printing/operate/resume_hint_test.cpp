#include "printing/operate/resume_hint.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "printing/host/journal.hpp"

using namespace pliant;
using namespace pliant::operate;
using pliant::test::holds;

TEST_CASE("the command that resumes a print repeats what its resumption needs, quoted for a shell") {
    PrintCall call{"finger.zip", {"/dev/ttyACM0", "0", 1, "", ""}, "", "", "", false};
    CHECK(resume_command(call) == "pliant print finger.zip --port /dev/ttyACM0 --projector 0 --resume");
    call = {"my finger.zip", {"port", "light", 20, "clock", "dtr:/dev/ttyUSB1"},
            "it's.j",        "echo $PLIANT_LAYER",
            "r.html",        false};
    CHECK(resume_command(call) ==
          "pliant print 'my finger.zip' --port port --projector light --journal 'it'\\''s.j' --emergency-line "
          "dtr:/dev/ttyUSB1 --after-layer 'echo $PLIANT_LAYER' --report r.html --speed 20 --clock clock --resume");
}

TEST_CASE("a journal can be resumed only if it is of this job and printer, and its print began and did not end") {
    const test::Folder folder("resume_hint");
    const auto path = folder / "a.journal";
    const std::string begin =
        host::write_record(1, "begin", {{"job", "a"}, {"digest", "12"}, {"printer", "tower"}, {"format", "1"}});
    const std::string light = host::write_record(
        2, "light", {{"step", "16"}, {"layer", "0"}, {"material", "0"}, {"planned", "12"}, {"at", "1"}});
    CHECK_FALSE(interrupted_at(path, "12", "tower"));
    CHECK_FALSE(std::filesystem::exists(path));
    REQUIRE(write_file(path, begin));
    CHECK_FALSE(interrupted_at(path, "12", "tower"));
    REQUIRE(write_file(path, begin + light));
    CHECK(interrupted_at(path, "12", "tower") == 2);
    CHECK_FALSE(interrupted_at(path, "13", "tower"));
    CHECK_FALSE(interrupted_at(path, "12", "wall"));
    {
        const auto other_host = host::Journal::open(path, false);
        REQUIRE(other_host);
        CHECK_FALSE(interrupted_at(path, "12", "tower"));  // it is being printed
    }
    CHECK(interrupted_at(path, "12", "tower") == 2);
    REQUIRE(write_file(path, begin + light + host::write_record(3, "end", {})));
    CHECK_FALSE(interrupted_at(path, "12", "tower"));
}

TEST_CASE("resuming without a journal is refused, with a warning of the part") {
    const test::Folder folder("resume_hint");
    const auto path = folder / "a.journal";
    const Status status = expect_journal(path, "a.zip");
    REQUIRE_FALSE(status);
    CHECK(holds(status.error().message, "there is no journal " + path.string()));
    CHECK(holds(status.error().message, "hang on the platform"));
    REQUIRE(write_file(path, ""));
    CHECK(expect_journal(path, "a.zip"));
}

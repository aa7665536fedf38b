#include "printing/host/replace_journal.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "printing/host/journal.hpp"

using namespace pliant;
using namespace pliant::host;
using pliant::test::holds;

namespace {

/// A journal whose print has lit one exposure; `last`: the kind of its last record, "": none.
std::string journal_text(const std::string& last) {
    std::string text =
        write_record(1, "begin", {{"job", "x"}, {"digest", "1"}, {"printer", "tower"}, {"format", "1"}}) +
        write_record(2, "light", {{"step", "3"}, {"layer", "0"}, {"material", "0"}, {"planned", "2"}, {"at", "1"}});
    if (!last.empty()) text += write_record(3, last, {});
    return text;
}

}  // namespace

TEST_CASE("the journal of an interrupted print is not replaced; that of a complete or cancelled one is") {
    const pliant::test::Folder folder;
    const auto path = folder / "journal";
    const std::string interrupted = journal_text("");
    REQUIRE(write_file(path, interrupted));
    CHECK(holds(may_replace_journal(path).error().message, "a print that was interrupted"));
    CHECK_FALSE(replace_journal(path, "new"));
    CHECK(read_file(path).value() == interrupted);
    for (const char* last : {"end", "cancel"}) {
        CAPTURE(std::string(last));
        REQUIRE(write_file(path, journal_text(last)));
        CHECK(may_replace_journal(path));
        REQUIRE(replace_journal(path, "new"));
        CHECK(read_file(path).value() == "new");
    }
}

TEST_CASE("a journal that another host holds is not replaced, even when it is empty") {
    const pliant::test::Folder folder;
    const auto path = folder / "journal";
    {
        const Journal held = Journal::open(path, false).value();
        CHECK(holds(may_replace_journal(path).error().message, "another host"));
        CHECK_FALSE(replace_journal(path, "new"));
        CHECK(read_file(path).value().empty());
    }
    CHECK(replace_journal(path, "new"));
}

TEST_CASE("what is not a journal is not replaced; a new file and a device are written") {
    const pliant::test::Folder folder;
    const auto path = folder / "job.zip";
    REQUIRE(write_file(path, "PK\n\x03 an archive"));
    CHECK(holds(replace_journal(path, "new").error().message, "this is not a journal"));
    CHECK(read_file(path).value() == "PK\n\x03 an archive");
    REQUIRE(replace_journal(folder / "fresh", "new"));
    CHECK(read_file(folder / "fresh").value() == "new");
    CHECK(replace_journal("/dev/null", "new"));
}

#include "studio/print/journal_names.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::studio;

TEST_CASE("a journal's name gives its job, and tells virtual from real machines") {
    CHECK(virtual_journal("a/finger.zip") == "a/finger.zip.virtual.journal");
    for (const char* name :
         {"a/finger.zip.journal", "a/finger.zip.virtual.journal", "a/finger.zip.2026-03-01_124503.journal",
          "a/finger.zip.virtual.2026-03-01_124503.journal"})
        CHECK(job_of_journal(name) == "a/finger.zip");
    CHECK(is_virtual_journal("finger.zip.virtual.journal"));
    CHECK(is_virtual_journal("finger.zip.virtual.2026-03-01_124503.journal"));
    CHECK_FALSE(is_virtual_journal("finger.zip.journal"));
    CHECK_FALSE(is_virtual_journal("finger.zip.2026-03-01_124503.journal"));
}

TEST_CASE("the journal of a finished print is kept, with the time of its end in its name") {
    const pliant::test::Folder folder;
    const std::filesystem::path journal = folder / "finger.zip.journal";
    keep_journal(journal);  // there is none
    REQUIRE(write_file(journal, "record").has_value());
    keep_journal(journal);
    CHECK_FALSE(std::filesystem::exists(journal));
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
        names.push_back(entry.path().filename());
    REQUIRE(names.size() == 1);
    CHECK(job_of_journal(names[0]) == "finger.zip");
    CHECK(names[0].size() == std::string("finger.zip.2026-03-01_124503.journal").size());
}

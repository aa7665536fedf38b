#include "printing/rehearse/memory_file.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "printing/host/journal.hpp"

using namespace pliant;
using rehearse::MemoryFile;

TEST_CASE("a journal in memory can be written, locked and read, and ends with its file") {
    std::filesystem::path path;
    {
        MemoryFile first = MemoryFile::make().value();
        const MemoryFile file = std::move(first);
        path = file.path();
        {
            auto journal = host::Journal::open(path, true).value();
            CHECK_FALSE(host::Journal::open(path, true));  // another host
            REQUIRE(journal.append("begin", {{"job", "a part"}}));
            REQUIRE(journal.append("end", {}));
        }
        const auto again = host::Journal::open(path, false).value();
        REQUIRE(again.records().size() == 2);
        CHECK(*again.records()[0].find("job") == "a part");
        CHECK(read_file(path).value() ==
              host::write_record(1, "begin", {{"job", "a part"}}) + host::write_record(2, "end", {}));
    }
    CHECK_FALSE(std::filesystem::exists(path));
}

TEST_CASE("two files in memory are separate") {
    const MemoryFile a = MemoryFile::make().value(), b = MemoryFile::make().value();
    REQUIRE(a.path() != b.path());
    REQUIRE(host::Journal::open(a.path(), false).value().append("begin", {}));
    CHECK(read_file(b.path()).value().empty());
}

#include "studio/base/file_stamp.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using studio::check_unchanged;
using studio::stamp_of;

TEST_CASE("a file that is replaced by one of the same size and time has another stamp") {
    const pliant::test::Folder folder;
    const auto file = folder / "a.zip", other = folder / "b.zip";
    CHECK_FALSE(stamp_of(file).has_value());
    REQUIRE(write_file(file, "one").has_value());
    const auto first = stamp_of(file);
    REQUIRE(first.has_value());
    CHECK(stamp_of(file) == first);
    REQUIRE(write_file(other, "two").has_value());
    std::filesystem::last_write_time(other, std::filesystem::last_write_time(file));
    std::filesystem::rename(other, file);
    CHECK(stamp_of(file) != first);
    CHECK(check_unchanged(file, stamp_of(file)));
    CHECK(check_unchanged(file, first).error().message == "a.zip has changed since it was opened: open it again");
    std::filesystem::remove(file);
    CHECK(check_unchanged(file, first));
}

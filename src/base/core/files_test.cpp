#include "base/core/files.hpp"

#include <doctest/doctest.h>

#include "base/core/test_folder.hpp"

using namespace pliant;
namespace fs = std::filesystem;

TEST_CASE("a file is written whole and read back") {
    const test::Folder scratch("files");
    const fs::path file = scratch / "a.bin";
    const std::string bytes("a\0b\n", 4);
    REQUIRE(write_file(file, bytes));
    CHECK(*read_file(file) == bytes);
    CHECK_FALSE(fs::exists(file.string() + ".partial"));
    CHECK(read_file(file, 3).error().message.find("more than") != std::string::npos);
    CHECK(read_file(scratch.path()).error().message.find("folder") != std::string::npos);
    CHECK(read_file(scratch / "none").error().message.find("no such file") != std::string::npos);
    CHECK_FALSE(write_file(scratch / "no" / "folder", bytes));
}

TEST_CASE("a folder is written whole or not at all, and folders with other files are not changed") {
    const test::Folder scratch("files");
    const fs::path folder = scratch / "out";
    const auto good = [](const fs::path& aside) { return write_file(aside / "summary.json", "{}"); };
    REQUIRE(write_folder(folder, "summary.json", good));
    REQUIRE(fs::exists(folder / "summary.json"));
    CHECK(write_folder(folder, "summary.json", good));
    CHECK_FALSE(write_folder(folder, "summary.json", [](const fs::path&) -> Status { return failure("no"); }));
    CHECK(fs::exists(folder / "summary.json"));
    CHECK_FALSE(fs::exists(folder.string() + ".partial"));

    const fs::path foreign = scratch / "foreign";
    fs::create_directories(foreign);
    REQUIRE(write_file(foreign / "thesis.txt", "years of work"));
    CHECK(write_folder(foreign, "summary.json", good).error().cause == Cause::input);
    CHECK(*read_file(foreign / "thesis.txt") == "years of work");
}

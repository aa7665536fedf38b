#include "studio/base/token_file.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using studio::read_or_make_token;
namespace fs = std::filesystem;

TEST_CASE("a token is made once, readable by its owner only, and then kept") {
    const pliant::test::Folder folder("token");
    const Result<std::string> first = read_or_make_token(folder / "token");
    REQUIRE(first);
    CHECK(first->size() == 32);
    CHECK(fs::status(folder / "token").permissions() == (fs::perms::owner_read | fs::perms::owner_write));
    CHECK(read_or_make_token(folder / "token").value() == *first);
    CHECK(read_or_make_token(folder / "other").value() != *first);
}

TEST_CASE("the user's own token is accepted unless it is weak or readable by everybody") {
    const pliant::test::Folder folder("token");
    const auto read = [&](const std::string& text, fs::perms permissions) {
        REQUIRE(write_file(folder / "token", text));
        fs::permissions(folder / "token", permissions);
        return read_or_make_token(folder / "token");
    };
    CHECK(read("0123456789abcdefXYZ\n", fs::perms(0600)).value() == "0123456789abcdefXYZ");
    CHECK(read("0123456789abcdefXYZ", fs::perms(0640)).value() == "0123456789abcdefXYZ");
    CHECK(read("0123456789abcdefXYZ\n", fs::perms(0644)).error().message.find("chmod o=") != std::string::npos);
    for (const char* text : {"", "\n", "short", "0123456789 abcdef", "0123456789abcdef\nmore", "0123456789abcdef;"}) {
        CAPTURE(text);
        const auto token = read(text, fs::perms(0600));
        REQUIRE(!token);
        CHECK(token.error().message.find("16 to 256 letters and digits") != std::string::npos);
    }
    CHECK(!read_or_make_token(folder / "no/such/folder"));
}

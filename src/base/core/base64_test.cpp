#include "base/core/base64.hpp"

#include <doctest/doctest.h>

using pliant::base64;

TEST_CASE("base64 gives the values of RFC 4648, section 10") {
    CHECK(base64("") == "");
    CHECK(base64("f") == "Zg==");
    CHECK(base64("fo") == "Zm8=");
    CHECK(base64("foo") == "Zm9v");
    CHECK(base64("foobar") == "Zm9vYmFy");
}

TEST_CASE("base64 takes bytes above 127 and zeros") {
    CHECK(base64(std::string_view("\xff\xfe\x00", 3)) == "//4A");
}

TEST_CASE("base64 is decoded piece by piece, and invalid characters are detected") {
    std::string all;
    for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
    CHECK(pliant::base64_decoded(base64(all), 256) == all);
    CHECK(pliant::base64_decoded("Zg==\n Zm9v", 4) == "ffoo");
    CHECK(pliant::base64_decoded("Zm9vYmFy", 2) == "fo");
    // Long enough for the fast path, with line ends in any place and padding in the middle.
    std::string lines;
    for (const char c : base64(all + all)) lines += lines.size() % 7 == 6 ? std::string("\n") + c : std::string(1, c);
    CHECK(pliant::base64_decoded(lines, 512) == all + all);
    CHECK(pliant::base64_decoded(base64(all) + base64(all), 512) == all + all);
    CHECK(pliant::base64_decoded(base64(all + all), 300) == (all + all).substr(0, 300));
    for (std::size_t at = 0; at < 40; ++at) CHECK_FALSE(pliant::base64_decoded(base64(all).replace(at, 1, "*"), 256));
    CHECK_FALSE(pliant::base64_decoded("Zm9v", 4));
    CHECK_FALSE(pliant::base64_decoded("Zm<9v", 3));
    CHECK_FALSE(pliant::base64_decoded("Zm9v", std::size_t{1} << 60));
}

#include "core/base64.hpp"

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

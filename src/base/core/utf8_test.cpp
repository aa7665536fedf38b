#include "base/core/utf8.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace pliant;

TEST_CASE("well-formed UTF-8 of every length is known, and what RFC 3629 forbids is not") {
    // The first and last characters of each length, and those beside the surrogates.
    for (const std::string good : {"", "a", "\x7f", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf",
                                   "\xee\x80\x80", "\xef\xbf\xbf", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
        CHECK_MESSAGE(is_utf8("x" + good + "x"), good);
    CHECK(is_utf8(std::string(1, '\0')));
    for (const std::string bad :
         {"\x80", "\xbf", "\xc0\x80", "\xc1\xbf", "\xc2", "\xc2x", "\xe0\x9f\xbf", "\xe2\x82", "\xed\xa0\x80",
          "\xf0\x8f\xbf\xbf", "\xf0\x9f\x98", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"}) {
        CHECK_FALSE(is_utf8(bad));
        CHECK_FALSE(is_utf8("x" + bad + "x"));
    }
    CHECK(utf8_length("\xe2\x82\xac 5") == 3);
}

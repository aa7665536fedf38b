#include "printing/job/sha256.hpp"

#include <doctest/doctest.h>

namespace pliant::job {

// The examples of FIPS 180-4 (NIST, "SHA256.pdf"), and the empty message.
TEST_CASE("SHA-256 agrees with the standard's examples") {
    CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
          "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    CHECK(is_sha256_hex(sha256_hex("abc")));
    CHECK(!is_sha256_hex("BA7816BF8F01CFEA414140DE5DAE2223B00361A396177A9CB410FF61F20015AD"));
    CHECK(!is_sha256_hex("ba78"));
}

}  // namespace pliant::job

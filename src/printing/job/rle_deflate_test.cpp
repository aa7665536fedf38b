#include "printing/job/rle_deflate.hpp"

#include <doctest/doctest.h>
#include <libdeflate.h>

#include <cstdint>

using pliant::job::deflate_runs;

namespace {

/// Decompresses with another library.
std::string inflated(const std::string& stream, std::size_t size) {
    std::string out(size + 1, '\0');
    std::size_t got = 0;
    auto* decoder = libdeflate_alloc_decompressor();
    const auto result = libdeflate_zlib_decompress(decoder, stream.data(), stream.size(), out.data(), out.size(), &got);
    libdeflate_free_decompressor(decoder);
    REQUIRE(result == LIBDEFLATE_SUCCESS);
    out.resize(got);
    return out;
}

void check_round_trip(const std::string& bytes) {
    CHECK(inflated(deflate_runs(bytes), bytes.size()) == bytes);
}

}  // namespace

TEST_CASE("runs of any length up to three maximal matches, alone and in sequence, are read back") {
    std::string all;
    for (std::size_t length = 0; length < 800; ++length) {
        const std::string run(length, static_cast<char>(length * 7));
        check_round_trip(run);
        all += run;
    }
    check_round_trip(all);
}

TEST_CASE("every byte, noise, and counts that need a code limited to 15 bits are read back") {
    std::string bytes;
    for (int i = 0; i < 256; ++i) bytes.push_back(static_cast<char>(i));
    check_round_trip(bytes);
    std::uint32_t state = 1;
    for (int i = 0; i < 100000; ++i) bytes.push_back(static_cast<char>((state = state * 1664525 + 1013904223) >> 24));
    check_round_trip(bytes);
    // Fibonacci counts give the deepest Huffman tree: 25 levels here, where 15 are allowed.
    std::string deep;
    std::size_t a = 1, b = 1;
    for (int symbol = 0; symbol < 25; ++symbol) {
        for (std::size_t i = 0; i < a; ++i) {
            deep.push_back(static_cast<char>(symbol));
            deep.push_back(static_cast<char>(200 + i % 2));  // so that no run forms
        }
        const std::size_t sum = a + b;
        a = b;
        b = sum;
    }
    check_round_trip(deep);
}

TEST_CASE("two million equal bytes take about 2 bits per 258 bytes") {
    CHECK(deflate_runs(std::string(2000000, '\0')).size() < 2100);
}

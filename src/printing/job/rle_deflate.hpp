// A zlib stream made of runs: deflate for data in which equal bytes follow each other.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::job {

/// Compresses runs to a zlib stream (RFC 1950) of one block with its own Huffman codes (RFC 1951), whose matches all
/// repeat the byte before. The bytes themselves never exist: time goes with the number of runs, plus one bit operation
/// for some seven thousand bytes of a long run.
class RunDeflater {
public:
    /// Appends `count` bytes of one value.
    void add(std::uint8_t byte, std::uint64_t count) {
        if (count == 0) return;
        if (!runs_.empty() && runs_.back().byte == byte) {
            runs_.back().count += count;
        } else {
            runs_.push_back({byte, count});
        }
    }
    /// The stream of everything added; leaves the compressor empty.
    [[nodiscard]] std::string finish();

private:
    struct Run {
        std::uint8_t byte;
        std::uint64_t count;
    };
    std::vector<Run> runs_;
};

/// Finds the runs of `bytes` and compresses them.
[[nodiscard]] std::string deflate_runs(std::string_view bytes);

}  // namespace pliant::job

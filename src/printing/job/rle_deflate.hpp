// A zlib stream from runs: deflate for data with long runs of equal bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::job {

/// Compresses runs to a zlib stream (RFC 1950) of one block with dynamic Huffman codes (RFC 1951), in which all matches
/// have distance 1. The bytes are never expanded: time is proportional to the number of runs, plus one bit operation
/// per about seven thousand bytes of a long run.
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

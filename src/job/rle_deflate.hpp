// A zlib stream made of runs: deflate for data in which equal bytes follow each other.
#pragma once

#include <string>
#include <string_view>

namespace pliant::job {

/// Compresses to a zlib stream (RFC 1950) of one block with its own Huffman codes (RFC 1951), whose matches all repeat
/// the byte before. Images of layers, row differences taken, are little else than long runs: several times faster than
/// a general compressor, at about the same size.
[[nodiscard]] std::string deflate_runs(std::string_view bytes);

}  // namespace pliant::job

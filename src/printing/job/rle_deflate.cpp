#include "printing/job/rle_deflate.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <queue>

namespace pliant::job {
namespace {

constexpr int end_of_block = 256;
constexpr int symbol_count = 286;
constexpr std::uint64_t longest_match = 258;

/// A match length in the code of RFC 1951, table of its section 3.2.5.
struct LengthCode {
    int symbol;
    int extra_bits;
    std::uint32_t extra;
};

LengthCode length_code(std::uint32_t length) {
    if (length == longest_match) return {285, 0, 0};
    if (length < 11) return {static_cast<int>(254 + length), 0, 0};
    // From 11 on, four symbols for each doubling.
    const std::uint32_t offset = length - 3;
    const int bits = std::bit_width(offset) - 3;
    return {257 + 4 * bits + static_cast<int>(offset >> bits), bits, offset & ((1U << bits) - 1)};
}

/// Encoding of a run: its byte, matches of maximum length, one more match, its byte again.
struct Spelling {
    std::uint64_t longest;   ///< matches of 258
    std::uint32_t match;     ///< one match of this length; 0: none
    std::uint32_t literals;  ///< the byte itself, one before the matches and the others after them
};

Spelling spell(std::uint64_t count) {
    const std::uint64_t rest = count - 1;
    const auto tail = static_cast<std::uint32_t>(rest % longest_match);
    if (tail >= 3) return {rest / longest_match, tail, 1};
    return {rest / longest_match, 0, 1 + tail};
}

using Counts = std::array<std::uint32_t, symbol_count>;
using Lengths = std::array<std::uint8_t, symbol_count>;

/// The depths of the leaves of a Huffman tree over `leaves` (count, symbol), ordered by count. Repeatedly joins the two
/// lightest leaves or nodes; new nodes are created in order of weight, so a queue is enough.
int assign_depths(const std::vector<std::pair<std::uint32_t, int>>& leaves, Lengths& lengths) {
    const std::size_t n = leaves.size();
    std::vector<std::uint64_t> weight(2 * n - 1);
    std::vector<std::size_t> parent(2 * n - 1, 0);
    for (std::size_t i = 0; i < n; ++i) weight[i] = leaves[i].first;
    std::size_t leaf = 0, inner = n;
    for (std::size_t node = n; node < weight.size(); ++node) {
        for (int child = 0; child < 2; ++child) {
            const bool take_leaf = leaf < n && (inner == node || weight[leaf] <= weight[inner]);
            const std::size_t taken = take_leaf ? leaf++ : inner++;
            weight[node] += weight[taken];
            parent[taken] = node;
        }
    }
    std::vector<int> depth(weight.size(), 0);
    int deepest = 0;
    for (std::size_t node = weight.size() - 1; node-- > 0;) {
        depth[node] = depth[parent[node]] + 1;
        if (node < n) lengths[leaves[node].second] = static_cast<std::uint8_t>(std::min(depth[node], 255));
        deepest = std::max(deepest, depth[node]);
    }
    return deepest;
}

/// Code lengths of a Huffman code over the first `symbols` counts; 0 for symbols that do not occur. If the code would
/// be deeper than `limit`, counts are flattened until it fits.
Lengths huffman_lengths(const Counts& counts, int symbols, int limit) {
    Lengths lengths{};
    std::vector<std::pair<std::uint32_t, int>> leaves;
    for (int s = 0; s < symbols; ++s) {
        if (counts[s] > 0) leaves.emplace_back(counts[s], s);
    }
    if (leaves.size() == 1) {
        lengths[leaves[0].second] = 1;
        return lengths;
    }
    std::sort(leaves.begin(), leaves.end());
    while (assign_depths(leaves, lengths) > limit) {
        for (auto& leaf : leaves) leaf.first = (leaf.first + 1) / 2;
    }
    return lengths;
}

struct Code {
    std::uint32_t bits = 0;  ///< bit-reversed, as deflate stores Huffman codes
    int length = 0;
};

using Codes = std::array<Code, symbol_count>;

Codes canonical_code(const Lengths& lengths) {
    std::array<std::uint32_t, 17> count{}, next{};
    for (const int length : lengths) ++count[static_cast<std::size_t>(length)];
    count[0] = 0;
    for (std::size_t l = 1; l < next.size(); ++l) next[l] = (next[l - 1] + count[l - 1]) << 1;
    Codes codes{};
    for (std::size_t s = 0; s < lengths.size(); ++s) {
        if (lengths[s] == 0) continue;
        std::uint32_t code = next[lengths[s]]++;
        codes[s].length = lengths[s];
        for (int i = 0; i < codes[s].length; ++i, code >>= 1) codes[s].bits = codes[s].bits << 1 | (code & 1);
    }
    return codes;
}

/// Writes bits to memory, which must have room for eight extra bytes.
class BitWriter {
public:
    explicit BitWriter(char* out) : begin_(out), out_(out) {}
    /// At most 56 bits.
    void put(std::uint64_t bits, int count) {
        buffer_ |= bits << filled_;
        filled_ += count;
        std::memcpy(out_, &buffer_, 8);  // only the whole bytes of these are kept
        const int whole = filled_ >> 3;
        out_ += whole;
        buffer_ = whole == 8 ? 0 : buffer_ >> (8 * whole);
        filled_ &= 7;
    }
    void put(const Code& code) { put(code.bits, code.length); }
    void put(const Code& code, std::uint64_t times) {
        if (times == 0) return;
        std::uint64_t many = 0;
        const int per_put = 56 / code.length;
        for (int i = 0; i < per_put; ++i) many |= std::uint64_t{code.bits} << (i * code.length);
        for (; times >= static_cast<std::uint64_t>(per_put); times -= per_put) put(many, per_put * code.length);
        for (; times > 0; --times) put(code);
    }
    [[nodiscard]] std::size_t finish() {
        if (filled_ > 0) put(0, 8 - filled_);
        return static_cast<std::size_t>(out_ - begin_);
    }

private:
    char* begin_;
    char* out_;
    std::uint64_t buffer_ = 0;
    int filled_ = 0;
};
static_assert(std::endian::native == std::endian::little, "BitWriter stores words as deflate wants them");

/// Code lengths in the header: literal, or 17 and 18 for runs of zeros.
struct LengthSymbol {
    int symbol;
    std::uint32_t extra;
    int extra_bits;
};

std::vector<LengthSymbol> pack_lengths(const std::vector<std::uint8_t>& lengths) {
    std::vector<LengthSymbol> packed;
    for (std::size_t i = 0; i < lengths.size();) {
        std::size_t end = i;
        while (end < lengths.size() && lengths[end] == 0 && end - i < 138) ++end;
        const auto zeros = static_cast<std::uint32_t>(end - i);
        if (zeros >= 11) {
            packed.push_back({18, zeros - 11, 7});
        } else if (zeros >= 3) {
            packed.push_back({17, zeros - 3, 3});
        } else {
            packed.push_back({lengths[i], 0, 0});
            end = i + 1;
        }
        i = end;
    }
    return packed;
}

void put_header(BitWriter& out, const Lengths& symbol_lengths) {
    std::vector<std::uint8_t> lengths(symbol_lengths.begin(), symbol_lengths.end());
    lengths.push_back(1);  // the only distance code: distance 1
    const std::vector<LengthSymbol> packed = pack_lengths(lengths);
    Counts counts{};
    for (const LengthSymbol& s : packed) ++counts[s.symbol];
    const Lengths code_lengths = huffman_lengths(counts, 19, 7);
    const Codes codes = canonical_code(code_lengths);
    out.put(1, 1);  // the last block
    out.put(2, 2);  // dynamic Huffman codes
    out.put(symbol_count - 257, 5);
    out.put(0, 5);   // 1 distance code
    out.put(15, 4);  // 19 code lengths follow, in this order:
    for (const int s : {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15}) out.put(code_lengths[s], 3);
    for (const LengthSymbol& s : packed) {
        out.put(codes[s.symbol]);
        out.put(s.extra, s.extra_bits);
    }
}

/// Checksum of RFC 1950 over runs: for each of n bytes b, the first sum grows by b and the second by the first.
class Adler32 {
public:
    void add(std::uint8_t byte, std::uint64_t count) {
        constexpr std::uint64_t modulus = 65521, at_once = 1 << 24;
        for (; count > 0; count -= std::min(count, at_once)) {
            const std::uint64_t n = std::min(count, at_once);
            second_ = (second_ + n * first_ + byte * (n * (n + 1) / 2)) % modulus;
            first_ = (first_ + n * byte) % modulus;
        }
    }
    [[nodiscard]] std::uint32_t value() const { return static_cast<std::uint32_t>(second_ << 16 | first_); }

private:
    std::uint64_t first_ = 1, second_ = 0;
};

/// A match as it is stored: its length code with extra bits, and the distance, one 0 bit.
Code match_code(std::uint32_t length, const Codes& codes) {
    const LengthCode code = length_code(length);
    const Code& symbol = codes[code.symbol];
    return {symbol.bits | code.extra << symbol.length, symbol.length + code.extra_bits + 1};
}

std::size_t run_end(std::string_view bytes, std::size_t begin) {
    const std::size_t end = bytes.find_first_not_of(bytes[begin], begin);
    return end == std::string_view::npos ? bytes.size() : end;
}

constexpr std::size_t header_bytes = 400;  // upper limit for the code lengths of 286 symbols

}  // namespace

std::string RunDeflater::finish() {
    Counts counts{};
    counts[end_of_block] = 1;
    Adler32 sum;
    for (const Run& run : runs_) {
        const Spelling spelling = spell(run.count);
        counts[run.byte] += spelling.literals;
        counts[285] += static_cast<std::uint32_t>(spelling.longest);
        if (spelling.match > 0) ++counts[length_code(spelling.match).symbol];
        sum.add(run.byte, run.count);
    }
    const Lengths lengths = huffman_lengths(counts, symbol_count, 15);
    const Codes codes = canonical_code(lengths);
    std::uint64_t bits = 0;
    for (int s = 0; s < symbol_count; ++s)
        bits += std::uint64_t{counts[s]} * (lengths[s] + (s > end_of_block ? 6U : 0U));

    std::string out(2 + header_bytes + bits / 8 + 16, '\0');
    out[0] = '\x78';
    out[1] = '\x01';
    BitWriter writer(out.data() + 2);
    put_header(writer, lengths);
    const Code longest = match_code(longest_match, codes);
    for (const Run& run : runs_) {
        const Spelling spelling = spell(run.count);
        const Code& literal = codes[run.byte];
        writer.put(literal);
        if (spelling.longest > 0) writer.put(longest, spelling.longest);
        if (spelling.match > 0) writer.put(match_code(spelling.match, codes));
        for (std::uint32_t i = 1; i < spelling.literals; ++i) writer.put(literal);
    }
    writer.put(codes[end_of_block]);
    out.resize(2 + writer.finish());
    for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(sum.value() >> shift & 0xFF));
    runs_.clear();
    return out;
}

std::string deflate_runs(std::string_view bytes) {
    RunDeflater deflater;
    for (std::size_t i = 0; i < bytes.size();) {
        const std::size_t end = run_end(bytes, i);
        deflater.add(static_cast<std::uint8_t>(bytes[i]), end - i);
        i = end;
    }
    return deflater.finish();
}

}  // namespace pliant::job

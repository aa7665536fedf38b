#include "job/rle_deflate.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <queue>
#include <vector>

namespace pliant::job {
namespace {

constexpr int end_of_block = 256;
constexpr int symbol_count = 286;
constexpr std::uint32_t longest_match = 258;

struct Run {
    std::uint8_t byte;
    std::uint32_t count;
};

std::size_t run_end(const std::uint8_t* data, std::size_t i, std::size_t size) {
    const std::uint8_t byte = data[i];
    const std::uint64_t eight = 0x0101010101010101ULL * byte;
    for (; i + 8 <= size; i += 8) {
        std::uint64_t word = 0;
        std::memcpy(&word, data + i, 8);
        if (word != eight) break;
    }
    while (i < size && data[i] == byte) ++i;
    return i;
}

std::vector<Run> find_runs(std::string_view bytes) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    std::vector<Run> runs;
    for (std::size_t i = 0; i < bytes.size();) {
        const std::size_t end = std::min(run_end(data, i, bytes.size()), i + (std::size_t{1} << 30));
        runs.push_back({data[i], static_cast<std::uint32_t>(end - i)});
        i = end;
    }
    return runs;
}

/// A match length as RFC 1951 codes it, table of its section 3.2.5.
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
    int bits = 0;
    while (offset >> (bits + 3) != 0) ++bits;
    return {257 + 4 * bits + static_cast<int>(offset >> bits), bits, offset & ((1U << bits) - 1)};
}

/// Calls `literal(byte)` and `match(length, times)` for a run; both coders below see the same sequence.
template <class Literal, class Match>
void spell(const Run& run, const Literal& literal, const Match& match) {
    literal(run.byte);
    const std::uint32_t rest = run.count - 1;
    if (rest >= longest_match) match(longest_match, rest / longest_match);
    const std::uint32_t tail = rest % longest_match;
    if (tail >= 3) {
        match(tail, 1U);
    } else {
        for (std::uint32_t i = 0; i < tail; ++i) literal(run.byte);
    }
}

/// Code lengths of a Huffman code; 0 for symbols that do not occur. Where the code would be deeper than `limit`, counts
/// are flattened until it is not.
std::vector<int> huffman_lengths(std::vector<std::uint64_t> counts, int limit) {
    using Item = std::pair<std::uint64_t, int>;
    for (;;) {
        std::vector<int> parent(counts.size(), -1);
        std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
        for (std::size_t s = 0; s < counts.size(); ++s) {
            if (counts[s] > 0) queue.emplace(counts[s], static_cast<int>(s));
        }
        while (queue.size() > 1) {
            const Item a = queue.top();
            queue.pop();
            const Item b = queue.top();
            queue.pop();
            const int node = static_cast<int>(parent.size());
            parent[a.second] = parent[b.second] = node;
            parent.push_back(-1);
            queue.emplace(a.first + b.first, node);
        }
        std::vector<int> lengths(counts.size(), 0);
        for (std::size_t s = 0; s < counts.size(); ++s) {
            for (int node = parent[s]; node >= 0; node = parent[node]) ++lengths[s];
            if (counts[s] > 0 && parent[s] < 0) lengths[s] = 1;  // the only symbol
        }
        if (*std::max_element(lengths.begin(), lengths.end()) <= limit) return lengths;
        for (std::uint64_t& count : counts) count = (count + 1) / 2;
    }
}

struct Code {
    std::uint32_t bits = 0;  ///< reversed, as deflate sends Huffman codes
    int length = 0;
};

/// The canonical code of RFC 1951, section 3.2.2.
std::vector<Code> canonical_code(const std::vector<int>& lengths) {
    std::array<std::uint32_t, 17> next{};
    for (const int length : lengths) next[length + 1] += length > 0 ? 1 : 0;
    for (std::size_t l = 1; l < next.size(); ++l) next[l] = (next[l] + next[l - 1]) << (l > 1 ? 1 : 0);
    std::vector<Code> codes(lengths.size());
    for (std::size_t s = 0; s < lengths.size(); ++s) {
        if (lengths[s] == 0) continue;
        codes[s].length = lengths[s];
        const std::uint32_t code = next[lengths[s]]++;
        for (int bit = 0; bit < lengths[s]; ++bit) codes[s].bits |= (code >> bit & 1) << (lengths[s] - 1 - bit);
    }
    return codes;
}

class BitWriter {
public:
    explicit BitWriter(std::string& out) : out_(out) {}
    void put(std::uint32_t bits, int count) {
        buffer_ |= std::uint64_t{bits} << filled_;
        filled_ += count;
        while (filled_ >= 8) flush_byte();
    }
    void put(const Code& code) { put(code.bits, code.length); }
    void finish() {
        while (filled_ > 0) flush_byte();
    }

private:
    void flush_byte() {
        out_.push_back(static_cast<char>(buffer_ & 0xFF));
        buffer_ >>= 8;
        filled_ = std::max(0, filled_ - 8);
    }
    std::string& out_;
    std::uint64_t buffer_ = 0;
    int filled_ = 0;
};

/// Code lengths as the header sends them: themselves, or 17 and 18 for runs of zeros.
struct LengthSymbol {
    int symbol;
    std::uint32_t extra;
    int extra_bits;
};

std::vector<LengthSymbol> pack_lengths(const std::vector<int>& lengths) {
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

void put_header(BitWriter& out, std::vector<int> lengths) {
    lengths.push_back(1);  // the one distance code: the byte before
    const std::vector<LengthSymbol> packed = pack_lengths(lengths);
    std::vector<std::uint64_t> counts(19, 0);
    for (const LengthSymbol& s : packed) ++counts[s.symbol];
    const std::vector<int> code_lengths = huffman_lengths(counts, 7);
    const std::vector<Code> codes = canonical_code(code_lengths);
    out.put(1, 1);  // the last block
    out.put(2, 2);  // with codes of its own
    out.put(symbol_count - 257, 5);
    out.put(0, 5);   // 1 distance code
    out.put(15, 4);  // 19 code lengths follow, in this order:
    for (const int s : {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15}) out.put(code_lengths[s], 3);
    for (const LengthSymbol& s : packed) {
        out.put(codes[s.symbol]);
        out.put(s.extra, s.extra_bits);
    }
}

}  // namespace

std::string deflate_runs(std::string_view bytes) {
    const std::vector<Run> runs = find_runs(bytes);
    std::vector<std::uint64_t> counts(symbol_count, 0);
    counts[end_of_block] = 1;
    for (const Run& run : runs) {
        spell(
            run, [&](std::uint8_t byte) { ++counts[byte]; },
            [&](std::uint32_t length, std::uint32_t times) { counts[length_code(length).symbol] += times; });
    }
    const std::vector<int> lengths = huffman_lengths(counts, 15);
    const std::vector<Code> codes = canonical_code(lengths);

    std::string out("\x78\x01", 2);
    BitWriter writer(out);
    put_header(writer, lengths);
    for (const Run& run : runs) {
        spell(
            run, [&](std::uint8_t byte) { writer.put(codes[byte]); },
            [&](std::uint32_t length, std::uint32_t times) {
                const LengthCode code = length_code(length);
                for (std::uint32_t i = 0; i < times; ++i) {
                    writer.put(codes[code.symbol]);
                    writer.put(code.extra, code.extra_bits);
                    writer.put(0, 1);
                }
            });
    }
    writer.put(codes[end_of_block]);
    writer.finish();
    const std::uint32_t sum = libdeflate_adler32(1, bytes.data(), bytes.size());
    for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(sum >> shift & 0xFF));
    return out;
}

}  // namespace pliant::job

#include "geometry/files/vtu_arrays.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "base/core/base64.hpp"
#include "base/core/parallel.hpp"

namespace pliant::mesh {
namespace {

/// Maximum expansion ratio of deflate: a block that claims more is rejected.
constexpr std::size_t most_expansion = 1032;

constexpr std::size_t blocks_at_once = 16;
constexpr std::size_t numbers_at_once = std::size_t{1} << 16;

std::optional<std::string> first_bytes(const VtuSource& source, std::size_t count) {
    if (source.base64) return base64_decoded(source.text, count);
    if (count > source.text.size()) return std::nullopt;
    return std::string(source.text.substr(0, count));
}

std::uint64_t bits(std::string_view bytes, bool big_endian) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
        value = value << 8U | static_cast<unsigned char>(bytes[big_endian ? i : bytes.size() - 1 - i]);
    return value;
}

/// A byte count followed by the bytes.
std::optional<std::string> plain(const VtuSource& source, const VtuEncoding& encoding) {
    const auto header = first_bytes(source, encoding.header_width);
    if (!header) return std::nullopt;
    const std::uint64_t count = bits(*header, encoding.big_endian);
    if (count > source.text.size()) return std::nullopt;
    auto all = first_bytes(source, encoding.header_width + count);
    if (all) all->erase(0, encoding.header_width);
    return all;
}

struct Block {
    std::string_view packed;
    std::size_t size;  ///< uncompressed
};

bool inflate(std::string_view packed, std::span<char> out) {
    const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> state(
        libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
    return libdeflate_zlib_decompress(state.get(), packed.data(), packed.size(), out.data(), out.size(), nullptr) ==
           LIBDEFLATE_SUCCESS;
}

/// Appends some blocks, on all cores: memory is allocated for only a few unverified block sizes at a time.
bool inflate(const std::vector<Block>& blocks, std::string& out) {
    std::vector<std::size_t> begin = {out.size()};
    for (const Block& block : blocks) begin.push_back(begin.back() + block.size);
    out.resize(begin.back());
    std::atomic<bool> sound = true;
    parallel_for(blocks.size(), 1, [&](std::size_t first, std::size_t end) {
        for (std::size_t b = first; b < end; ++b) {
            if (!inflate(blocks[b].packed, {out.data() + begin[b], blocks[b].size})) sound = false;
        }
    });
    return sound;
}

/// Header of compressed data: number of blocks, their size, the size of a short last block or 0, compressed sizes.
class BlockHeader {
public:
    static std::optional<BlockHeader> read(const VtuSource& source, const VtuEncoding& encoding) {
        constexpr std::size_t fixed = 3;  // numbers before the compressed sizes
        const auto start = first_bytes(source, fixed * encoding.header_width);
        if (!start) return std::nullopt;
        BlockHeader header(*start, encoding);
        const std::uint64_t blocks = header.number(0);
        if (blocks > source.text.size()) return std::nullopt;
        auto all = first_bytes(source, encoding.header_width * (fixed + blocks));
        if (!all) return std::nullopt;
        return BlockHeader(std::move(*all), encoding);
    }
    [[nodiscard]] std::size_t bytes() const { return bytes_.size(); }
    [[nodiscard]] std::uint64_t blocks() const { return number(0); }
    [[nodiscard]] std::uint64_t packed_size(std::size_t block) const { return number(3 + block); }
    [[nodiscard]] std::uint64_t size(std::size_t block) const {
        const bool short_one = block + 1 == blocks() && number(2) != 0;
        return number(short_one ? 2 : 1);
    }

private:
    BlockHeader(std::string bytes, const VtuEncoding& encoding) : bytes_(std::move(bytes)), encoding_(encoding) {}
    [[nodiscard]] std::uint64_t number(std::size_t i) const {
        const std::size_t width = encoding_.header_width;
        return bits(std::string_view(bytes_).substr(i * width, width), encoding_.big_endian);
    }

    std::string bytes_;
    VtuEncoding encoding_;
};

std::optional<std::string> decompressed(const VtuSource& source, const VtuEncoding& encoding) {
    const auto header = BlockHeader::read(source, encoding);
    if (!header) return std::nullopt;
    std::size_t total = header->bytes();
    for (std::size_t b = 0; b < header->blocks(); ++b) {
        if (header->packed_size(b) > source.text.size() - std::min(total, source.text.size())) return std::nullopt;
        total += header->packed_size(b);
    }
    const auto all = first_bytes(source, total);
    if (!all) return std::nullopt;
    std::string out;
    std::size_t at = header->bytes();
    std::vector<Block> some;
    for (std::size_t b = 0; b < header->blocks(); ++b) {
        const std::string_view packed = std::string_view(*all).substr(at, header->packed_size(b));
        if (header->size(b) > most_expansion * (packed.size() + 1)) return std::nullopt;
        some.push_back({packed, header->size(b)});
        at += packed.size();
        const bool enough = some.size() == blocks_at_once || b + 1 == header->blocks();
        if (enough && !inflate(std::exchange(some, {}), out)) return std::nullopt;
    }
    return out;
}

/// Numbers [begin, end) of a native type.
template <class T>
void copy_numbers(std::string_view bytes, std::size_t begin, std::size_t end, std::vector<double>& numbers) {
    for (std::size_t i = begin; i < end; ++i) {
        T value;
        std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
        numbers[i] = static_cast<double>(value);
    }
}

/// Common types are copied, any other is assembled from its bytes.
void decode(std::string_view bytes, const NumberType& type, bool big_endian, std::size_t begin, std::size_t end,
            std::vector<double>& numbers) {
    if (!big_endian && type.floating && type.width == 8) return copy_numbers<double>(bytes, begin, end, numbers);
    if (!big_endian && type.floating) return copy_numbers<float>(bytes, begin, end, numbers);
    if (!big_endian && type.is_signed && type.width == 8) return copy_numbers<std::int64_t>(bytes, begin, end, numbers);
    if (!big_endian && type.is_signed && type.width == 4) return copy_numbers<std::int32_t>(bytes, begin, end, numbers);
    if (!type.is_signed && type.width == 1) return copy_numbers<std::uint8_t>(bytes, begin, end, numbers);
    for (std::size_t i = begin; i < end; ++i)
        numbers[i] = number_of_bits(type, bits(bytes.substr(i * type.width, type.width), big_endian));
}

}  // namespace

std::optional<NumberType> vtu_number_type(std::string_view name) {
    if (name == "Float32") return NumberType{4, true, true};
    if (name == "Float64") return NumberType{8, true, true};
    if (name == "String") return NumberType{1, false, false};
    const bool is_signed = !name.starts_with("U");
    if (!is_signed) name.remove_prefix(1);
    if (name == "Int8") return NumberType{1, false, is_signed};
    if (name == "Int16") return NumberType{2, false, is_signed};
    if (name == "Int32") return NumberType{4, false, is_signed};
    if (name == "Int64") return NumberType{8, false, is_signed};
    return std::nullopt;
}

std::optional<std::vector<double>> vtu_numbers(const VtuSource& source, const NumberType& type,
                                               const VtuEncoding& encoding) {
    const auto bytes = encoding.compressed ? decompressed(source, encoding) : plain(source, encoding);
    if (!bytes) return std::nullopt;
    std::vector<double> numbers(bytes->size() / type.width);
    parallel_for(numbers.size(), numbers_at_once, [&](std::size_t begin, std::size_t end) {
        decode(*bytes, type, encoding.big_endian, begin, end, numbers);
    });
    return numbers;
}

}  // namespace pliant::mesh

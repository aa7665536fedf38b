// A checksum that tells files apart; not cryptographic.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace pliant {

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
class Digest {
public:
    void add(const void* data, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t k = 0; k < size; ++k) hash_ = (hash_ ^ bytes[k]) * 1099511628211ULL;
    }
    [[nodiscard]] std::uint64_t number() const { return hash_; }
    /// 16 hexadecimal digits.
    [[nodiscard]] std::string text() const { return fmt::format("{:016x}", hash_); }

private:
    std::uint64_t hash_ = 14695981039346656037ULL;
};

}  // namespace pliant

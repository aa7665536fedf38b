// Tokens and numbers of a .msh file, text or binary.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "geometry/files/text_scanner.hpp"

namespace pliant::mesh {

/// Section headers, the counts of version 2 and names are text in both kinds of file; numbers follow the kind of file.
class MshInput {
public:
    MshInput(std::string_view bytes, std::string name) : bytes_(bytes), name_(name), scan_(bytes, std::move(name)) {}

    /// From here on numbers are binary. Call inside the $MeshFormat section; reads the integer 1 that tells the byte
    /// order.
    [[nodiscard]] Status begin_binary(bool wide_sizes);
    [[nodiscard]] bool binary() const { return binary_; }
    [[nodiscard]] std::size_t size_width() const { return wide_ ? 8 : 4; }

    /// "$Nodes" and so on; "" at the end of the file.
    [[nodiscard]] std::string section() { return std::string(scan_.word()); }
    [[nodiscard]] std::string word() { return std::string(scan_.word()); }
    std::string_view rest_of_line() { return scan_.rest_of_line(); }
    /// Call before binary data; does nothing in text, where line ends do not matter.
    void skip_line_end();
    /// Moves past the end of the section that began with `head`.
    [[nodiscard]] Status skip_section(std::string_view head);
    [[nodiscard]] Status expect_end();

    [[nodiscard]] Result<std::int64_t> text_integer() { return scan_.integer(); }
    [[nodiscard]] Result<std::size_t> text_count(std::size_t least_bytes) { return scan_.count(least_bytes); }

    [[nodiscard]] Result<std::int64_t> integer();  ///< 4 bytes
    [[nodiscard]] Result<std::int64_t> size();     ///< 8 bytes, or as the header of the file says
    [[nodiscard]] Result<double> number();         ///< 8 bytes; finite
    /// Reads a size() for items of at least `least_bytes` each.
    [[nodiscard]] Result<std::size_t> count(std::size_t least_bytes);
    template <std::size_t Count>
    [[nodiscard]] Result<std::array<std::int64_t, Count>> integers();
    template <std::size_t Count>
    [[nodiscard]] Result<std::array<std::uint64_t, Count>> sizes();
    /// Skips `rows` times `width` bytes.
    [[nodiscard]] Status skip_bytes(std::size_t rows, std::size_t width);

    /// "NAME:LINE: TEXT", or the byte offset in a binary file.
    [[nodiscard]] tl::unexpected<Error> error(std::string_view text) const;

private:
    /// The next `width` bytes as an unsigned number; false at the end of the file.
    bool next_bits(std::size_t width, std::uint64_t& bits);

    std::string_view bytes_;
    std::string name_;
    TextScanner scan_;
    bool binary_ = false;
    bool swapped_ = false;
    bool wide_ = true;
};

template <std::size_t Count>
Result<std::array<std::int64_t, Count>> MshInput::integers() {
    std::array<std::int64_t, Count> values{};
    for (std::int64_t& value : values) {
        const Result<std::int64_t> one = integer();
        if (!one) return tl::unexpected(one.error());
        value = *one;
    }
    return values;
}

template <std::size_t Count>
Result<std::array<std::uint64_t, Count>> MshInput::sizes() {
    std::array<std::uint64_t, Count> values{};
    for (std::uint64_t& value : values) {
        const Result<std::int64_t> one = size();
        if (!one) return tl::unexpected(one.error());
        value = static_cast<std::uint64_t>(*one);
    }
    return values;
}

}  // namespace pliant::mesh

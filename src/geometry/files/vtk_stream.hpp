// Sequential reader of a legacy VTK file: words, counts and numbers, as text or as big-endian binary arrays.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::mesh {

/// Errors name the file and the line. Memory is bounded by the actual size of the file, whatever its header says.
class VtkStream {
public:
    VtkStream(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

    [[nodiscard]] tl::unexpected<Error> error(const std::string& text) const;
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }
    [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }
    [[nodiscard]] bool binary() const { return binary_; }
    /// From here on arrays are binary.
    void set_binary() { binary_ = true; }

    /// Position of the next word, to return to.
    [[nodiscard]] std::size_t mark() const { return at_; }
    void go_back(std::size_t mark) { at_ = mark; }
    /// Steps back before the end of the line just read, where the bytes of a binary array begin after it.
    void before_line_end() { --at_; }

    [[nodiscard]] static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
    std::string_view next_line();
    /// Empty at the end of the file.
    std::string next_word();
    Status read_count(std::size_t& count);
    /// Reads `count` numbers of the named VTK type.
    Result<std::vector<double>> read_numbers(std::size_t count, const std::string& type_name);
    /// Next string of a string array: the rest of a line or, in a binary file, a length and the bytes.
    std::string_view next_text() { return binary_ ? next_binary_string() : next_line(); }

private:
    std::string_view next_binary_string();

    std::string_view bytes_;
    std::string name_;
    std::size_t at_ = 0;
    bool binary_ = false;
};

}  // namespace pliant::mesh

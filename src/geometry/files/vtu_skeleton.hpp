// The XML of a .vtu file without the text of its large arrays, which keeps the parsed document small.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::mesh {

/// Views into the text it was made from, which must outlive it.
class VtuSkeleton {
public:
    VtuSkeleton() = default;
    /// `text`: the XML part of the file.
    explicit VtuSkeleton(std::string_view text);

    /// A placeholder stands for each large array.
    [[nodiscard]] const std::string& xml() const { return xml_; }
    void append(std::string_view text) { xml_ += text; }

    /// The text that a placeholder stands for; any other text is returned unchanged.
    [[nodiscard]] std::string_view original(std::string_view text) const;
    /// Converts an offset in xml() to one in the file.
    [[nodiscard]] std::size_t place_in_file(std::size_t at) const;

private:
    struct Cut {
        std::size_t at, left_out;  ///< offset in xml(), and number of bytes omitted up to there
    };
    std::string xml_;
    std::vector<std::string_view> arrays_;
    std::vector<Cut> cuts_;
};

}  // namespace pliant::mesh

// The XML of a .vtu file without the text of its large arrays, so that a tree of the document need not hold them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::mesh {

/// Views of the text that it was made from, which must outlive it.
class VtuSkeleton {
public:
    VtuSkeleton() = default;
    /// `text`: the XML, as far as it is text.
    explicit VtuSkeleton(std::string_view text);

    /// In place of each large array stands a mark.
    [[nodiscard]] const std::string& xml() const { return xml_; }
    void append(std::string_view text) { xml_ += text; }

    /// The text that a mark stands for; any other text is its own.
    [[nodiscard]] std::string_view original(std::string_view text) const;
    /// Where in the file a place in xml() is.
    [[nodiscard]] std::size_t place_in_file(std::size_t at) const;

private:
    struct Cut {
        std::size_t at, left_out;  ///< where in xml(), and how many bytes up to there are missing
    };
    std::string xml_;
    std::vector<std::string_view> arrays_;
    std::vector<Cut> cuts_;
};

}  // namespace pliant::mesh

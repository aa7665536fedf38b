// STL files, text and binary.

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/core/files.hpp"
#include "base/core/letters.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/point_welder.hpp"

namespace pliant::mesh {
namespace {

constexpr std::size_t header_bytes = 80;
constexpr std::size_t facet_bytes = 50;

std::uint32_t read_u32(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    return value;
}

Result<SurfaceFile> parse_binary(std::string_view bytes, const std::string& name) {
    const std::uint32_t claimed = read_u32(bytes, header_bytes);
    const std::size_t present = (bytes.size() - header_bytes - 4) / facet_bytes;
    const std::size_t rest = (bytes.size() - header_bytes - 4) % facet_bytes;
    if (present == 0) return input_error("{}: holds no facets", name);
    if (claimed != present && rest != 0) {
        return input_error("{}: is not a complete STL file: it announces {} facets and has room for {}", name, claimed,
                           present);
    }
    SurfaceFile file;
    // The actual bytes decide; the count is only a claim.
    if (claimed != present) {
        file.warnings.push_back(fmt::format("{}: the header counts {} facets, the file holds {}; all of them were read",
                                            name, claimed, present));
    }
    if (rest != 0)
        file.warnings.push_back(fmt::format("{}: {} bytes after the last facet were passed over", name, rest));
    PointWelder welder;
    file.mesh.triangles.reserve(present);
    for (std::size_t f = 0; f < present; ++f) {
        std::array<int, 3> triangle{};
        for (std::size_t v = 0; v < 3; ++v) {
            std::array<float, 3> c{};
            for (std::size_t i = 0; i < 3; ++i) {
                c[i] = std::bit_cast<float>(read_u32(bytes, header_bytes + 4 + f * facet_bytes + 12 * (v + 1) + 4 * i));
            }
            const Vec3 p{c[0], c[1], c[2]};
            if (!is_finite(p)) return input_error("{}: facet {}: vertex {} is not finite", name, f + 1, v + 1);
            triangle[v] = welder.add(p);
        }
        file.mesh.triangles.push_back(triangle);
    }
    file.mesh.points = welder.take();
    return file;
}

/// Words of a text, with their line; words end at blanks, lines at "\n", "\r\n" or "\r".
class Words {
public:
    explicit Words(std::string_view text) : text_(text) {}

    /// The next word in lower case, or "".
    std::string next() {
        for (; at_ < text_.size() && is_blank(text_[at_]); ++at_) line_ += ends_line() ? 1 : 0;
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
        return lower_case(text_.substr(begin, std::min<std::size_t>(at_ - begin, 64)));
    }
    void skip_line() { at_ = std::min(text_.find_first_of("\r\n", at_), text_.size()); }
    [[nodiscard]] int line() const { return line_; }

private:
    static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\f' || c == '\v'; }
    /// In "\r\n" the second character ends the line, the first does not.
    [[nodiscard]] bool ends_line() const {
        return text_[at_] == '\n' || (text_[at_] == '\r' && text_.substr(at_ + 1, 1) != "\n");
    }
    std::string_view text_;
    std::size_t at_ = 0;
    int line_ = 1;
};

Result<double> to_number(const std::string& word, const std::string& name, int line) {
    const char* begin = word.data() + (!word.empty() && word.front() == '+' ? 1 : 0);
    double value = 0;
    const auto [end, code] = std::from_chars(begin, word.data() + word.size(), value);
    if (code == std::errc() && end == word.data() + word.size() && std::isfinite(value)) return value;
    return input_error_at(name, line, "\"{}\" is not a finite number", word);
}

class AsciiReader {
public:
    AsciiReader(std::string_view text, const std::string& name) : words_(text), name_(name) {}

    Result<SurfaceFile> read() {
        bool in_solid = false;
        int facet_end = 0;  // the line of the last "endfacet"
        for (std::string word = words_.next(); !word.empty(); word = words_.next()) {
            if (word == (in_solid ? "endsolid" : "solid")) {
                words_.skip_line();  // the rest of the line is the name
                in_solid = !in_solid;
            } else if (in_solid && word == "facet") {
                if (Status status = read_facet(); !status) return tl::unexpected(status.error());
                facet_end = words_.line();
            } else if (in_solid && words_.line() == facet_end) {
                ++strays_;
            } else {
                return input_error_at(name_, words_.line(), "\"{}\" has no place here; this is not a complete STL file",
                                      word);
            }
        }
        return finished(in_solid);
    }

private:
    Result<SurfaceFile> finished(bool in_solid) {
        if (file_.mesh.triangles.empty()) return input_error("{}: holds no facets", name_);
        if (strays_ > 0)
            file_.warnings.push_back(fmt::format("{}: {} word(s) after \"endfacet\" were passed over", name_, strays_));
        if (in_solid) file_.warnings.push_back(fmt::format("{}: the last solid is not closed by \"endsolid\"", name_));
        file_.mesh.points = welder_.take();
        return std::move(file_);
    }

    Status needs(const char* wanted) {
        const std::string word = words_.next();
        if (word == wanted) return {};
        return input_error_at(name_, words_.line(), "\"{}\" is needed here; found \"{}\"", wanted, word);
    }

    /// What follows "facet", up to and including "endfacet". The normal is ignored: it follows from the vertices, and
    /// may be wrong.
    Status read_facet() {
        constexpr int normal_words = 4;
        std::string word = words_.next();
        for (int i = 0; i < normal_words && word != "outer"; ++i) word = words_.next();
        if (word != "outer" || words_.next() != "loop")
            return input_error_at(name_, words_.line(), "\"outer loop\" is needed after \"facet\"");
        std::array<int, 3> triangle{};
        for (int& corner : triangle) {
            const Result<int> point = read_vertex();
            if (!point) return tl::unexpected(point.error());
            corner = *point;
        }
        for (const char* wanted : {"endloop", "endfacet"}) {
            if (Status status = needs(wanted); !status) return status;
        }
        file_.mesh.triangles.push_back(triangle);
        return {};
    }

    Result<int> read_vertex() {
        if (const std::string word = words_.next(); word != "vertex")
            return input_error_at(name_, words_.line(), "\"vertex\" is needed here, a facet has three; found \"{}\"",
                                  word);
        Vec3 p;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::string word = words_.next();
            const Result<double> number = to_number(word, name_, words_.line());
            if (!number) return tl::unexpected(number.error());
            file_.printed.see(word);
            p[i] = *number;
        }
        return welder_.add(p);
    }

    Words words_;
    const std::string& name_;
    PointWelder welder_;
    SurfaceFile file_;
    std::size_t strays_ = 0;
};

/// Binary files may begin with "solid", too: a text file has no zero bytes, and its second line begins with "facet" or
/// "endsolid".
bool looks_ascii(std::string_view bytes) {
    std::size_t begin = bytes.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return false;
    if (lower_case(bytes.substr(begin, 5)) != "solid") return false;
    return bytes.substr(0, 4096).find('\0') == std::string_view::npos;
}

}  // namespace

bool looks_like_stl(std::string_view bytes) {
    if (looks_ascii(bytes)) return true;
    if (bytes.size() < header_bytes + 4) return false;
    const std::uint32_t claimed = read_u32(bytes, header_bytes);
    const std::size_t present = (bytes.size() - header_bytes - 4) / facet_bytes;
    // Other text read as binary STL announces billions of facets, and its size does not match.
    const bool text = std::all_of(bytes.begin(), bytes.begin() + header_bytes,
                                  [](char c) { return c != '\0' && static_cast<unsigned char>(c) < 128; });
    return !text || claimed <= 10 * (present + 1);
}

Result<SurfaceFile> parse_stl(std::string_view bytes, const std::string& name) {
    if (bytes.empty()) return input_error("{}: the file is empty", name);
    if (!looks_like_stl(bytes)) return input_error("{}: is not an STL file", name);
    return looks_ascii(bytes) ? AsciiReader(bytes, name).read() : parse_binary(bytes, name);
}

Status write_stl(const std::filesystem::path& path, const TriMesh& mesh) {
    std::string bytes(header_bytes, '\0');
    const auto put = [&](std::uint32_t value) {
        for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i));
    };
    put(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
        const Vec3 normal = cross(mesh.points[t[1]] - mesh.points[t[0]], mesh.points[t[2]] - mesh.points[t[0]]);
        const Vec3 unit = norm(normal) > 0 ? normal / norm(normal) : Vec3{};
        for (const Vec3& v : {unit, mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]}) {
            for (const double c : {v.x, v.y, v.z}) put(std::bit_cast<std::uint32_t>(static_cast<float>(c)));
        }
        bytes += std::string(2, '\0');
    }
    return write_file(path, bytes);
}

}  // namespace pliant::mesh

// STL files, text and binary.

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/files.hpp"
#include "mesh/point_welder.hpp"
#include "mesh/surface_file.hpp"

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
    // The bytes are what is there; the count is only a claim.
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

/// Words of a text with their line; words end at blanks.
class Words {
public:
    explicit Words(std::string_view text) : text_(text) {}

    /// The next word in lower case, or "".
    std::string next() {
        while (at_ < text_.size() && is_blank(text_[at_])) line_ += text_[at_++] == '\n' ? 1 : 0;
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
        std::string word(text_.substr(begin, std::min<std::size_t>(at_ - begin, 64)));
        std::transform(word.begin(), word.end(), word.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return word;
    }
    void skip_line() {
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    }
    [[nodiscard]] int line() const { return line_; }

private:
    static bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\f' || c == '\v'; }
    std::string_view text_;
    std::size_t at_ = 0;
    int line_ = 1;
};

Result<double> to_number(const std::string& word, const std::string& name, int line) {
    const char* begin = word.data() + (!word.empty() && word.front() == '+' ? 1 : 0);
    double value = 0;
    const auto [end, code] = std::from_chars(begin, word.data() + word.size(), value);
    if (code == std::errc() && end == word.data() + word.size() && std::isfinite(value)) return value;
    return input_error("{}:{}: \"{}\" is not a finite number", name, line, word);
}

/// The three vertices after "outer loop", up to and with "endfacet".
Result<std::array<int, 3>> parse_loop(Words& words, const std::string& name, PointWelder& welder) {
    std::array<int, 3> triangle{};
    for (int v = 0; v < 3; ++v) {
        const std::string word = words.next();
        if (word != "vertex")
            return input_error("{}:{}: \"vertex\" is needed here, a facet has three; found \"{}\"", name, words.line(),
                               word);
        Vec3 p;
        for (std::size_t i = 0; i < 3; ++i) {
            const Result<double> number = to_number(words.next(), name, words.line());
            if (!number) return tl::unexpected(number.error());
            p[i] = *number;
        }
        triangle[static_cast<std::size_t>(v)] = welder.add(p);
    }
    for (const char* wanted : {"endloop", "endfacet"}) {
        const std::string word = words.next();
        if (word != wanted)
            return input_error("{}:{}: \"{}\" is needed here; found \"{}\"", name, words.line(), wanted, word);
    }
    return triangle;
}

Result<SurfaceFile> parse_ascii(std::string_view text, const std::string& name) {
    Words words(text);
    PointWelder welder;
    SurfaceFile file;
    bool in_solid = false;
    for (std::string word = words.next(); !word.empty(); word = words.next()) {
        if (!in_solid && word == "solid") {
            words.skip_line();  // the rest of the line is the name, whatever it says
            in_solid = true;
        } else if (in_solid && word == "endsolid") {
            words.skip_line();
            in_solid = false;
        } else if (in_solid && word == "facet") {
            words.skip_line();  // the normal follows from the vertices, and may be nonsense
            if (words.next() != "outer" || words.next() != "loop")
                return input_error("{}:{}: \"outer loop\" is needed after \"facet\"", name, words.line());
            const auto triangle = parse_loop(words, name, welder);
            if (!triangle) return tl::unexpected(triangle.error());
            file.mesh.triangles.push_back(*triangle);
        } else {
            return input_error("{}:{}: \"{}\" has no place here; this is not a complete STL file", name, words.line(),
                               word);
        }
    }
    if (file.mesh.triangles.empty()) return input_error("{}: holds no facets", name);
    if (in_solid) file.warnings.push_back(fmt::format("{}: the last solid is not closed by \"endsolid\"", name));
    file.mesh.points = welder.take();
    return file;
}

/// Binary files may begin with "solid" too: a text file has no zero bytes, and its second word line is "facet" or
/// "endsolid".
bool looks_ascii(std::string_view bytes) {
    std::size_t begin = bytes.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return false;
    std::string head(bytes.substr(begin, 5));
    std::transform(head.begin(), head.end(), head.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (head != "solid") return false;
    return bytes.substr(0, 4096).find('\0') == std::string_view::npos;
}

}  // namespace

bool looks_like_stl(std::string_view bytes) {
    if (looks_ascii(bytes)) return true;
    if (bytes.size() < header_bytes + 4) return false;
    const std::uint32_t claimed = read_u32(bytes, header_bytes);
    const std::size_t present = (bytes.size() - header_bytes - 4) / facet_bytes;
    // Text of another kind read as binary claims billions of facets, and its size does not fit.
    const bool text = std::all_of(bytes.begin(), bytes.begin() + header_bytes,
                                  [](char c) { return c != '\0' && static_cast<unsigned char>(c) < 128; });
    return !text || claimed <= 10 * (present + 1);
}

Result<SurfaceFile> parse_stl(std::string_view bytes, const std::string& name) {
    if (bytes.empty()) return input_error("{}: the file is empty", name);
    if (!looks_like_stl(bytes)) return input_error("{}: is not an STL file", name);
    return looks_ascii(bytes) ? parse_ascii(bytes, name) : parse_binary(bytes, name);
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

// PLY, the Stanford polygon format: a text header that lists elements and their properties, then their values.
#include <cmath>
#include <cstdint>
#include <optional>

#include "geometry/files/number_type.hpp"
#include "geometry/files/surface_collector.hpp"

namespace pliant::mesh {
namespace {

std::optional<NumberType> ply_number_type(std::string_view name) {
    if (name == "char" || name == "int8") return NumberType{1, false, true};
    if (name == "uchar" || name == "uint8") return NumberType{1, false, false};
    if (name == "short" || name == "int16") return NumberType{2, false, true};
    if (name == "ushort" || name == "uint16") return NumberType{2, false, false};
    if (name == "int" || name == "int32") return NumberType{4, false, true};
    if (name == "uint" || name == "uint32") return NumberType{4, false, false};
    if (name == "float" || name == "float32") return NumberType{4, true, true};
    if (name == "double" || name == "float64") return NumberType{8, true, true};
    return std::nullopt;
}

struct Property {
    std::string name;
    NumberType type;
    std::optional<NumberType> count;  ///< for a list: the type of its length
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

/// Reads values one after the other, from text or bytes.
class Values {
public:
    enum class Encoding { text, little, big };

    Values(std::string_view bytes, std::size_t begin, TextScanner scan, Encoding encoding)
        : bytes_(bytes), at_(begin), scan_(std::move(scan)), encoding_(encoding) {}

    Result<double> next(const NumberType& type) {
        if (encoding_ == Encoding::text) return scan_.number();
        if (type.width > bytes_.size() - at_) return scan_.error("the file ends in the middle of its values");
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < type.width; ++i) {
            const std::size_t k = encoding_ == Encoding::big ? i : type.width - 1 - i;
            bits = bits << 8U | static_cast<unsigned char>(bytes_[at_ + k]);
        }
        at_ += type.width;
        return number_of_bits(type, bits);
    }
    /// With the line for text; binary values have none.
    tl::unexpected<Error> error(std::string_view text) const { return scan_.error(text); }
    /// The word of the last value; "" for binary values.
    std::string_view printed() const { return encoding_ == Encoding::text ? scan_.last_word() : std::string_view(); }

private:
    std::string_view bytes_;
    std::size_t at_;
    TextScanner scan_;
    Encoding encoding_;
};

class PlyReader {
public:
    PlyReader(std::string_view bytes, std::string name) : bytes_(bytes), scan_(bytes, std::move(name)) {}

    Result<SurfaceFile> read() {
        if (Status status = read_header(); !status) return tl::unexpected(status.error());
        Values values(bytes_, scan_.position(), scan_, encoding_);
        for (const Element& element : elements_) {
            // A header may claim any number of rows without values: skip them.
            if (element.properties.empty()) continue;
            for (std::size_t row = 0; row < element.count; ++row) {
                if (Status status = read_row(element, row, values); !status) return tl::unexpected(status.error());
            }
        }
        if (surface_.file().mesh.triangles.empty()) return values.error("holds no faces");
        return surface_.take();
    }

private:
    Status read_header() {
        scan_.rest_of_line();  // "ply"
        bool has_format = false;
        while (!scan_.at_end()) {
            const std::string_view keyword = scan_.word_of_line();
            Status status;
            if (keyword == "end_header") {
                scan_.rest_of_line();
                return has_format ? Status{} : scan_.error("the header names no format");
            }
            if (keyword == "format") {
                status = read_format();
                has_format = true;
            } else if (keyword == "element") {
                status = read_element();
            } else if (keyword == "property") {
                status = read_property();
            } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
                return scan_.error(fmt::format("unknown keyword \"{}\" in the PLY header", keyword.substr(0, 40)));
            }
            if (!status) return status;
            scan_.rest_of_line();
        }
        return scan_.error("the file ends in the middle of its header");
    }

    Status read_format() {
        const std::string_view format = scan_.word_of_line();
        if (format == "ascii")
            encoding_ = Values::Encoding::text;
        else if (format == "binary_little_endian")
            encoding_ = Values::Encoding::little;
        else if (format == "binary_big_endian")
            encoding_ = Values::Encoding::big;
        else
            return scan_.error(fmt::format("unknown format \"{}\"", format.substr(0, 40)));
        return {};
    }

    Status read_element() {
        Element element;
        element.name = scan_.word_of_line();
        const Result<std::size_t> count = scan_.count(1);
        if (!count) return tl::unexpected(count.error());
        element.count = *count;
        elements_.push_back(std::move(element));
        return {};
    }

    Status read_property() {
        if (elements_.empty()) return scan_.error("a property before any element");
        Property property;
        std::string_view type = scan_.word_of_line();
        if (type == "list") {
            property.count = ply_number_type(scan_.word_of_line());
            if (!property.count || property.count->floating)
                return scan_.error("the length of a list needs a type of whole numbers");
            type = scan_.word_of_line();
        }
        const auto known = ply_number_type(type);
        if (!known) return scan_.error(fmt::format("unknown type \"{}\"", type.substr(0, 40)));
        property.type = *known;
        property.name = scan_.word_of_line();
        elements_.back().properties.push_back(std::move(property));
        return {};
    }

    Status read_row(const Element& element, std::size_t row, Values& values) {
        const bool is_vertex = element.name == "vertex";
        Vec3 p;
        for (const Property& property : element.properties) {
            if (property.count) {
                if (Status status = read_list(element, property, row, values); !status) return status;
                continue;
            }
            const Result<double> value = values.next(property.type);
            if (!value) return tl::unexpected(value.error());
            if (!is_vertex || property.name.size() != 1) continue;
            const auto axis = std::string_view("xyz").find(property.name);
            if (axis == std::string_view::npos) continue;
            p[axis] = *value;
            surface_.file().printed.see(values.printed());
        }
        if (!is_vertex) return {};
        if (!is_finite(p)) return values.error(fmt::format("vertex {} is not finite", row));
        surface_.add_vertex(p);
        return {};
    }

    Status read_list(const Element& element, const Property& property, std::size_t row, Values& values) {
        const Result<double> length = values.next(*property.count);
        if (!length) return tl::unexpected(length.error());
        const bool face =
            element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index");
        if (*length < (face ? 3 : 0) || *length != std::floor(*length))
            return values.error(fmt::format("{} {} has {} corners", element.name, row, *length));
        if (face) surface_.begin_face();
        for (double k = 0; k < *length; ++k) {
            const Result<double> value = values.next(property.type);
            if (!value) return tl::unexpected(value.error());
            if (!face) continue;
            const std::size_t there = surface_.vertex_count();
            if (!(*value >= 0 && *value < static_cast<double>(there) && *value == std::floor(*value)))
                return values.error(fmt::format("face {} names vertex {}, there are {}", row, *value, there));
            surface_.add_corner(static_cast<std::size_t>(*value));
        }
        return {};
    }

    std::string_view bytes_;
    TextScanner scan_;
    Values::Encoding encoding_ = Values::Encoding::text;
    std::vector<Element> elements_;
    SurfaceCollector surface_;
};

}  // namespace

Result<SurfaceFile> parse_ply(std::string_view bytes, const std::string& name) {
    return PlyReader(bytes, name).read();
}

}  // namespace pliant::mesh

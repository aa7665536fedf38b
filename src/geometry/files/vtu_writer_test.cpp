#include "geometry/files/vtu_writer.hpp"

#include <doctest/doctest.h>
#include <libdeflate.h>

#include <cstring>
#include <memory>

#include "base/core/base64.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

TetMesh one_tet() {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.nodes = {0, 1, 2, 3};
    mesh.region = {0};
    mesh.region_names = {"a"};
    return mesh;
}

std::string decoded(std::string_view text) {
    std::string bytes;
    unsigned group = 0;
    int bits = 0;
    for (const char c : text) {
        static const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        const auto value = alphabet.find(c);
        if (value == std::string::npos) break;
        group = group << 6 | static_cast<unsigned>(value);
        if ((bits += 6) >= 8) bytes += static_cast<char>(group >> (bits -= 8) & 255U);
    }
    return bytes;
}

/// The values of an array that fits in one block.
template <class T>
std::vector<T> values_of(const std::string& file, const std::string& name) {
    const std::size_t tag = file.find("Name=\"" + name + "\"");
    REQUIRE(tag != std::string::npos);
    const std::size_t begin = file.find(">\n", tag) + 2;
    const std::string text = file.substr(begin, file.find('\n', begin) - begin);
    std::uint64_t header[4];
    const std::string header_bytes = decoded(text.substr(0, 44));
    REQUIRE(header_bytes.size() == sizeof header);
    std::memcpy(header, header_bytes.data(), sizeof header);
    REQUIRE(header[0] == 1);
    const std::string blocks = decoded(text.substr(44));
    CHECK(blocks.size() == header[3]);
    std::vector<T> values(header[2] / sizeof(T));
    std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> state(libdeflate_alloc_decompressor(),
                                                                                       &libdeflate_free_decompressor);
    REQUIRE(libdeflate_zlib_decompress(state.get(), blocks.data(), blocks.size(), values.data(), header[2], nullptr) ==
            LIBDEFLATE_SUCCESS);
    return values;
}

}  // namespace

TEST_CASE("a VTK file holds the given points, cells and data") {
    const std::vector<Vec3> moved = {{0, 0, 0}, {10.5, 0, 0}, {0, 11, 0}, {0, 0, 12.25}};
    VtuData data;
    data.points.push_back({"displacement", 3, std::vector<float>{0, 0, 0, 1, 2, 3, 0, 0, 0, 0, 0, 4}});
    data.cells.push_back({"J", 1, std::vector<double>{0.875}});
    data.cells.push_back({"region", 1, std::vector<std::int32_t>{0}});
    const auto file = vtu_text(one_tet(), moved, data);
    REQUIRE(file.has_value());
    CHECK(values_of<double>(*file, "Points") == std::vector<double>{0, 0, 0, 10.5, 0, 0, 0, 11, 0, 0, 0, 12.25});
    CHECK(values_of<std::int32_t>(*file, "connectivity") == std::vector<std::int32_t>{0, 1, 2, 3});
    CHECK(values_of<std::int32_t>(*file, "offsets") == std::vector<std::int32_t>{4});
    CHECK(values_of<std::uint8_t>(*file, "types") == std::vector<std::uint8_t>{10});
    CHECK(values_of<float>(*file, "displacement")[5] == 3.0F);
    CHECK(values_of<double>(*file, "J") == std::vector<double>{0.875});
    CHECK(file->find("NumberOfPoints=\"4\" NumberOfCells=\"1\"") != std::string::npos);
}

TEST_CASE("quadratic tets are cell type 24 with ten nodes") {
    const TetMesh mesh = to_quadratic(one_tet());
    const auto file = vtu_text(mesh, mesh.points, {});
    REQUIRE(file.has_value());
    CHECK(values_of<std::uint8_t>(*file, "types") == std::vector<std::uint8_t>{24});
    CHECK(values_of<std::int32_t>(*file, "offsets") == std::vector<std::int32_t>{10});
    CHECK(values_of<std::int32_t>(*file, "connectivity") == mesh.nodes);
}

TEST_CASE("names are escaped and arrays that do not fit are refused") {
    VtuData data;
    data.cells.push_back({"a<b>&\"c\"", 1, std::vector<double>{1}});
    const TetMesh mesh = one_tet();
    const auto file = vtu_text(mesh, mesh.points, data);
    REQUIRE(file.has_value());
    CHECK(file->find("Name=\"a&lt;b&gt;&amp;&quot;c&quot;\"") != std::string::npos);
    data.cells[0].values = std::vector<double>{1, 2};
    const auto refused = vtu_text(mesh, mesh.points, data);
    REQUIRE_FALSE(refused.has_value());
    CHECK(refused.error().message.find("2 values, but 1 items") != std::string::npos);
    CHECK_FALSE(vtu_text(mesh, std::vector<Vec3>(3), {}).has_value());
}

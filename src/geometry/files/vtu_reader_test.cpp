#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "base/core/base64.hpp"
#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/vtu_writer.hpp"
#include "geometry/mesh/test_tets.hpp"

using namespace pliant;
using namespace pliant::mesh;
using pliant::test::replaced;

namespace {

TetMesh tets_with_markup() {
    return mesh::test::two_tets("soft foam", "grip & <tip>");
}

std::string vtu_problem(std::string_view text) {
    const Result<TetMesh> mesh = parse_vtu(text, "a.vtu");
    return mesh ? "" : mesh.error().message;
}

template <class Number>
std::string bytes_of(const std::vector<Number>& values, bool big_endian) {
    std::string bytes;
    for (const Number value : values) {
        const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
        if (big_endian)
            bytes.append(raw.rbegin(), raw.rend());
        else
            bytes.append(raw.begin(), raw.end());
    }
    return bytes;
}

/// A 32-bit byte count, then the bytes.
template <class Number>
std::string counted_bytes(const std::vector<Number>& values, bool big_endian) {
    const std::string bytes = bytes_of(values, big_endian);
    return bytes_of<std::uint32_t>({static_cast<std::uint32_t>(bytes.size())}, big_endian) + bytes;
}

const std::vector<float> points = {9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
const std::vector<std::int64_t> connectivity = {1, 2, 3, 1, 3, 2, 4};  // a triangle, an inside-out tet
const std::vector<std::int64_t> offsets = {3, 7};
const std::vector<std::uint8_t> types = {5, 10};

/// A file whose arrays are encoded by `array`.
template <class Array>
std::string file(bool big_endian, const Array& array, const std::string& appended = "") {
    return std::string("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"") +
           (big_endian ? "BigEndian" : "LittleEndian") +
           "\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<Points>\n" +
           array("Float32", "Points", counted_bytes(points, big_endian)) + "</Points>\n<Cells>\n" +
           array("Int64", "connectivity", counted_bytes(connectivity, big_endian)) +
           array("Int64", "offsets", counted_bytes(offsets, big_endian)) +
           array("UInt8", "types", counted_bytes(types, big_endian)) + "</Cells>\n</Piece>\n</UnstructuredGrid>\n" +
           appended + "</VTKFile>\n";
}

std::string inline_base64(const std::string& type, const std::string& name, const std::string& bytes) {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"binary\">\n  " + base64(bytes) +
           "\n</DataArray>\n";
}

const std::string text_file =
    "<VTKFile type=\"UnstructuredGrid\">\n<UnstructuredGrid>\n<Piece>\n<Points><DataArray type=\"Float64\" "
    "format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\n<Cells><DataArray type=\"Int32\" "
    "Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" "
    "format=\"ascii\">4</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" "
    "format=\"ascii\">10</DataArray></Cells>\n<CellData><DataArray type=\"Int32\" Name=\"material\" "
    "format=\"ascii\">-3</DataArray></CellData></Piece></UnstructuredGrid></VTKFile>";

}  // namespace

TEST_CASE("compressed files are read back as written, with region names") {
    for (const TetMesh& mesh : {tets_with_markup(), to_quadratic(tets_with_markup())}) {
        VtuData data;
        data.cells.push_back({"region", 1, std::vector<std::int32_t>(mesh.region.begin(), mesh.region.end())});
        data.region_names = mesh.region_names;
        const Result<TetMesh> back = parse_tet_mesh(*vtu_text(mesh, mesh.points, data), "a.vtu");
        REQUIRE_MESSAGE(back, (back ? "" : back.error().message));
        CHECK(back->order == mesh.order);
        CHECK(back->region == mesh.region);
        CHECK(back->region_names == mesh.region_names);
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            for (std::size_t a = 0; a < mesh.tet(t).size(); ++a)
                CHECK(back->points[back->tet(t)[a]] == mesh.points[mesh.tet(t)[a]]);
        }
    }
}

TEST_CASE("arrays in the file and appended, base64 and raw, of both byte orders are read") {
    for (const bool big_endian : {false, true}) {
        std::string raw;
        std::string encoded;
        const auto to_raw = [&](const std::string& type, const std::string& name, const std::string& bytes) {
            const std::string tag = "<DataArray type=\"" + type + "\" Name=\"" + name +
                                    "\" format=\"appended\" offset=\"" + std::to_string(raw.size()) + "\"/>\n";
            raw += bytes;
            return tag;
        };
        const auto to_encoded = [&](const std::string& type, const std::string& name, const std::string& bytes) {
            const std::string tag = "<DataArray type=\"" + type + "\" Name=\"" + name +
                                    "\" format=\"appended\" offset=\"" + std::to_string(encoded.size()) + "\"/>\n";
            encoded += base64(bytes);
            return tag;
        };
        file(big_endian, to_raw);  // once for the data, once for the file that ends with them
        file(big_endian, to_encoded);
        const std::string raw_part =
            "<AppendedData encoding=\"raw\">\n_" + std::exchange(raw, "") + "\n</AppendedData>\n";
        const std::string encoded_part =
            "<AppendedData encoding=\"base64\">\n _" + std::exchange(encoded, "") + "\n</AppendedData>\n";
        for (const std::string& text : {file(big_endian, inline_base64), file(big_endian, to_raw, raw_part),
                                        file(big_endian, to_encoded, encoded_part)}) {
            const Result<TetMesh> mesh = parse_vtu(text, "a.vtu");
            REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
            CHECK(mesh->points.size() == 4);
            CHECK(mesh->tet_count() == 1);
            CHECK(volume(*mesh) == near(1.0 / 6, {.relative = 1e-12}));
            CHECK(mesh->region_names == std::vector<std::string>{"0"});
        }
    }
}

TEST_CASE("text arrays and several pieces are read") {
    const Result<TetMesh> one = parse_vtu(text_file, "a.vtu");
    REQUIRE_MESSAGE(one, (one ? "" : one.error().message));
    CHECK(one->region_names == std::vector<std::string>{"-3"});
    const std::size_t begin = text_file.find("<Piece>");
    const std::string piece = text_file.substr(begin, text_file.find("</UnstructuredGrid>") - begin);
    const std::string moved =
        replaced(replaced(piece, "-3<", "5<"), "0 0 0 1 0 0 0 1 0 0 0 1", "0 0 9 1 0 9 0 1 9 0 0 10");
    const Result<TetMesh> two = parse_vtu(replaced(text_file, piece, piece + moved), "a.vtu");
    REQUIRE_MESSAGE(two, (two ? "" : two.error().message));
    CHECK(two->points.size() == 8);
    CHECK(two->notes.empty());
    CHECK(volume(*two) == near(2.0 / 6, {.relative = 1e-12}));
    CHECK(two->region == std::vector<int>{0, 1});
}

TEST_CASE("pieces share the points that they repeat, a piece keeps its own apart") {
    const std::size_t begin = text_file.find("<Piece>");
    const std::string piece = text_file.substr(begin, text_file.find("</UnstructuredGrid>") - begin);
    const auto joined = [&](const std::string& first, const std::string& second) {
        Result<TetMesh> mesh = parse_vtu(replaced(text_file, piece, first + second), "a.vtu");
        REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
        return std::move(*mesh);
    };
    // The second tet is on the other side of the slanted face; a point that no tet uses counts for nothing.
    const std::string other = replaced(piece, "0 0 0 1 0 0 0 1 0 0 0 1", "1 0 0 0 1 0 0 0 1 1 1 1 0 0 0");
    const TetMesh two = joined(piece, other);
    CHECK(two.points.size() == 5);
    CHECK(two.tet_count() == 2);
    REQUIRE(two.notes.size() == 1);
    CHECK(two.notes.front() ==
          "3 points of its 2 pieces lie exactly at points of other pieces: they were joined with them");
    // Two tets of one piece on both sides of a crack, with points of their own; the next piece joins neither.
    std::string cracked = replaced(piece, "0 0 0 1 0 0 0 1 0 0 0 1", "0 0 0 1 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 1 1 1 1");
    for (const auto& [from, to] :
         {std::pair("0 1 2 3<", "0 1 2 3 4 5 6 7<"), {">4<", ">4 8<"}, {">10<", ">10 10<"}, {">-3<", ">-3 -3<"}})
        cracked = replaced(cracked, from, to);
    const TetMesh three = joined(cracked, replaced(piece, "0 0 0 1 0 0 0 1 0 0 0 1", "0 0 0 1 0 0 0 1 0 0 0 -1"));
    CHECK(three.tet_count() == 3);
    CHECK(three.points.size() == 11);
}

TEST_CASE("damaged files give a reason, and stated sizes are not trusted") {
    CHECK(vtu_problem("<VTKFile type=\"UnstructuredGrid\">\n<oops></VTKFile>").find("a.vtu:2: is not well-formed") ==
          0);
    CHECK(vtu_problem("<VTKFile type=\"PolyData\"><PolyData/></VTKFile>")
              .find("only VTKFile type=\"UnstructuredGrid\"") != std::string::npos);
    CHECK(vtu_problem(replaced(text_file, "0 1 2 3<", "0 1 2 9<")).find("names point 9, there are 4") !=
          std::string::npos);
    CHECK(vtu_problem(replaced(text_file, "0 1 2 3<", "0 1 2 2<")).find("point 2 twice") != std::string::npos);
    CHECK(vtu_problem(replaced(text_file, "0 1 2 3<", "0 1 2 x<")).find("a.vtu:5: \"x\" is not a number") == 0);
    CHECK(vtu_problem(replaced(text_file, "0 0 0 1 0", "nan 0 0 1 0")).find("point 0 is not finite") !=
          std::string::npos);
    CHECK(vtu_problem(replaced(text_file, ">4<", ">400<")).find("offsets of the cells do not fit") !=
          std::string::npos);
    CHECK(vtu_problem(replaced(text_file, ">4<", ">3<")).find("has 3 nodes") != std::string::npos);
    CHECK(vtu_problem(replaced(text_file, ">10<", ">12<")).find("holds no tetrahedra") != std::string::npos);
    CHECK(vtu_problem(replaced(text_file, "connectivity", "connections")).find("Cells connectivity is missing") !=
          std::string::npos);
    CHECK(vtu_problem(replaced(text_file, "Int32", "Int24")).find("unknown type \"Int24\"") != std::string::npos);
    CHECK(vtu_problem("<VTKFile compressor=\"vtkLZ4DataCompressor\"><UnstructuredGrid/></VTKFile>").find("LZ4") !=
          std::string::npos);
    const std::string claims = bytes_of<std::uint32_t>({0xffffffffu, 0xffffffffu, 0, 8}, false);
    const std::string packed =
        replaced(file(false, inline_base64), "byte_order", "compressor=\"vtkZLibDataCompressor\" byte_order");
    CHECK(vtu_problem(packed).find("damaged") != std::string::npos);
    for (const std::string& header : {claims, bytes_of<std::uint32_t>({1, 0xffffffffu, 0, 4, 0}, false)}) {
        const std::string good = base64(counted_bytes(points, false));
        CHECK(vtu_problem(replaced(packed, good, base64(header))).find("damaged or cut off") != std::string::npos);
    }
}

TEST_CASE("arrays of many blocks, and errors after them name their line") {
    TetMesh many = tets_with_markup();
    const TetMesh two = many;
    for (int copy = 1; copy < 30000; ++copy) {
        const auto first = static_cast<int>(many.points.size());
        for (const Vec3& p : two.points) many.points.push_back({p.x + 3 * copy, p.y, p.z / 3});
        for (const int node : two.nodes) many.nodes.push_back(first + node);
        many.region.insert(many.region.end(), two.region.begin(), two.region.end());
    }
    VtuData data;
    data.cells.push_back({"region", 1, std::vector<std::int32_t>(many.region.begin(), many.region.end())});
    const std::string text = *vtu_text(many, many.points, data);
    const Result<TetMesh> back = parse_vtu(text, "a.vtu");
    REQUIRE_MESSAGE(back, (back ? "" : back.error().message));
    CHECK(back->tet_count() == many.tet_count());
    CHECK(back->region == many.region);
    CHECK(volume(*back) == near(volume(many), {.relative = 1e-12}));
    const auto line_of = [&](std::string_view word) {
        return std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<long>(text.find(word)), '\n'));
    };
    CHECK(vtu_problem(replaced(text, "</CellData>", "</Oops>")).find("a.vtu:" + line_of("</CellData>") + ": is not") ==
          0);
    const std::string types = "type=\"UInt8\" Name=\"types\"";
    CHECK(vtu_problem(replaced(text, types, "type=\"UInt9\" Name=\"types\"")).find("a.vtu:" + line_of(types)) == 0);
    // A byte of a block in the middle of the connectivity.
    std::string damaged = text;
    damaged[text.find("Name=\"connectivity\"") + 40000] ^= 1;
    CHECK(vtu_problem(damaged).find("damaged or cut off") != std::string::npos);
}

TEST_CASE("no truncated file crashes the reader") {
    const TetMesh mesh = tets_with_markup();
    const std::string whole = *vtu_text(mesh, mesh.points, {});
    for (std::size_t length = 0; length < whole.size() - 12; ++length)
        CHECK_FALSE(parse_vtu(whole.substr(0, length), "a"));
}

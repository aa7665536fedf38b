#include "geometry/threemf/read_3mf.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/zip/zip_file.hpp"

using namespace pliant;
using namespace pliant::threemf;

namespace {

constexpr const char* head =
    "<?xml version=\"1.0\"?>\n<model unit=\"centimeter\" "
    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
    "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" "
    "xmlns:s=\"http://schemas.microsoft.com/3dmanufacturing/slice/2015/07\">\n";

/// A tetrahedron of volume 1/6 with a corner at (x, 0, 0); `property` goes to each triangle.
std::string tet(double x, int first, const std::string& property, bool vertices) {
    std::string text;
    if (vertices) {
        for (const auto& [dx, y, z] : {std::array{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
            text += fmt::format("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", x + dx, y, z);
        return text;
    }
    for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}})
        text +=
            fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\" {}/>\n", first + a, first + b, first + c, property);
    return text;
}

std::string object(int id, const std::string& attributes, const std::string& second_property = "") {
    const bool two = !second_property.empty();
    return fmt::format(
        "<object id=\"{}\" {}><mesh><vertices>{}{}</vertices><triangles>{}{}</triangles></mesh></object>\n", id,
        attributes, tet(0, 0, "", true), two ? tet(5, 4, "", true) : "", tet(0, 0, "", false),
        two ? tet(5, 4, second_property, false) : "");
}

std::string model(const std::string& resources, const std::string& build) {
    return fmt::format("{}<resources>\n{}</resources>\n<build>{}</build></model>", head, resources, build);
}

ThreeMf read(const std::string& text) {
    const auto result = parse_3mf_model(text, "a.3mf");
    REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
    return *result;
}

std::string refused(const std::string& text) {
    const auto result = parse_3mf_model(text, "a.3mf");
    REQUIRE(!result.has_value());
    return result.error().message;
}

constexpr const char* materials =
    "<basematerials id=\"1\"><base name=\"soft\" displaycolor=\"#FF0000\"/>"
    "<base name=\"rigid\" displaycolor=\"#0000ffff\"/></basematerials>"
    "<m:colorgroup id=\"2\"><m:color color=\"#00a0e8FF\"/></m:colorgroup>\n";

}  // namespace

TEST_CASE("units, transforms and components place a body; a mirrored one keeps its volume") {
    const std::string assembly =
        "<object id=\"8\"><components><component objectid=\"7\" transform=\"2 0 0 0 1 0 0 0 1 10 0 0\"/>"
        "<component objectid=\"7\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/></components></object>";
    const ThreeMf file =
        read(model(object(7, "") + assembly, "<item objectid=\"8\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 3\"/>"));
    REQUIRE(file.bodies.size() == 2);
    CHECK(file.items == 1);
    CHECK(file.bodies[0].name == "object 7");
    CHECK(file.bodies[0].material == "default");
    CHECK(mesh::signed_volume(file.bodies[0].mesh_mm) == near(2000.0 / 6, {.relative = 1e-12}));
    CHECK(mesh::signed_volume(file.bodies[1].mesh_mm) == near(1000.0 / 6, {.relative = 1e-12}));
    // The corner at 0 goes to x = 10 cm, a quarter turn rotates that to y, then it moves up by 3 cm.
    CHECK(norm(file.bodies[0].mesh_mm.points[0] - Vec3{0, 100, 30}) < 1e-9);
}

TEST_CASE("shells of one property are separate bodies; a shell of several properties is one, with a warning") {
    const ThreeMf file = read(model(materials + object(7, "pid=\"1\" pindex=\"0\" name=\"pair\"", "pid=\"2\" p1=\"0\""),
                                    "<item objectid=\"7\"/>"));
    REQUIRE(file.bodies.size() == 2);
    CHECK(file.bodies[0].material == "#00A0E8");
    CHECK(file.bodies[1].material == "soft");
    CHECK(file.bodies[1].mesh_mm.points.size() == 4);
    CHECK(file.warnings.empty());
    std::string painted = object(7, "pid=\"1\" pindex=\"0\"", "pid=\"1\" p1=\"1\"");
    painted.insert(painted.rfind("<triangle ") + 10, "pid=\"2\" p1=\"0\" ");
    painted.erase(painted.find("pid=\"1\" p1=\"1\"", painted.rfind("<triangle ")), 14);
    const ThreeMf mixed = read(model(materials + painted, "<item objectid=\"7\"/>"));
    CHECK(mixed.bodies.size() == 1);
    REQUIRE(mixed.warnings.size() == 1);
    CHECK(mixed.warnings[0] ==
          "a.3mf: object 7: its triangles name 3 materials or colours that do not bound volumes; it is printed in "
          "\"soft\"");
}

TEST_CASE("a body may be given by a slice stack") {
    const std::string stack =
        "<s:slicestack id=\"3\" zbottom=\"1\"><s:slice ztop=\"2\"><s:vertices><s:vertex x=\"0\" y=\"0\"/><s:vertex "
        "x=\"1\" "
        "y=\"0\"/><s:vertex x=\"0\" y=\"1\"/></s:vertices><s:polygon startv=\"0\"><s:segment v2=\"1\"/><s:segment "
        "v2=\"2\"/><s:segment v2=\"0\"/></s:polygon></s:slice></s:slicestack>";
    const ThreeMf file = read(model(stack + object(7, "s:slicestackid=\"3\""),
                                    "<item objectid=\"7\" transform=\"1 0 0 0 1 0 0 0 1 0 5 0\"/>"));
    REQUIRE(file.bodies[0].slices.size() == 1);
    const Slice& slice = file.bodies[0].slices[0];
    CHECK(slice.bottom_mm == 10);
    CHECK(slice.top_mm == 20);
    REQUIRE(slice.contours.size() == 1);
    CHECK(slice.contours[0] == Contour{{0, 50}, {10, 50}, {0, 60}});
    CHECK(refused(model(stack + object(7, "s:slicestackid=\"4\""), "")).find("no slice stack 4") != std::string::npos);
}

TEST_CASE("a polygon of a slice that encloses nothing is left out with a warning") {
    const std::string stack =
        "<s:slicestack id=\"3\"><s:slice ztop=\"2\"><s:vertices><s:vertex x=\"0\" y=\"0\"/><s:vertex x=\"1\" y=\"0\"/>"
        "<s:vertex x=\"0\" y=\"1\"/></s:vertices>"
        "<s:polygon startv=\"0\"><s:segment v2=\"1\"/><s:segment v2=\"0\"/></s:polygon>"
        "<s:polygon startv=\"0\"><s:segment v2=\"1\"/><s:segment v2=\"2\"/><s:segment v2=\"0\"/></s:polygon>"
        "<s:polygon startv=\"2\"/></s:slice></s:slicestack>";
    const ThreeMf file = read(model(stack + object(7, "s:slicestackid=\"3\""), "<item objectid=\"7\"/>"));
    REQUIRE(file.bodies[0].slices.size() == 1);
    CHECK(file.bodies[0].slices[0].contours.size() == 1);
    REQUIRE(file.warnings.size() == 1);
    CHECK(file.warnings[0] ==
          "a.3mf:4: <s:slicestack>: 2 polygon(s) of fewer than three points enclose nothing and were left out");
}

TEST_CASE("an item that is excluded from printing is left out, with a note") {
    const std::string two = object(7, "") + object(8, "");
    const ThreeMf file = read(model(two, "<item objectid=\"7\" printable=\"0\"/><item objectid=\"8\"/>"));
    CHECK(file.bodies.size() == 1);
    CHECK(file.items == 1);
    REQUIRE(file.warnings.size() == 1);
    CHECK(file.warnings[0].find("object 7 is excluded from printing (printable=\"0\") and left out") !=
          std::string::npos);
    const ThreeMf both = read(model(two, "<item objectid=\"7\" printable=\"1\"/><item objectid=\"8\"/>"));
    CHECK(both.bodies.size() == 2);
    CHECK(both.items == 2);
    CHECK(refused(model(two, "<item objectid=\"7\" printable=\"0\"/>")) ==
          "a.3mf: every item of its build is excluded from printing (printable=\"0\")");
}

TEST_CASE("violations that affect no body are warnings with their section") {
    const std::string item = "<item objectid=\"7\"/>";
    const auto warnings = [&](const std::string& before, const std::string& objects, const std::string& items) {
        std::string text = model(objects, items);
        return read(text.insert(text.find("<resources>"), before)).warnings;
    };
    const std::string plain = object(7, "");
    CHECK(warnings("<metadata name=\"Title\">x</metadata>", plain, item).empty());
    CHECK(warnings("<metadata name=\"m:Own\">x</metadata>", plain, item).empty());
    const auto one = [&](const std::string& before, const std::string& objects, const std::string& items) {
        const auto found = warnings(before, objects, items);
        REQUIRE(found.size() == 1);
        return found[0];
    };
    CHECK(one("<metadata name=\"Mine\">x</metadata>", plain, item).find("section 3.4.1") != std::string::npos);
    CHECK(one("<metadata name=\"vendor:Mine\">x</metadata>", plain, item).find("prefix has no namespace") !=
          std::string::npos);
    CHECK(one("<metadata name=\"Title\">x</metadata>\n<metadata name=\"Title\">y</metadata>", plain, item)
              .find("a.3mf:4: <metadata>: name=\"Title\" is given twice") == 0);
    std::string grouped = plain;
    grouped.insert(grouped.find("<mesh>"), "<metadatagroup><metadata name=\"Mine\">x</metadata></metadatagroup>");
    CHECK(one("", grouped, item).find("section 3.4.1") != std::string::npos);
    CHECK(one("", plain,
              "<item objectid=\"7\"><metadatagroup><metadata name=\"v:Mine\">x</metadata></metadatagroup></item>")
              .find("prefix has no namespace") != std::string::npos);
    CHECK(one("", object(7, "colour=\"red\""), item).find("knows no attribute colour here") != std::string::npos);
    CHECK(one("", object(7, "xml:space=\"preserve\""), item).find("knows no attribute xml:space") != std::string::npos);
    CHECK(one("<colours/>", plain, item).find("<colours>: the core specification knows no such element") !=
          std::string::npos);
    CHECK(one("", object(7, ""), "<item objectid=\"7\" a=\"1\"/><item objectid=\"7\" a=\"1\"/>").find("attribute a ") !=
          std::string::npos);
    CHECK(warnings("", plain, "<item objectid=\"7\" printable=\"1\"/>").empty());
    std::string crowd;
    for (int i = 0; i < 1000; ++i) crowd += fmt::format("<metadata name=\"own {}\"/>", i);
    CHECK(warnings(crowd, plain, item).size() == 50);
}

TEST_CASE("a missing related part is a warning where no body needs it") {
    const pliant::test::Folder folder("3mf");
    const auto relationship = [](const std::string& id, const std::string& target, const std::string& type) {
        return fmt::format("<Relationship Id=\"{}\" Target=\"{}\" Type=\"http://schemas.{}\"/>", id, target, type);
    };
    const std::string thumbnail = "openxmlformats.org/package/2006/relationships/metadata/thumbnail";
    Result<ZipWriter> zip = ZipWriter::create(folder / "a.3mf");
    REQUIRE(zip);
    const auto add = [&](const std::string& name, const std::string& bytes) {
        REQUIRE(zip->add(name, bytes, ZipWriter::Method::deflate));
    };
    add("_rels/.rels", "<Relationships>" +
                           relationship("a", "/3D/a.model", "microsoft.com/3dmanufacturing/2013/01/3dmodel") +
                           relationship("b", "Metadata/none.png", thumbnail) +
                           relationship("c", "/Metadata/there.png", thumbnail) + "</Relationships>");
    add("3D/_rels/a.model.rels", "<Relationships>" + relationship("d", "../Metadata/there.png", thumbnail) +
                                     relationship("e", "none.png", thumbnail) + "</Relationships>");
    add("Metadata/there.png", "x");
    add("3D/a.model", model(object(7, ""), "<item objectid=\"7\"/>"));
    REQUIRE(zip->close());
    const auto file = read_3mf(folder / "a.3mf");
    REQUIRE_MESSAGE(file.has_value(), (file ? "" : file.error().message));
    REQUIRE(file->warnings.size() == 2);
    CHECK(file->warnings[0].find("names the part none.png, which is not in the file") != std::string::npos);
    CHECK(file->warnings[1].find("names the part Metadata/none.png") != std::string::npos);
}

TEST_CASE("errors name the line, what is wrong and what would be right") {
    const std::string item = "<item objectid=\"7\"/>";
    CHECK(refused(model(object(7, ""), "<item objectid=\"9\"/>")) ==
          "a.3mf:10: <item>: objectid: there is no object 9 before it");
    CHECK(refused(model(object(7, "") + object(7, ""), item)).find("id 7 is used twice") != std::string::npos);
    CHECK(refused(model(object(7, "pid=\"1\""), item)).find("no property group 1") != std::string::npos);
    CHECK(refused(model(object(7, "pindex=\"1\""), item)).find("a pindex needs a pid") != std::string::npos);
    CHECK(refused(model(materials + object(7, "pid=\"1\" pindex=\"2\""), item)).find("no property 2, only 2") !=
          std::string::npos);
    CHECK(refused(model(object(7, "type=\"other\""), item)).find("\"other\"") != std::string::npos);
    CHECK(refused(model(object(7, ""), "")) == "a.3mf: its build holds no body");
    CHECK(refused(model(object(7, ""), "<item objectid=\"7\" transform=\"1 0 0\"/>")).find("12 finite numbers") !=
          std::string::npos);
    CHECK(refused(model(object(7, ""), "<item objectid=\"7\" transform=\"1 0 0 1 0 0 0 0 1 0 0 0\"/>"))
              .find("flattens") != std::string::npos);
    std::string text = model(object(7, ""), item);
    text.replace(text.find("centimeter"), 10, "furlong");
    CHECK(refused(text).find("unit=\"furlong\" must be micron") != std::string::npos);
    text = model(object(7, ""), item);
    text.insert(text.find("unit="), "requiredextensions=\"s q\" ");
    CHECK(refused(text).find("requires the extension q") != std::string::npos);
    CHECK(refused("<!DOCTYPE x []>" + model("", "")).find("document type") != std::string::npos);
    CHECK(refused(model("<q:x id=\"1\"/>", "")).find("prefix has no namespace") != std::string::npos);
    CHECK(refused(model(object(7, "type=\"invalidtype\""), item)).find("type=\"invalidtype\" must be model, support") !=
          std::string::npos);
    CHECK(read(model(object(7, "type=\"solidsupport\""), item)).bodies.size() == 1);
    const std::string colours = "<m:colorgroup id=\"{}\"><m:color color=\"#00a0e8\"/></m:colorgroup>";
    CHECK(refused(model(fmt::format(fmt::runtime(colours + colours), 2, 3) +
                            "<m:multiproperties id=\"4\" pids=\"2 3\"><m:multi pindices=\"0 0\"/></m:multiproperties>" +
                            object(7, ""),
                        item))
              .find("pids: more than one group of colours") != std::string::npos);
    std::string latin = model(object(7, ""), item);
    latin.insert(latin.find("?>"), " encoding=\"ISO-8859-1\"");
    CHECK(refused(latin) == "a.3mf: is encoded as \"iso-8859-1\"; 3MF allows UTF-8 and UTF-16 only");
    CHECK(refused("PK").find("not well-formed") != std::string::npos);
    std::string vertex = model(object(7, ""), item);
    vertex.replace(vertex.find("v2=\"2\""), 6, "v2=\"4\"");
    CHECK(refused(vertex).find("there is no vertex 4, only 4") != std::string::npos);
}

TEST_CASE("objects nested so that copies multiply without end are refused soon") {
    std::string resources = object(1, "");
    for (int id = 2; id < 60; ++id)
        resources += fmt::format(
            "<object id=\"{}\"><components><component objectid=\"{}\"/><component "
            "objectid=\"{}\"/></components></object>",
            id, id - 1, id - 1);
    CHECK(refused(model(resources, "<item objectid=\"59\"/>")).find("placed more than") != std::string::npos);
}

#include <doctest/doctest.h>
#include <zip.h>

#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/zip/zip_file.hpp"
#include "printing/job/job.hpp"
#include "printing/job/manifest.hpp"
#include "printing/job/sha256.hpp"

using namespace pliant;
using namespace pliant::job;
namespace fs = std::filesystem;

namespace {

struct Folder : pliant::test::Folder {
    [[nodiscard]] std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(path()), fs::directory_iterator()));
    }
};

const Image image_a{8, 4, std::vector<std::uint8_t>(32, 255)};
const Image image_b{8, 4, std::vector<std::uint8_t>(32, 7)};

Manifest manifest() {
    return {"cube",
            "0.1.0",
            8,
            4,
            100,
            1,
            {{"soft", "flex", 1, 2, 3, 4}, {"rigid", "hard", 1, 2, 3, 4}},
            {{50, 50, {{0, "layers/00000_soft.png", 0.32}}}, {100, 50, {{1, "layers/00001_rigid.png", 0.01}}}},
            {}};
}

Writer filled(const fs::path& path) {
    auto writer = Writer::create(path);
    REQUIRE(writer.has_value());
    REQUIRE(writer->add_image("layers/00000_soft.png", image_a).has_value());
    REQUIRE(writer->add_image("layers/00001_rigid.png", image_b).has_value());
    REQUIRE(writer->add_file("printer.toml", std::string(5000, 'x')).has_value());
    return std::move(*writer);
}

Status write(const fs::path& path, const Manifest& m = manifest()) {
    return filled(path).finish(m);
}

std::string refused(const fs::path& path) {
    const auto archive = Archive::open(path);
    REQUIRE(!archive.has_value());
    CHECK(archive.error().cause == Cause::input);
    CHECK(archive.error().message.find(path.string() + ": ") == 0);
    return archive.error().message;
}

/// An archive of arbitrary entries, without the writer's checks.
void write_raw(const fs::path& path, const std::vector<std::pair<std::string, std::string>>& entries) {
    auto zip = ZipWriter::create(path);
    REQUIRE(zip.has_value());
    for (const auto& [name, bytes] : entries)
        REQUIRE(zip->add(name, bytes, name.ends_with(".png") ? ZipWriter::Method::store : ZipWriter::Method::deflate)
                    .has_value());
    REQUIRE(zip->close().has_value());
}

void patch(const fs::path& path, const std::string& from, const std::string& to) {
    auto bytes = read_file(path);
    REQUIRE(bytes.has_value());
    int count = 0;
    for (std::size_t at = bytes->find(from); at != std::string::npos; at = bytes->find(from, at + to.size()), ++count)
        bytes->replace(at, from.size(), to);
    REQUIRE(count > 0);
    REQUIRE(write_file(path, *bytes).has_value());
}

std::string little_endian(std::uint32_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
    return bytes;
}

}  // namespace

TEST_CASE("a job is read back as written") {
    const Folder folder;
    const fs::path path = folder / "a.zip";
    REQUIRE(write(path).has_value());
    CHECK(folder.files() == 1);
    const auto archive = Archive::open(path);
    REQUIRE_MESSAGE(archive.has_value(), (archive ? "" : archive.error().message));
    Manifest read = archive->manifest();
    CHECK(read.sha256.size() == 3);
    CHECK(read.sha256.at("printer.toml") == sha256_hex(std::string(5000, 'x')));
    read.sha256.clear();
    CHECK(to_json(read) == to_json(manifest()));
    CHECK(archive->image("layers/00000_soft.png").value() == image_a);
    CHECK(archive->image("layers/00001_rigid.png").value() == image_b);
    CHECK(archive->file("printer.toml").value() == std::string(5000, 'x'));
    CHECK(archive->has_file("printer.toml"));
    CHECK(!archive->has_file("plan.json"));
    CHECK(archive->file("plan.json").error().message == path.string() + ": has no entry 'plan.json'");
    CHECK(!archive->image("printer.toml").has_value());
}

TEST_CASE("an entry changed, removed or added after the job was made is refused when it is read") {
    const Folder folder;
    const fs::path path = folder / "a.zip";
    const Manifest m = manifest();
    REQUIRE(write(path).has_value());
    const auto archive = Archive::open(path).value();
    std::string json = to_json(archive.manifest());
    const auto rebuilt = [&](const std::string& printer, bool with_settings) {
        std::vector<std::pair<std::string, std::string>> entries = {
            {"layers/00000_soft.png", archive.file("layers/00000_soft.png").value()},
            {"layers/00001_rigid.png", archive.file("layers/00001_rigid.png").value()},
            {"manifest.json", json}};
        if (!printer.empty()) entries.emplace_back("printer.toml", printer);
        if (with_settings) entries.emplace_back("settings.json", "{}");
        write_raw(path, entries);
    };
    rebuilt(std::string(5000, 'x'), true);
    auto changed = Archive::open(path);
    REQUIRE(changed.has_value());
    CHECK(changed->file("printer.toml").has_value());
    CHECK(changed->file("settings.json").error().message.find("settings.json: the manifest has no fingerprint") !=
          std::string::npos);
    rebuilt(std::string(4999, 'x') + "y", false);
    changed = Archive::open(path);
    REQUIRE(changed.has_value());
    CHECK(changed->file("printer.toml").error().message.find("printer.toml: was damaged or changed") !=
          std::string::npos);
    rebuilt("", false);
    CHECK(refused(path).find("printer.toml: is missing") != std::string::npos);
    const std::string hash = archive.manifest().sha256.at("layers/00001_rigid.png");
    json.replace(json.find(hash), 64, std::string(64, 'F'));
    rebuilt("x", false);
    CHECK(refused(path).find("64 hex digits") != std::string::npos);
}

TEST_CASE("the same calls give the same bytes, in any time zone") {
    const Folder folder;
    REQUIRE(write(folder / "a.zip").has_value());
    setenv("TZ", "Asia/Tokyo", 1);
    REQUIRE(write(folder / "b.zip").has_value());
    unsetenv("TZ");
    CHECK(read_file(folder / "a.zip").value() == read_file(folder / "b.zip").value());
    // Images are stored, text is deflated.
    CHECK(read_file(folder / "a.zip")->find("IHDR") != std::string::npos);
    CHECK(read_file(folder / "a.zip")->find("xxxxxxxxxx") == std::string::npos);
}

TEST_CASE("without finish, or when it fails, nothing is left behind and nothing is replaced") {
    const Folder folder;
    const fs::path path = folder / "a.zip";
    {
        auto writer = Writer::create(path);
        REQUIRE(writer->add_image("layers/x.png", image_a).has_value());
    }
    CHECK(folder.files() == 0);
    REQUIRE(write_file(path, "before").has_value());
    Manifest m = manifest();
    m.layers[0].images[0].file = "layers/other.png";
    CHECK(write(path, m).error().message.find("image 'layers/other.png' of the manifest was not added") !=
          std::string::npos);
    m = manifest();
    m.width_px = 9;
    CHECK(write(path, m).error().message.find("has 8 x 4 pixels, the manifest says 9 x 4") != std::string::npos);
    m = manifest();
    m.layers[1].z_um = 1;
    CHECK(!write(path, m).has_value());
    CHECK(folder.files() == 1);
    CHECK(read_file(path).value() == "before");
    REQUIRE(write(path).has_value());
    CHECK(Archive::open(path).has_value());
}

TEST_CASE("a writer that has finished takes nothing more") {
    const Folder folder;
    Writer writer = filled(folder / "a.zip");
    REQUIRE(writer.finish(manifest()));
    CHECK(writer.add_file("more", "").error().message.ends_with("is already finished"));
    CHECK(writer.finish(manifest()).error().message.ends_with("is already finished"));
}

TEST_CASE("the writer refuses bad names, repeated names and missing folders") {
    const Folder folder;
    auto writer = Writer::create(folder / "a.zip");
    CHECK(!writer->add_file("../x", "").has_value());
    CHECK(!writer->add_image("/x.png", image_a).has_value());
    CHECK(!writer->add_image("a.png", Image{}).has_value());
    CHECK(!writer->add_image("a.png", Image{8, 4, {1, 2, 3}}).has_value());
    CHECK(writer->add_file("x", "").has_value());
    CHECK(!writer->add_file("x", "").has_value());
    CHECK(!Writer::create(folder / "none/a.zip").has_value());
    CHECK(!Writer::create(folder / ".").has_value());
}

TEST_CASE("invalid or incomplete archives are refused") {
    const Folder folder;
    const fs::path path = folder / "a.zip";
    CHECK(refused(path).find("no such file") != std::string::npos);
    CHECK(refused(folder / ".").find("not a regular file") != std::string::npos);
    REQUIRE(write_file(path, "").has_value());
    refused(path);
    REQUIRE(write_file(path, "not a zip at all").has_value());
    refused(path);
    write_raw(path, {{"a", "b"}});
    CHECK(refused(path).find("has no entry 'manifest.json'") != std::string::npos);
    write_raw(path, {{"manifest.json", "{}"}});
    CHECK(refused(path).find("manifest.json: format: is missing") != std::string::npos);
    write_raw(path, {{"manifest.json", to_json(manifest())}});
    CHECK(refused(path).find("has no entry 'layers/00000_soft.png'") != std::string::npos);
    write_raw(path, {{"manifest.json", to_json(manifest())}, {"layers/00000_soft.png", "hello"}});
    CHECK(refused(path).find("layers/00000_soft.png: is not a PNG image") != std::string::npos);
    const Image wide{9, 4, std::vector<std::uint8_t>(36)};
    write_raw(path, {{"manifest.json", to_json(manifest())}, {"layers/00000_soft.png", encode(wide).png}});
    CHECK(refused(path).find("9 x 4 pixels, the manifest says 8 x 4") != std::string::npos);
    write_raw(path, {{"manifest.json", to_json(manifest())}, {"../evil", "x"}});
    CHECK(refused(path).find("entry '../evil' must be a plain relative path") != std::string::npos);
    write_raw(path, {{"manifest.json", to_json(manifest())}, {"/etc/evil", "x"}});
    CHECK(refused(path).find("plain relative path") != std::string::npos);
    write_raw(path, {{"manifest.json", to_json(manifest())}, {"manifest.jsox", "{}"}});
    std::string bytes = read_file(path).value();
    for (std::size_t at = 0; (at = bytes.find("manifest.jsox", at)) != std::string::npos;) bytes[at + 12] = 'n';
    REQUIRE(write_file(path, bytes));
    CHECK(refused(path).find("entry 'manifest.json' is there twice") != std::string::npos);
}

TEST_CASE("cutting an archive short anywhere is refused, never a crash") {
    const Folder folder;
    const fs::path path = folder / "a.zip";
    REQUIRE(write(path).has_value());
    const std::string bytes = read_file(path).value();
    for (std::size_t length = 0; length < bytes.size(); length += 13) {
        REQUIRE(write_file(path, std::string_view(bytes).substr(0, length)).has_value());
        refused(path);
    }
}

TEST_CASE("a flipped byte anywhere gives an error or a valid job") {
    const Folder folder;
    const fs::path path = folder / "a.zip";
    REQUIRE(write(path).has_value());
    const std::string bytes = read_file(path).value();
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string changed = bytes;
        changed[i] = static_cast<char>(changed[i] ^ 0x55);
        REQUIRE(write_file(path, changed).has_value());
        const auto archive = Archive::open(path);
        if (!archive) continue;
        for (const Layer& layer : archive->manifest().layers) {
            for (const LayerImage& image : layer.images) {
                const auto decoded = archive->image(image.file);
                CHECK((!decoded || decoded->pixels.size() == 32));
            }
        }
        (void)archive->file("printer.toml");
    }
}

TEST_CASE("sizes stated in entries are checked before memory is allocated") {
    const Folder folder;
    const fs::path path = folder / "a.zip";
    REQUIRE(write(path).has_value());
    patch(path, little_endian(5000), little_endian(0xFFFFFFF0));  // printer.toml's size, in both of its headers
    const auto archive = Archive::open(path);
    REQUIRE(archive.has_value());
    CHECK(
        archive->file("printer.toml").error().message.find("claims 4294967280 bytes, more than the archive can hold") !=
        std::string::npos);

    // A manifest that unpacks from a few hundred kilobytes to more than is allowed.
    write_raw(path, {{"manifest.json", std::string(std::size_t{65} << 20, ' ')}});
    CHECK(refused(path).find("more than the 67108864 allowed") != std::string::npos);
}

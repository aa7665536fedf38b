#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <limits>
#include <string>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "base/zip/zip_file.hpp"

using namespace pliant;
using pliant::test::holds;
namespace fs = std::filesystem;

namespace {

using Method = ZipWriter::Method;
constexpr std::uint64_t any_size = std::numeric_limits<std::uint64_t>::max();

std::string number(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
    return text;
}

/// A hand-made archive of one stored entry, in which each field can be falsified.
struct HandMadeArchive {
    std::string name = "a";
    std::string data = "hello";
    std::uint64_t size = 5, packed = 5, offset = 0;
    std::uint32_t checksum = 0x3610A686;  // CRC-32 of "hello"
    std::uint16_t flags = 0, method = 0;
    std::string extra{};  // of the directory's entry
    std::uint64_t count = 1;
    bool zip64_end = false;

    [[nodiscard]] std::string described(std::size_t extra_bytes) const {
        return number(flags, 2) + number(method, 2) + number(0, 2) + number(33, 2) + number(checksum, 4) +
               number(packed, 4) + number(size, 4) + number(name.size(), 2) + number(extra_bytes, 2);
    }
    [[nodiscard]] std::string local() const {
        return number(0x04034B50, 4) + number(45, 2) + described(0) + name + data;
    }
    [[nodiscard]] std::string directory() const {
        return number(0x02014B50, 4) + number(45, 2) + number(45, 2) + described(extra.size()) + number(0, 8) +
               number(0, 2) + number(offset, 4) + name + extra;
    }
    [[nodiscard]] std::string zip() const { return finish(local(), directory(), count, zip64_end); }

    static std::string finish(const std::string& locals, const std::string& directory, std::uint64_t count,
                              bool zip64_end = false) {
        std::string end;
        if (zip64_end) {
            end = number(0x06064B50, 4) + number(44, 8) + number(45, 2) + number(45, 2) + number(0, 8) +
                  number(count, 8) + number(count, 8) + number(directory.size(), 8) + number(locals.size(), 8);
            end += number(0x07064B50, 4) + number(0, 4) + number(locals.size() + directory.size(), 8) + number(1, 4);
        }
        const std::uint64_t said = zip64_end ? 0xFFFF : count;
        return locals + directory + end + number(0x06054B50, 4) + number(0, 4) + number(said, 2) + number(said, 2) +
               number(zip64_end ? 0xFFFFFFFF : directory.size(), 4) +
               number(zip64_end ? 0xFFFFFFFF : locals.size(), 4) + number(0, 2);
    }
};

struct File {
    const pliant::test::Folder folder;
    const fs::path path = folder / "a.zip";

    [[nodiscard]] Result<ZipReader> open(const std::string& bytes) const {
        REQUIRE(write_file(path, bytes).has_value());
        return ZipReader::open(path);
    }
    /// The error for an archive that cannot be opened, or else for its entry "a".
    std::string refused(const std::string& bytes) const {
        const auto zip = open(bytes);
        const auto read = zip ? zip->read("a", 1000) : Result<std::string>(tl::unexpected(zip.error()));
        REQUIRE(!read.has_value());
        CHECK(read.error().cause == Cause::input);
        CHECK(read.error().message.starts_with(path.string() + ": "));
        CHECK_FALSE(holds(read.error().message, "\n"));
        return read.error().message;
    }
};

/// Writes beyond `bytes` fail, as on a full disk, for the lifetime of this object.
class FullDisk {
public:
    explicit FullDisk(rlim_t bytes) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit small{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &small);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;
    ~FullDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_before_);
    }

private:
    rlimit before_{};
    void (*signal_before_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

}  // namespace

TEST_CASE("an archive that was cut off is told from a missing file") {
    const File file;
    const std::string whole = HandMadeArchive{}.zip();
    CHECK(file.refused(whole.substr(0, whole.size() / 2)) ==
          file.path.string() + ": is no zip archive, or the end of it is missing: was it copied completely?");
}

TEST_CASE("entries are read back as written, stored and deflated, empty and binary") {
    const File file;
    const std::string binary("\0\xFF\r\n\x1A", 5), repeated(100000, 'x'), name = "b\xC3\xA9/\xE6\x9F\x94.txt";
    {
        auto zip = ZipWriter::create(file.path);
        REQUIRE(zip.has_value());
        REQUIRE(zip->add("empty", "", Method::deflate).has_value());
        REQUIRE(zip->add("binary", binary, Method::store).has_value());
        ZipWriter moved = std::move(*zip);
        REQUIRE(moved.add(name, repeated, Method::deflate).has_value());
        REQUIRE(moved.close().has_value());
    }
    CHECK(fs::file_size(file.path) < 1000);
    const auto zip = ZipReader::open(file.path);
    REQUIRE(zip.has_value());
    CHECK(zip->entry_count() == 3);
    CHECK(zip->name(2) == name);
    CHECK(zip->name(3).empty());
    CHECK(zip->read("empty", 0).value().empty());
    CHECK(zip->read("binary", 5).value() == binary);
    CHECK(zip->read(name, any_size).value() == repeated);
    CHECK(zip->has("binary"));
    CHECK_FALSE(zip->has("Binary"));
    CHECK_FALSE(zip->has("none"));
    CHECK(zip->read("none", any_size).error().message == file.path.string() + ": has no entry 'none'");
}

TEST_CASE("an archive that replaces another has its permissions") {
    const File file;
    for (const fs::perms wanted : {fs::perms(0600), fs::perms(0664), fs::perms(0444)}) {
        REQUIRE(ZipWriter::create(file.path)->close().has_value());
        fs::permissions(file.path, wanted);
        REQUIRE(ZipWriter::create(file.path)->close().has_value());
        CHECK(fs::status(file.path).permissions() == wanted);
    }
}

TEST_CASE("an entry may be as large as the limit and no larger; its head is readable anyway") {
    const File file;
    {
        auto zip = ZipWriter::create(file.path);
        REQUIRE(zip->add("a", std::string(1 << 26, 'x'), Method::deflate).has_value());
        REQUIRE(zip->close().has_value());
    }
    CHECK(fs::file_size(file.path) < 100000);
    const auto zip = ZipReader::open(file.path);
    REQUIRE(zip.has_value());
    CHECK(zip->read("a", 1 << 26).value().size() == 1 << 26);
    CHECK(zip->read("a", (1 << 26) - 1).error().message ==
          file.path.string() + ": a: 67108864 bytes, more than the 67108863 allowed");
    CHECK(zip->read_head("a", 3).value() == "xxx");
    CHECK(zip->read_head("a", 0).value().empty());
    CHECK(zip->read_head("a", any_size).value().size() == 1 << 26);
}

TEST_CASE("duplicate or overlong names and oversized entries are refused") {
    const File file;
    auto zip = ZipWriter::create(file.path);
    REQUIRE(zip->add("a", "1", Method::store).has_value());
    CHECK(zip->add("a", "2", Method::store).error().message == file.path.string() + ": a: comes twice");
    const std::string longest(65535, 'n');
    REQUIRE(zip->add(longest, "3", Method::store).has_value());
    CHECK(holds(zip->add(longest + "n", "4", Method::store).error().message, "too large for a zip file"));
    const std::string_view huge(longest.data(), std::size_t{0xFFFFFFFF});  // refused without reading any of it
    CHECK(holds(zip->add("huge", huge, Method::store).error().message, "huge: is too large for a zip file"));
    REQUIRE(zip->close().has_value());
    const auto read = ZipReader::open(file.path);
    CHECK(read->entry_count() == 2);
    CHECK(read->read("a", 9).value() == "1");
    CHECK(read->read(longest, 9).value() == "3");
}

TEST_CASE("nothing is left without close(), or on a full disk") {
    const File file;
    { CHECK(ZipWriter::create(file.path)->add("a", "1", Method::store).has_value()); }
    CHECK_FALSE(fs::exists(file.path));
    {
        auto zip = ZipWriter::create(file.path);
        const FullDisk full(10000);
        const Status added = zip->add("a", std::string(100000, 'x'), Method::store);
        CHECK(holds(added.error().message, "cannot be written: "));
    }
    CHECK_FALSE(fs::exists(file.path));
    {
        auto zip = ZipWriter::create(file.path);
        const FullDisk full(10);
        REQUIRE(zip->add("a", "waits in memory until the file is closed", Method::store).has_value());
        CHECK(holds(zip->close().error().message, "cannot be written: "));
    }
    CHECK_FALSE(fs::exists(file.path));
    CHECK(holds(ZipWriter::create(file.folder / "none/a.zip").error().message, "cannot be written: "));
}

TEST_CASE("missing files, folders, pipes and files that are no archive are refused") {
    const File file;
    CHECK(ZipReader::open(file.path).error().message == file.path.string() + ": no such file");
    CHECK(holds(ZipReader::open(file.folder.path()).error().message, ": is not a regular file"));
    REQUIRE(::mkfifo((file.folder / "fifo").c_str(), 0600) == 0);
    CHECK(holds(ZipReader::open(file.folder / "fifo").error().message, ": is not a regular file"));  // must not block
    file.refused("");
    file.refused("PK");
    file.refused(std::string(70000, '\0'));
}

TEST_CASE("an archive that ends early anywhere is refused") {
    const File file;
    const std::string whole = HandMadeArchive{}.zip();
    REQUIRE(file.open(whole)->read("a", 5).value() == "hello");
    for (std::size_t length = 0; length < whole.size(); ++length) file.refused(whole.substr(0, length));
}

TEST_CASE("impossible sizes are refused before memory is allocated") {
    const File file;
    CHECK(holds(file.refused(HandMadeArchive{.size = 6}.zip()), "a: claims 6 bytes, more than the archive can hold"));
    CHECK(holds(file.refused(HandMadeArchive{.size = 0xFFFFFFF0}.zip()), "claims 4294967280 bytes"));
    CHECK(holds(file.refused(HandMadeArchive{.size = 5 * 1032 + 1, .method = 8}.zip()), "claims 5161 bytes"));
    file.refused(HandMadeArchive{.size = 5, .packed = 0xFFFFFFF0}.zip());
    CHECK(holds(file.refused(HandMadeArchive{.size = 4, .packed = 4}.zip()), "a: "));  // the checksum is for five bytes
    file.refused(HandMadeArchive{.offset = 40}.zip());
    file.refused(HandMadeArchive{.offset = 0xFFFFFFF0}.zip());
    file.refused(HandMadeArchive{.count = 2}.zip());
    file.refused(HandMadeArchive{.count = 0xFFFE}.zip());
}

TEST_CASE("a wrong checksum, encryption and unknown methods are refused") {
    const File file;
    file.refused(HandMadeArchive{.checksum = 1}.zip());
    CHECK(holds(file.refused(HandMadeArchive{.flags = 1}.zip()), "a: must be stored or deflated, and not encrypted"));
    CHECK(holds(file.refused(HandMadeArchive{.method = 12}.zip()), "a: must be stored or deflated, and not encrypted"));
    file.refused(HandMadeArchive{.method = 8}.zip());  // "hello" is not a deflate stream
}

TEST_CASE("64-bit sizes are read and checked like 32-bit ones") {
    const File file;
    const auto with_sizes = [](std::uint64_t size, std::uint64_t packed) {
        const std::string extra = number(1, 2) + number(16, 2) + number(size, 8) + number(packed, 8);
        HandMadeArchive hand;
        const std::string local = hand.local();
        hand.size = hand.packed = 0xFFFFFFFF;
        hand.extra = extra;
        return HandMadeArchive::finish(local, hand.directory(), 1, true);
    };
    const auto zip = file.open(with_sizes(5, 5));
    REQUIRE(zip.has_value());
    CHECK(zip->read("a", 5).value() == "hello");
    for (const std::uint64_t lie : {std::uint64_t{1} << 40, std::uint64_t{1} << 62, any_size}) {
        file.refused(with_sizes(lie, 5));
        file.refused(with_sizes(5, lie));
        file.refused(with_sizes(lie, lie));
    }
    for (const std::uint64_t lie : {std::uint64_t{2}, std::uint64_t{1} << 40, any_size}) {
        file.refused(HandMadeArchive{.count = lie, .zip64_end = true}.zip());
    }
}

TEST_CASE("an archive with more than 65,535 entries is written and read") {
    const File file;
    constexpr int count = 70000;
    {
        auto zip = ZipWriter::create(file.path);
        for (int i = 0; i < count; ++i) REQUIRE(zip->add(std::to_string(i), "x", Method::store).has_value());
        REQUIRE(zip->close().has_value());
    }
    const auto zip = ZipReader::open(file.path);
    REQUIRE(zip.has_value());
    CHECK(zip->entry_count() == count);
    CHECK(zip->name(count - 1) == "69999");
    CHECK(zip->read("69999", 1).value() == "x");
}

TEST_CASE("of two entries with one name the first is read") {
    const File file;
    HandMadeArchive first, second;
    second.data = "HELLO";
    second.checksum = 0xC1446436;
    second.offset = first.local().size();
    const auto zip =
        file.open(HandMadeArchive::finish(first.local() + second.local(), first.directory() + second.directory(), 2));
    REQUIRE(zip.has_value());
    CHECK(zip->entry_count() == 2);
    CHECK(zip->name(1) == "a");
    CHECK(zip->read("a", 5).value() == "hello");
}

TEST_CASE("names that look like other paths are ordinary entries") {
    const File file;
    for (const std::string name : {"../evil", "/tmp/pliant_evil", "..", "a\\..\\b", "c:evil"}) {
        HandMadeArchive hand;
        hand.name = name;
        const auto zip = file.open(hand.zip());
        REQUIRE(zip.has_value());
        CHECK(zip->name(0) == name);
        CHECK(zip->read(name, 5).value() == "hello");
        CHECK_FALSE(zip->has("evil"));
    }
    CHECK_FALSE(fs::exists(file.folder.path().parent_path() / "evil"));
    CHECK_FALSE(fs::exists("/tmp/pliant_evil"));
    CHECK(std::distance(fs::directory_iterator(file.folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("an archive with any changed byte is refused or read, without harm") {
    const File file;
    const std::string whole = HandMadeArchive{}.zip();
    for (std::size_t i = 0; i < whole.size(); ++i) {
        for (const int flip : {0x01, 0x80, 0xFF}) {
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ flip);
            const auto zip = file.open(changed);
            if (!zip) continue;
            const auto read = zip->read(zip->name(0), 1000);
            CHECK((!read || *read == "hello"));
        }
    }
}

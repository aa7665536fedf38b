#include "studio/make/make_session.hpp"

#include <doctest/doctest.h>

#include <future>

#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "studio/make/test_orders.hpp"

using namespace pliant;
using namespace pliant::studio;
using pliant::test::holds;
using studio::test::end_of_slicing;
using studio::test::Events;
using studio::test::Json;
using studio::test::slice_order;
namespace fs = std::filesystem;

TEST_CASE("a robot becomes a job with its materials' colours; its file is deleted with the session") {
    Events events;
    fs::path scratch;
    {
        MakeSession session([&](const std::string& json) { events.add(json); }, "1.2.3");
        CHECK(session.job() == nullptr);
        REQUIRE(session.slice(slice_order()).has_value());
        CHECK(end_of_slicing(events) == "");
        const auto job = session.job();
        REQUIRE(job != nullptr);
        CHECK(job->revision == 1);
        CHECK(job->archive.manifest().layers.size() == 40);
        CHECK(job->origin.colours.size() == 1);
        CHECK(job->printer.projector.width_px == 96);
        CHECK(session.news() == std::vector<std::string>{R"({"revision":1,"type":"job"})"});
        scratch = job->file.parent_path();
        CHECK((fs::status(scratch).permissions() & fs::perms::mask) == fs::perms::owner_all);  // readable by the owner
                                                                                               // only
    }
    CHECK_FALSE(fs::exists(scratch));
}

TEST_CASE("a chosen colour stays with the job that is opened again") {
    const pliant::test::Folder folder;
    Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    SliceOrder order = slice_order();
    order.robot_text = pliant::test::replaced(order.robot_text, "{ youngs", "{ colour = \"#12ab34\", youngs");
    REQUIRE(session.slice(order).has_value());
    REQUIRE(end_of_slicing(events) == "");
    CHECK(session.job()->origin.colours == std::vector<std::string>{"#12ab34"});
    REQUIRE(session.save(folder / "a.zip").has_value());
    MakeSession later([](const std::string&) {}, "test");
    REQUIRE(later.open(folder / "a.zip").has_value());
    CHECK(later.job()->origin.colours == std::vector<std::string>{"#12ab34"});
    const auto beside = later.other(folder / "a.zip");
    REQUIRE(beside.has_value());
    CHECK((*beside)->origin.colours == std::vector<std::string>{"#12ab34"});
}

TEST_CASE("a job is saved under a new name only, and the session continues with that file") {
    const pliant::test::Folder folder;
    Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    CHECK(holds(session.save(folder / "a.zip").error().message, "there is no job yet"));
    REQUIRE(session.slice(slice_order()).has_value());
    REQUIRE(end_of_slicing(events) == "");
    const auto sliced = session.job();
    REQUIRE(session.save(folder / "a.zip").has_value());
    CHECK(session.job()->file == folder / "a.zip");
    CHECK(session.job()->revision == 2);
    CHECK(session.job()->origin.colours == sliced->origin.colours);
    CHECK(read_file(folder / "a.zip").value() == read_file(sliced->file).value());
    CHECK(session.save(folder / "a.zip").error().message == "a.zip exists; choose another name");
    CHECK_FALSE(session.save(folder / "none/b.zip").has_value());
    CHECK(session.job()->file == folder / "a.zip");

    MakeSession other([](const std::string&) {}, "test");
    REQUIRE(other.open(folder / "a.zip").has_value());
    CHECK(other.job()->archive.manifest().layers.size() == 40);
}

TEST_CASE("an invalid job is refused, and the current job stays") {
    const pliant::test::Folder folder;
    Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    REQUIRE(session.slice(slice_order()).has_value());
    REQUIRE(end_of_slicing(events) == "");
    REQUIRE(write_file(folder / "no.zip", "no zip file").has_value());
    CHECK(holds(session.open(folder / "no.zip").error().message, "no.zip: "));
    CHECK(holds(session.open(folder / "none.zip").error().message, "none.zip: no such file"));
    CHECK(session.job()->revision == 1);

    events.clear();
    std::string wrong = studio::test::bar;
    wrong.replace(wrong.find("youngs_modulus"), 14, "young_modulus");
    REQUIRE(session.slice(slice_order(wrong)).has_value());
    CHECK(holds(end_of_slicing(events), "bar.toml:3: "));
    CHECK(session.job()->revision == 1);
    CHECK(events.count("job") == 0);
}

TEST_CASE("one job is sliced at a time; a cancelled one ends without error and without a job") {
    Events events;
    std::promise<void> go;
    std::shared_future<void> may_go(go.get_future());
    // The session's thread blocks at its first event, so that it is busy as long as the test needs.
    MakeSession session(
        [&](const std::string& json) {
            events.add(json);
            if (Json::parse(json)["stage"] == "read") may_go.wait();
        },
        "test");
    REQUIRE(session.slice(slice_order()).has_value());
    CHECK(session.slice(slice_order()).error().message == "a job is being sliced already; cancel it first");
    session.cancel();
    go.set_value();
    CHECK(end_of_slicing(events) == "");
    CHECK(session.job() == nullptr);
    CHECK(session.news() == std::vector<std::string>{R"({"revision":0,"type":"job"})"});

    events.clear();
    REQUIRE(session.slice(slice_order()).has_value());
    CHECK(end_of_slicing(events) == "");
    CHECK(session.job() != nullptr);
}

TEST_CASE("a job remembers what it was sliced from, also after it has been saved; a file says nothing of it") {
    const pliant::test::Folder folder;
    Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    SliceOrder order = slice_order();
    order.source = R"({"robot":"abc"})";
    REQUIRE(session.slice(order).has_value());
    REQUIRE(end_of_slicing(events) == "");
    const std::string key = session.job()->key;
    CHECK(session.job()->origin.source == order.source);
    REQUIRE(session.save(folder / "a.zip").has_value());
    CHECK(session.job()->origin.source == order.source);
    CHECK(session.job()->key == key);  // the same images
    REQUIRE(session.open(folder / "a.zip").has_value());
    CHECK(session.job()->origin.source.empty());
    CHECK(session.job()->key != key);
}

TEST_CASE("a job whose file has changed is told from the one that was opened, and another one is read again") {
    const pliant::test::Folder folder;
    Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    const auto sliced = [&](const std::string& to, const std::string& layer) {
        SliceOrder order = slice_order();
        order.order.layer = layer;
        events.clear();
        REQUIRE(session.slice(order).has_value());
        REQUIRE(end_of_slicing(events) == "");
        REQUIRE(session.save(folder / to).has_value());
    };
    sliced("b.zip", "40 um");
    sliced("a.zip", "50 um");
    const auto job = session.job();
    CHECK(job->unchanged());
    const auto beside = session.other(folder / "b.zip").value();
    CHECK(session.other(folder / "b.zip").value() == beside);
    CHECK(beside->archive.manifest().layers.size() == 50);
    fs::rename(folder / "b.zip", folder / "c.zip");
    REQUIRE(write_file(folder / "b.zip", read_file(folder / "a.zip").value()));
    CHECK(session.other(folder / "b.zip").value()->archive.manifest().layers.size() == 40);
    fs::rename(folder / "c.zip", folder / "a.zip");
    CHECK(job->unchanged().error().message == "a.zip has changed since it was opened: open it again");
    CHECK(session.save(folder / "d.zip").error().message == job->unchanged().error().message);
    CHECK_FALSE(fs::exists(folder / "d.zip"));
    REQUIRE(session.open(folder / "a.zip"));
    CHECK(session.job()->archive.manifest().layers.size() == 50);
    CHECK(session.job()->key != job->key);
}

TEST_CASE("the file of a sliced job is deleted as soon as nothing uses it") {
    Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    const auto slice = [&] {
        events.clear();
        REQUIRE(session.slice(slice_order()).has_value());
        REQUIRE(end_of_slicing(events) == "");
        return session.job()->file;
    };
    const fs::path first = slice(), second = slice();
    CHECK(fs::exists(first));                                // it is the one to compare with
    auto printed = session.other().value()->origin.scratch;  // a printer still has it
    const fs::path third = slice();
    CHECK(fs::exists(first));
    printed.reset();
    CHECK_FALSE(fs::exists(first));
    CHECK(fs::exists(second));
    CHECK(fs::exists(third));
}

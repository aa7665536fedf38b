#include "presentation/print_report/print_report.hpp"

#include <doctest/doctest.h>

#include <cstdlib>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "presentation/print_report/layer_plot.hpp"
#include "presentation/print_report/print_story.hpp"
#include "printing/host/control_types.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::report;
namespace fs = std::filesystem;

namespace {

using Records = std::vector<host::JournalRecord>;

void add(Records& records, const std::string& kind, host::JournalValues values) {
    records.push_back({static_cast<long>(records.size()) + 1, kind, std::move(values)});
}

long light(Records& records, int layer, int material, double at_s) {
    add(records, "light",
        {{"step", std::to_string(10 * layer + material)},
         {"layer", std::to_string(layer)},
         {"material", std::to_string(material)},
         {"planned", "2.5"},
         {"at", std::to_string(at_s)}});
    return records.back().number;
}

void dark(Records& records, long number, double on_s, bool done, const std::string& by) {
    add(records, "dark",
        {{"light", std::to_string(number)}, {"on", std::to_string(on_s)}, {"done", done ? "1" : "0"}, {"by", by}});
}

/// Layer 0 as planned; during the exposure of layer 1 the host dies after 1 s; another gives the rest after a restart
/// of the computer, whose clock starts anew.
Records interrupted_and_resumed() {
    Records records;
    add(records, "begin", {{"job", "<b>two</b>"}, {"digest", "d"}, {"printer", "tower"}, {"format", "1"}});
    add(records, "session", {{"base", "1"}, {"before", "-1"}, {"boot", "a"}, {"state", "s"}});
    dark(records, light(records, 0, 0, 1000), 2.5, true, "host");
    const long broken = light(records, 1, 0, 1060);
    dark(records, broken, 1, false, "guard");
    add(records, "session", {{"base", "2"}, {"before", "-1"}, {"boot", "b"}, {"state", "s"}});
    dark(records, light(records, 1, 0, 20), 1.5, true, "host");
    dark(records, light(records, 1, 1, 50), 2.5, true, "host");
    add(records, "end", {});
    return records;
}

/// A job of the tower with a block of pixels in every image, and a program if one is given.
Result<job::Archive> written(const fs::path& file, job::Manifest m, const std::string& gcode = "") {
    auto writer = job::Writer::create(file);
    int number = 0;
    for (job::Layer& layer : m.layers) {
        for (job::LayerImage& image : layer.images) {
            slice::RunImage pixels(m.width_px, m.height_px);
            for (int row = 20; row < 30; ++row) pixels.append(row, 20, 40, 255);
            image.file = "layers/" + std::to_string(number++) + ".png";
            image.area_mm2 = 1000;
            REQUIRE(writer->add_image(image.file, job::encode(pixels)));
        }
    }
    REQUIRE(writer->add_file("printer.toml", read_file("examples/printers/tower.toml").value()));
    if (!gcode.empty()) REQUIRE(writer->add_file("job.gcode", gcode));
    REQUIRE(writer->finish(m));
    return job::Archive::open(file);
}

}  // namespace

TEST_CASE("a print's story: parts of an exposure add up, the time continues, faults were survived") {
    const PrintStory story = story_of(interrupted_and_resumed()).value();
    CHECK(story.end == PrintEnd::complete);
    CHECK(story.sessions == 2);
    REQUIRE(story.lights.size() == 3);
    const GivenLight& pieces = story.lights.at({1, 0});
    CHECK(pieces.pieces == 2);
    CHECK(pieces.complete);
    CHECK(pieces.lit_s == near(2.5, {.relative = 1e-12}));
    CHECK(pieces.at_s == near(60, {.relative = 1e-12}));
    // The second boot of the computer continues from the last known exposure.
    CHECK(story.lights.at({1, 1}).at_s == near(60 + 30, {.relative = 1e-12}));
    REQUIRE(story.faults == 2);
    CHECK(story.happenings[0].text == "the host died in the light of layer 2; its guard made dark after 1.00 s");
    CHECK(story.happenings[0].then == "survived: the light went on in layer 2");
    CHECK(story.happenings[1].text == "the computer has been started anew, and the controller has lost its position");
}

TEST_CASE("a print left unfinished is called interrupted; a damaged journal names the record") {
    Records records = interrupted_and_resumed();
    records.resize(5);  // the exposure of layer 1 is on
    const PrintStory story = story_of(records).value();
    CHECK(story.end == PrintEnd::interrupted);
    REQUIRE(story.happenings.size() == 1);
    CHECK(story.happenings[0].text == "the host ended in the light of layer 2");
    CHECK(story.happenings[0].then == "the print waits to be resumed");
    dark(records, 99, 1, true, "host");
    CHECK(story_of(records).error().message == "record 6: no light 99 is on");
    CHECK(story_of({}).value().end == PrintEnd::not_begun);
}

TEST_CASE("changes of exposures and layers without light are told with names, counted from 1") {
    Records records = interrupted_and_resumed();
    records.resize(4);  // begin, session, light and dark of layer 0
    add(records, "exposure", {{"material", "1"}, {"seconds", "3"}, {"from", "1"}});
    add(records, "skip", {{"layer", "4"}});
    const PrintStory story = story_of(records, {"soft", "rigid"}).value();
    REQUIRE(story.happenings.size() == 2);
    CHECK(story.happenings[0].text == "rigid is lit for 3 s from layer 2 on");
    CHECK(story.happenings[1].text == "layer 5 gets no light");
    CHECK(story_of(records).value().happenings[0].text == "material 2 is lit for 3 s from layer 2 on");
}

TEST_CASE("a pause says what somebody was asked to do") {
    Records records = interrupted_and_resumed();
    records.resize(4);  // begin, session, light and dark of layer 0
    add(records, "pause", {{"asked", "refill the vat of slot 2 with rigid-flex"}});
    add(records, "resume", {});
    add(records, "pause", {});
    const PrintStory story = story_of(records).value();
    REQUIRE(story.happenings.size() == 3);
    CHECK(story.happenings[0].text == "paused: refill the vat of slot 2 with rigid-flex");
    CHECK(story.happenings[1].text == "resumed");
    CHECK(story.happenings[2].text == "paused");
    CHECK(story.faults == 0);
}

TEST_CASE("a plot over the layers has a line for every series, and a rounded scale") {
    const std::string svg = layer_plot("Light", "s", {{"soft <i>", "red", {{0, 0}, {9, 3}}, false}}, 10);
    CHECK(svg.find("points=\"54.0,222.0 590.0,8.0 \"") != std::string::npos);
    CHECK(svg.find(">2.5</text>") == std::string::npos);
    CHECK(svg.find(">3</text>") != std::string::npos);
    CHECK(svg.find("soft &lt;i&gt;") != std::string::npos);
}

TEST_CASE("a print report is one page with pictures, exposures, faults and resin; another job's journal is refused") {
    const pliant::test::Folder folder("report");
    const fs::path file = folder / "job.zip", journal = folder / "job.zip.journal";
    machine::Printer printer = plan::test::tower();
    job::Manifest m = plan::test::make_job({{0}, {0, 1}}, {"semi-flex", "rigid-flex"});
    m.name = "<b>two</b>";
    const auto archive = written(file, m);
    REQUIRE(archive);
    const auto page =
        print_report(*archive, printer, interrupted_and_resumed(), {"virtual printer", "Marlin", 1234, 5, nullptr});
    REQUIRE_MESSAGE(page, (page ? "" : page.error().message));
    for (const std::string text :
         {"&lt;b&gt;two", "3 of 3", "2</b><span>faults", "1234", "5 resent", "survived: the light went on in layer 2",
          "data:image/png;base64", "<svg", "12 records"})
        CHECK_MESSAGE(page->find(text) != std::string::npos, text);
    CHECK(page->find("<b>two") == std::string::npos);
    CHECK(page->find("http://") == std::string::npos);
    CHECK(page->find("<script") == std::string::npos);

    REQUIRE(write_file(journal, host::write_record(1, "begin", {{"job", "x"}, {"digest", "other"}, {"printer", "t"}})));
    const auto refused = print_report(file, journal, {});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message ==
          journal.string() + ": this journal is of another job, or job.zip has changed since");
    REQUIRE(write_file(
        journal,
        host::write_record(
            1, "begin",
            {{"job", "x"}, {"digest", host::job_digest(read_file(file).value())}, {"printer", "t"}, {"format", "7"}})));
    const auto newer = print_report(file, journal, {});
    REQUIRE_FALSE(newer);
    CHECK(newer.error().message ==
          journal.string() + ": journal record 1 (begin): format 7 is not known, this program writes 1");
}

TEST_CASE("records that do not fit the job are told, not drawn") {
    const pliant::test::Folder folder("report");
    const fs::path file = folder / "job.zip", journal = folder / "job.zip.journal";
    const machine::Printer printer = plan::test::tower();
    const job::Manifest m = plan::test::make_job({{0}, {0, 1}}, {"semi-flex", "rigid-flex"});
    REQUIRE(written(file, m, plan::write_gcode(plan::make_plan(m, printer).value(), m, printer)));
    const std::string begin = host::write_record(
        1, "begin",
        {{"job", "x"}, {"digest", host::job_digest(read_file(file).value())}, {"printer", "tower"}, {"format", "1"}});
    const auto error_of = [&](const std::string& kind, const host::JournalValues& values) {
        REQUIRE(write_file(journal, begin + host::write_record(2, kind, values)));
        const auto page = print_report(file, journal, {});
        return page ? std::string() : page.error().message;
    };
    CHECK(error_of("skip", {{"layer", "1"}}).empty());
    CHECK(error_of("skip", {{"layer", "2"}}) ==
          journal.string() + ": journal record 2 (skip): this job has no layer 2");
    CHECK(error_of("exposure", {{"material", "2"}, {"seconds", "3"}, {"from", "0"}}) ==
          journal.string() + ": journal record 2 (exposure): this job has no material 2");
    CHECK(error_of("light", {{"step", "3"}, {"layer", "900"}, {"material", "0"}, {"planned", "2.5"}, {"at", "10"}}) ==
          journal.string() + ": journal record 2 (light): this job has no exposure of layer 900, material 0 at step 3");
    machine::Interlock::State state = machine::Interlock(printer).state();
    state.hooked_vat = 99;
    CHECK(error_of("go", {{"program", "0"}, {"step", "0"}, {"line", "3"}, {"state", host::write_state(state)}}) ==
          journal.string() + ": journal record 2 (go): slots or vats that tower prototype does not have");
}

TEST_CASE("a report compares like times: from the start of the first exposure to the end of the last") {
    const pliant::test::Folder folder("report");
    const auto archive =
        written(folder / "job.zip", plan::test::make_job({{0}}, {"semi-flex"}));  // a bottom layer of 12 s
    REQUIRE(archive);
    Records records;
    add(records, "begin", {{"job", "one"}, {"digest", "d"}, {"printer", "tower"}, {"format", "1"}});
    dark(records, light(records, 0, 0, 1000), 12, true, "host");
    const auto page = print_report(*archive, plan::test::tower(), records, {});
    REQUIRE_MESSAGE(page, (page ? "" : page.error().message));
    CHECK(page->find("0:00:12</b><span>first to last exposure; planned 0:00:12") != std::string::npos);
}

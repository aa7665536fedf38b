#include "printing/host/journal.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/resume_point.hpp"

using namespace pliant;
using namespace pliant::host;

namespace {

std::string three_records() {
    return write_record(1, "begin", {{"job", "a b%=\n\xff"}, {"digest", ""}, {"printer", "x"}}) +
           write_record(2, "light",
                        {{"step", "3"}, {"layer", "0"}, {"material", "1"}, {"planned", "2.5"}, {"at", "10"}}) +
           write_record(3, "dark", {{"light", "2"}, {"on", "1"}, {"done", "0"}, {"by", "host"}});
}

}  // namespace

TEST_CASE("a record has a checksum, a number, a kind and values, which may hold any bytes") {
    // CRC-32 of "1 end", by zlib.
    CHECK(write_record(1, "end", {}) == "05ec23b6 1 end\n");
    const JournalText text = parse_journal(three_records(), "x").value();
    REQUIRE(text.records.size() == 3);
    CHECK(text.records[0].text("job").value() == "a b%=\n\xff");
    CHECK(text.records[0].text("digest").value().empty());
    CHECK(text.records[1].number_of("planned").value() == 2.5);
    CHECK_FALSE(text.records[1].whole("planned"));
    CHECK_FALSE(text.records[1].text("none"));
}

TEST_CASE("a damaged end is ignored wherever it begins; damage in the middle is an error") {
    const std::string all = three_records();
    const std::size_t second = all.find('\n') + 1, third = all.find('\n', second) + 1;
    for (std::size_t bytes = 0; bytes <= all.size(); ++bytes) {
        const auto text = parse_journal(all.substr(0, bytes), "x");
        REQUIRE(text);
        const std::size_t whole = bytes == all.size() ? 3 : bytes >= third ? 2 : bytes >= second ? 1 : 0;
        CHECK(text->records.size() == whole);
        CHECK(text->good_bytes == (whole == 3 ? all.size() : whole == 2 ? third : whole == 1 ? second : 0));
    }
    for (std::size_t at = 0; at < all.size(); ++at) {
        std::string damaged = all;
        damaged[at] = static_cast<char>(damaged[at] ^ 1);
        const auto text = parse_journal(damaged, "x");
        if (at >= third)
            CHECK((text && text->records.size() == 2));
        else if (at == third - 1)  // the line end between the last two: both count as the damaged end
            CHECK((text && text->records.size() == 1));
        else
            CHECK_FALSE(text);
    }
}

TEST_CASE("a journal is kept and locked; a damaged end is cut off, and new records follow it") {
    const pliant::test::Folder folder;
    const auto path = folder.path() / "journal";
    {
        Journal journal = Journal::open(path, true).value();
        CHECK(journal.append("begin", {{"job", "x"}}).value() == 1);
        CHECK(journal.append("pause", {}).value() == 2);
        CHECK(Journal::open(path, true).error().message.find("another host") != std::string::npos);
    }
    std::ofstream(path, std::ios::app) << "0123abcd 3 dark li";
    {
        Journal journal = Journal::open(path, true).value();
        CHECK(journal.records().size() == 2);
        CHECK(journal.append("resume", {}).value() == 3);
    }
    CHECK(Journal::open(path, true).value().records().size() == 3);
    Journal journal = Journal::open(path, true).value();
    REQUIRE(journal.clear());
    CHECK(journal.append("begin", {}).value() == 1);
}

TEST_CASE("a file that is not a journal is not changed") {
    const pliant::test::Folder folder;
    const auto path = folder.path() / "picture.png";
    REQUIRE(write_file(path, "something else\nof two lines\n"));
    CHECK_FALSE(Journal::open(path, true));
    CHECK(read_file(path).value() == "something else\nof two lines\n");
    for (const char* one_line : {"a note without an end", "12345678 apples", "deadbeef1"}) {
        REQUIRE(write_file(path, one_line));
        CHECK_FALSE(Journal::open(path, true));
        CHECK(read_file(path).value() == one_line);
    }
    for (const char* begun : {"", "12", "12345678", "12345678 1 begin jo"}) {  // what a host that died may have left
        REQUIRE(write_file(path, begun));
        CHECK(Journal::open(path, true));
    }
    CHECK_FALSE(Journal::open(folder.path(), true));
    CHECK_FALSE(Journal::open(folder.path() / "no" / "folder", true));
}

TEST_CASE("a full disk is an error, and leaves no partial record") {
    const pliant::test::Folder folder;
    const auto path = folder.path() / "journal";
    Journal journal = Journal::open(path, false).value();
    REQUIRE(journal.append("begin", {}));
    const auto size = std::filesystem::file_size(path);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    const rlimit small{size + 10, before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
    const auto full = journal.append("light", {{"step", "123"}});
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &before) == 0);
    CHECK_FALSE(full);
    CHECK(full.error().message.find("no step is taken") != std::string::npos);
    CHECK(std::filesystem::file_size(path) == size);
    CHECK(journal.append("stop", {}).value() == 2);
}

TEST_CASE("the facts of a journal: parts of an exposure add up, an open exposure stays open, states are read back") {
    auto records = parse_journal(three_records(), "x").value().records;
    JournalFacts facts = facts_of(records).value();
    CHECK(facts.lights.at(3).lit_s == 1);
    CHECK_FALSE(facts.lights.at(3).complete);
    CHECK(facts.lights.at(3).open_light == 0);
    records.push_back(
        parse_journal(
            write_record(1, "light",
                         {{"step", "3"}, {"layer", "0"}, {"material", "1"}, {"planned", "2.5"}, {"at", "90"}}),
            "x")
            .value()
            .records[0]);
    records.back().number = 4;
    facts = facts_of(records).value();
    CHECK(facts.lights.at(3).open_light == 4);
    CHECK(facts.lights.at(3).open_since_s == 90);
    records.push_back({5, "dark", {{"light", "2"}, {"on", "1"}, {"done", "1"}}});
    CHECK_FALSE(facts_of(records));  // exposure 2 had already ended

    machine::Interlock::State state;
    state.position = {{1, -2, 3, 4}};
    state.homed = {true, false, true, false};
    state.slots = {std::nullopt, 1, 0};
    state.hooked_vat = 2;
    state.part_height_um = 250;
    state.pump = true;
    const std::string word = write_state(state);
    CHECK(word == "1,-2,3,4,;1010;2;250;1;-,1,0,");
    const auto back = read_state(word).value();
    CHECK(back.position == state.position);
    CHECK(back.homed == state.homed);
    CHECK(back.slots == state.slots);
    CHECK(back.hooked_vat == state.hooked_vat);
    CHECK(back.part_height_um == 250);
    CHECK(back.pump);
    CHECK_FALSE(back.magnet);
    state.magnet = state.fork_out = true;
    const auto latched = read_state(write_state(state)).value();
    CHECK(latched.pump);
    CHECK(latched.magnet);
    CHECK(latched.fork_out);
    CHECK_FALSE(read_state("1,2,3,4,;1010;2;250;8;-,"));
    for (const char* bad : {"", "1,2,3,4,;1010;2;250;1", "1,2,3,;1010;2;250;1;-", "1,2,3,4,;10;2;250;1;-,", "a"}) {
        INFO(bad);
        const auto read = read_state(bad);
        CHECK((!read || read->slots.empty()));
    }
}

TEST_CASE("what a person was asked to do is known until the next exposure begins") {
    auto records = parse_journal(three_records(), "x").value().records;
    const auto asked = [&](JournalRecord record) {
        record.number = records.back().number + 1;
        records.push_back(std::move(record));
        return facts_of(records).value().asked;
    };
    using Texts = std::vector<std::string>;
    const std::string refill = "refill the vat of slot 1 with soft", door = "the door is open: close it, then resume";
    CHECK(asked({0, "pause", {}}).empty());
    CHECK(asked({0, "pause", {{"asked", refill}}}) == Texts{refill});
    CHECK(asked({0, "pause", {{"asked", door}}}) == Texts{refill, door});
    CHECK(asked({0, "resume", {}}) == Texts{refill, door});
    CHECK(asked({0, "suspend", {}}) == Texts{refill, door});
    CHECK(asked({0, "light", {{"step", "9"}, {"layer", "1"}, {"material", "0"}, {"planned", "2"}, {"at", "99"}}})
              .empty());
}

TEST_CASE("records of another format, of an unknown kind or with nonsense are refused, and named") {
    const std::string begin = write_record(1, "begin", {{"job", "x"}, {"digest", ""}, {"printer", "x"}});
    const std::string light =
        write_record(2, "light", {{"step", "3"}, {"layer", "0"}, {"material", "1"}, {"planned", "2.5"}, {"at", "10"}});
    const auto error_of = [](const std::string& text) {
        const auto facts = facts_of(parse_journal(text, "x").value().records);
        return facts ? std::string() : facts.error().message;
    };
    CHECK(error_of(begin + light).empty());  // the first journals state no format
    const auto format = [](const char* name) {
        return write_record(1, "begin", {{"job", "x"}, {"digest", ""}, {"printer", "x"}, {"format", name}});
    };
    CHECK(error_of(format("1") + light).empty());
    CHECK(error_of(format("2")) == "journal record 1 (begin): format 2 is not known, this program writes 1");
    for (const char* kind : {"pause", "resume", "door", "suspend", "cancel", "end"})
        CHECK(error_of(begin + write_record(2, kind, {})).empty());
    CHECK(error_of(begin + write_record(2, "zzz", {})).find("journal record 2: no kind \"zzz\" is known") == 0);
    const auto third = [&](std::string_view kind, const JournalValues& values) {
        return error_of(begin + light + write_record(3, kind, values));
    };
    CHECK(third("dark", {{"light", "2"}, {"on", "-5"}, {"done", "1"}}) == "journal record 3 (dark): on=-5 is below 0");
    CHECK(third("skip", {{"layer", "-1"}}) == "journal record 3 (skip): layer=-1 is out of range");
    CHECK(third("exposure", {{"material", "0"}, {"seconds", "-3"}, {"from", "0"}}) ==
          "journal record 3 (exposure): seconds=-3 is below 0");
    CHECK(third("exposure", {{"material", "-1"}, {"seconds", "3"}, {"from", "0"}}).find("material=-1") !=
          std::string::npos);
    CHECK(third("skip", {{"layer", "1"}, {"layer", "2"}}) == "journal record 3 (skip): layer stands there twice");
}

TEST_CASE("records about steps, layers and materials that the job does not have are refused, and named") {
    Script script;
    script.steps = {std::string("G28"), machine::Expose{0, 0, 2.5, "a.png"}, machine::Expose{1, 0, 2.5, "b.png"}};
    PrintJob job;
    job.layers = 3;  // the last one is dark
    job.materials = {"soft"};
    const auto error_of = [&](const JournalFacts& facts) {
        const Status fits = check_fits(facts, script, job);
        return fits ? std::string() : fits.error().message;
    };
    JournalFacts facts;
    facts.lights[2].layer = 1;
    facts.skipped_layers = {2};
    facts.skip_records = {7};
    facts.changes = {{0, 3, 2, 8}};
    facts.go = GoFact{0, 3, 1, {}, 0, 9};
    CHECK(error_of(facts).empty());
    facts.go->step = 4;
    CHECK(error_of(facts) == "journal record 9 (go): this job has no step 4");
    facts.changes[0].material = 1;
    CHECK(error_of(facts) == "journal record 8 (exposure): this job has no material 1");
    facts.skipped_layers[0] = 3;
    CHECK(error_of(facts) == "journal record 7 (skip): this job has no layer 3");
    facts.lights[2].record = 6;
    facts.lights[2].layer = 2;
    CHECK(error_of(facts) == "journal record 6 (light): this job has no exposure of layer 2, material 0 at step 2");
}

TEST_CASE("a vat that the machine does not have is refused, and its record named") {
    const auto printer = machine::load_printer("examples/printers/tower.toml").value();
    const auto error_of = [&](const std::string& kind, const machine::Interlock::State& state) {
        const std::string word = write_state(state);
        const JournalRecord session{2, "session", {{"base", "1"}, {"before", "-1"}, {"boot", "a"}, {"state", word}}};
        const JournalRecord go{3, "go", {{"program", "0"}, {"step", "0"}, {"line", "3"}, {"state", word}}};
        const JournalFacts facts =
            facts_of({{1, "begin", {{"job", "a"}, {"digest", ""}, {"printer", "x"}}}, kind == "go" ? go : session})
                .value();
        const auto standing = standing_of(facts, {}, printer, 0, {});
        return standing ? std::string() : standing.error().message;
    };
    machine::Interlock::State state = machine::Interlock(printer).state();
    CHECK(error_of("go", state).empty());
    state.hooked_vat = 99;
    CHECK(error_of("go", state) == "journal record 3 (go): slots or vats that tower prototype does not have");
    CHECK(error_of("session", state) == "journal record 2 (session): slots or vats that tower prototype does not have");
}

TEST_CASE("what cannot be the beginning of a journal is none, whoever reads it") {
    for (const std::string& text :
         {std::string(1000, '\0'), std::string("name = \"finger\"\n"), std::string("05ec23b6 1 end\r\n")})
        CHECK(parse_journal(text, "x").error().message == "x: this is not a journal; give another name with --journal");
    CHECK(parse_journal("", "x")->records.empty());
    CHECK(parse_journal("05ec2", "x")->records.empty());
}

TEST_CASE("an exposure of unknown length is named as people count layers, with its material") {
    std::vector<JournalRecord> records = parse_journal(three_records(), "x").value().records;
    records.pop_back();  // the light is still on
    JournalFacts facts = facts_of(records).value();
    const auto open = close_open_light(facts, nullptr, {}, {"soft", "rigid"});
    REQUIRE_FALSE(open);
    CHECK(open.error().message.starts_with("layer 1, rigid: an exposure of 2.5 s was in progress"));
}

TEST_CASE("a stop says whether the board is halted or was reset; of older journals the words tell") {
    const auto stopped = [](JournalValues values) {
        return facts_of(
            {{1, "begin", {{"job", "a"}, {"digest", ""}, {"printer", "x"}}}, {2, "stop", std::move(values)}});
    };
    // The record says otherwise than its words.
    CHECK(stopped({{"quick", "1"}, {"halted", "1"}, {"reset", "0"}, {"why", "x"}})->halted);
    CHECK_FALSE(stopped({{"quick", "1"}, {"halted", "0"}, {"reset", "1"}, {"why", "the board is halted"}})->halted);
    CHECK(stopped({{"quick", "1"}, {"halted", "0"}, {"reset", "1"}, {"why", "x"}})->was_reset);
    CHECK(stopped({{"quick", "1"}, {"why", "emergency stop"}})->halted);
    CHECK_FALSE(stopped({{"quick", "1"}, {"why", "the door is open"}})->halted);
    CHECK_FALSE(stopped({{"quick", "1"}, {"why", "x"}})->was_reset);
    CHECK_FALSE(stopped({{"quick", "1"}, {"halted", "yes"}, {"why", "x"}}));
}

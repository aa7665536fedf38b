// A print with --twin and one at a port, on the same virtual printer with the same fault, write the same journal: both
// use the same engine. Only timing differs: when an exposure began, how late a busy computer ended it, and the first
// line number of a session.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <set>
#include <thread>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "printing/host/journal.hpp"
#include "small_job.hpp"

using namespace pliant;
using namespace pliant::app;
namespace fs = std::filesystem;

namespace {

constexpr int layers = 2;
constexpr double speed = 200;

/// A job in a folder of its own, with the file of its printer beside it.
struct Bench {
    test::Folder folder{"one_engine"};
    SmallJob job;

    explicit Bench(const std::string& printer, const std::function<void(std::string&)>& change = {}) {
        std::string text = read_file(fmt::format("examples/printers/{}.toml", printer)).value();
        if (change) change(text);
        auto made = write_small_job(folder.path(), text, {layers, 1, 6, 1});
        REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
        job = std::move(*made);
        REQUIRE(write_file(folder / "printer.toml", job.printer_text));
    }
    /// The exit status of a shell command line; PLIANT stands for the program, `said` receives its output.
    [[nodiscard]] int shell(const std::string& line, const std::string& said) const {
        const std::string all = fmt::format("cd {} && PLIANT={} && {{ {}; }} >{} 2>&1 </dev/null",
                                            folder.path().string(), PLIANT_PROGRAM, line, said);
        const int status = std::system(all.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    [[nodiscard]] std::string text(const std::string& name) const { return read_file(folder / name).value_or(""); }
};

/// The same print twice: by --twin, and at a port served by `pliant twin` in a process of its own.
struct TwoPrints {
    int twin_status = -1, port_status = -1;
    std::vector<host::JournalRecord> twin, port;
    std::string said;

    TwoPrints(const Bench& b, const std::string& fault) {
        const std::string with = fault.empty() ? "" : " --fault " + fault;
        twin_status = b.shell("$PLIANT print halves.zip --twin --journal twin.journal" + with, "twin.said");
        port_status = b.shell(
            fmt::format("mkdir light; $PLIANT twin --printer printer.toml --pty port --speed {0} --projector light "
                        "--clock clock{1} & machine=$!; until [ -e port ] && [ -e clock ]; do sleep 0.02; done; "
                        "$PLIANT print halves.zip --port port --projector light --clock clock --speed {0} --yes "
                        "--journal port.journal; status=$?; kill $machine; wait $machine; (exit $status)",
                        speed, with),
            "port.said");
        twin = read(b.text("twin.journal"));
        port = read(b.text("port.journal"));
        said = b.text("twin.said") + "\n--- port\n" + b.text("port.said");
    }
    static std::vector<host::JournalRecord> read(const std::string& text) {
        auto journal = host::parse_journal(text, "journal");
        return journal ? std::move(journal->records) : std::vector<host::JournalRecord>{};
    }
};

/// Removes timing; lines are counted from the start of their session.
std::string without_times(const std::vector<host::JournalRecord>& records) {
    std::string text;
    long base = 0;
    for (const host::JournalRecord& record : records) {
        if (record.kind == "session") base = record.whole("base").value_or(0);
        host::JournalValues values;
        for (const auto& [key, value] : record.values) {
            if (key == "at" || key == "on" || key == "base" || key == "boot") continue;
            values.emplace_back(key, key == "line" ? fmt::format("{}", std::atol(value.c_str()) - base) : value);
        }
        text += host::write_record(record.number, record.kind, values).substr(9);
    }
    return text;
}

/// Duration of each exposure piece, on the machine's clock. At a port that clock runs with the computer's, so that what
/// keeps a process waiting makes a piece longer, by `speed` times as much, but never shorter.
std::vector<double> lit(const std::vector<host::JournalRecord>& records) {
    std::vector<double> seconds;
    for (const host::JournalRecord& record : records) {
        if (record.kind == "dark") seconds.push_back(record.number_of("on").value_or(-1));
    }
    return seconds;
}

struct Case {
    std::string printer, fault;
    std::string ends;  ///< a line of the journal, or part of one, that tells how
};

const std::vector<Case> cases = {
    {"tower", "", " end\n"},
    {"tower", "missed-steps:12:0.02", " end\n"},
    {"tower", "dark-projector:2", " end\n"},
    {"tower", "empty-vat:2", " end\n"},
    {"tower", "stuck-hook:1", " end\n"},
    {"tower", "lose-line:60", " end\n"},
    {"tower", "reset:60", "restarted"},
    {"tower", "dead-switch:2", "homing%20failed"},
    {"tower", "stuck-switch:1", ""},
    {"tower_magnet", "weak-magnet:1", " end\n"},
    {"wall", "stuck-fork:1", " end\n"},
};

}  // namespace

TEST_CASE("print --twin and a print over the wire write the same journal, with any fault") {
    std::vector<std::unique_ptr<Bench>> benches;
    std::vector<std::optional<TwoPrints>> prints(cases.size());
    for (const Case& c : cases) benches.push_back(std::make_unique<Bench>(c.printer));
    {
        std::vector<std::jthread> workers;  // they wait most of the time
        for (std::size_t i = 0; i < cases.size(); ++i)
            workers.emplace_back([&, i] { prints[i].emplace(*benches[i], cases[i].fault); });
    }
    constexpr double rounding_s = 2e-3;  // journals have milliseconds
    double least_late_s = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cases.size(); ++i) {
        CAPTURE(cases[i].printer);
        CAPTURE(cases[i].fault);
        const TwoPrints& p = *prints[i];
        CAPTURE(p.said);
        const std::string here = without_times(p.twin), there = without_times(p.port);
        CHECK(here == there);
        CHECK(here.find(cases[i].ends) != std::string::npos);
        // A port has no oracle: defects of the part only fail the virtual print.
        CHECK(p.port_status == (here.find(" end\n") != std::string::npos ? 0 : 1));
        CHECK(p.twin_status == (cases[i].fault.empty() || cases[i].fault == "lose-line:60" ? 0 : 1));
        const std::vector<double> seconds = lit(p.twin), over_wire = lit(p.port);
        REQUIRE(seconds.size() == over_wire.size());
        for (std::size_t k = 0; k < seconds.size(); ++k) {
            const double late_s = over_wire[k] - seconds[k];
            CHECK(late_s > -rounding_s);
            least_late_s = std::min(least_late_s, late_s);
        }
    }
    // An engine that exposes for longer does so each time; a busy computer spares one of all exposures.
    CHECK(least_late_s < 0.5);
    REQUIRE(lit(prints[0]->twin).size() == 2 * layers);
    CHECK(lit(prints[0]->twin)[0] == near(6, {.relative = 1e-9}));
}

TEST_CASE("printing the same job twice gives the same bytes of journal") {
    const Bench b("tower");
    REQUIRE(b.shell("$PLIANT print halves.zip --twin --journal a && $PLIANT print halves.zip --twin --journal b",
                    "said") == 0);
    CHECK(b.text("a").size() > 1000);
    CHECK(b.text("a") == b.text("b"));
    CHECK(test::holds(b.text("a"), "vats=slot%201:%20semi-flex"));
}

TEST_CASE("a virtual print that asks for resin runs to its end, and the journal holds the request") {
    const Bench b("tower", [](std::string& text) {  // more than must stay in a vat: enough for one layer
        for (std::size_t at = 0; (at = text.find("\"700 ml\"")) != std::string::npos;)
            text.replace(at, 8, "\"60.00004 ml\"");
    });
    const int status = b.shell("$PLIANT print halves.zip --twin --journal journal", "said");
    CAPTURE(b.text("said"));
    CHECK(status == 0);
    const std::string journal = b.text("journal");
    CHECK(test::holds(journal, " pause asked=refill%20the%20vat%20of%20slot%20"));
    CHECK(journal.find(" resume\n") > journal.find(" pause "));
    CHECK(journal.find(" end\n") > journal.find(" resume\n"));
}

TEST_CASE("a virtual print that is killed or cancelled leaves no file") {
    const Bench b("tower");
    const auto names = [&] {
        std::set<std::string> all;
        for (const auto& entry : fs::directory_iterator(b.folder.path())) all.insert(entry.path().filename());
        return all;
    };
    // A command after a layer acts in the middle of the print.
    for (const std::string signal : {"KILL", "INT"}) {
        CAPTURE(signal);
        const std::set<std::string> before = names();
        const int status = b.shell(
            "$PLIANT print halves.zip --twin --journal journal --report page.html -o verdict.json "
            "--after-layer 'kill -" +
                signal + " $PPID'",
            "/dev/null");
        CHECK(status != 0);
        CHECK(names() == before);
    }
}

TEST_CASE("a virtual print replaces neither the journal of an interrupted print nor the job") {
    const Bench b("tower");
    REQUIRE(b.shell("$PLIANT print halves.zip --twin --journal journal --fault reset:60", "said") == 1);
    const std::string interrupted = b.text("journal"), job = b.text("halves.zip");
    REQUIRE(interrupted.size() > 1000);
    for (const std::string how : {"", " --speed 200"}) {
        CAPTURE(how);
        CHECK(b.shell("$PLIANT print halves.zip --twin --journal journal" + how, "said") == 2);
        CHECK(test::holds(b.text("said"), "a print that was interrupted"));
        CHECK(b.text("journal") == interrupted);
    }
    // Held by a host, as by `flock`, which locks as a journal does.
    CHECK(b.shell("flock held -c \"$PLIANT print halves.zip --twin --journal held\"", "said") == 2);
    CHECK(test::holds(b.text("said"), "another host"));
    CHECK(b.text("held").empty());
    for (const std::string option : {"--report halves.zip", "-o halves.zip", "--journal halves.zip"}) {
        CAPTURE(option);
        CHECK(b.shell("$PLIANT print halves.zip --twin " + option, "said") == 2);
        CHECK(b.text("halves.zip") == job);
    }
    CHECK(b.shell("cp halves.zip job.json; $PLIANT print job.json --twin -o ./job.json", "said") == 2);
    CHECK(test::holds(b.text("said"), "is the job itself"));
    CHECK(b.text("job.json") == job);
}

TEST_CASE("an option that would do nothing is refused") {
    const Bench b("tower");
    for (const auto& [call, said] : {
             std::pair<std::string, std::string>{"print halves.zip --twin --projector .",
                                                 "--projector goes with --port"},
             {"print halves.zip --report page.html --resume", "--resume goes with --port or --twin"},
             {"print halves.zip --report page.html --speed 5 -q", "--speed goes with --port or --twin"},
             {"print halves.zip --report page.html -o verdict.json", "--output goes with --port or --twin"},
             {"print halves.zip --twin --assume-lit 1", "--assume-lit goes with --resume"},
             {"print halves.zip --port none --projector . --assume-lit 1", "--assume-lit goes with --resume"},
             {"print halves.zip --port none --projector . --assume-vats-untouched",
              "--assume-vats-untouched goes with --resume"},
             {"print halves.zip --port none --projector . -o r.json", "-o goes with --twin"},
             {"check halves.zip --cancel-after 3", "--cancel-after ends a G-code program"},
             {"check halves.zip --port none", "--port goes with --firmware"},
             {"export halves.zip --as sl1 -o stack.sl1", "-o stack.sl1: is for a folder"},
         }) {
        CAPTURE(call);
        CHECK(b.shell("$PLIANT " + call, "said") == 2);
        CHECK(test::holds(b.text("said"), said));
    }
}

TEST_CASE("-o writes the verdict of a virtual print, in real time too") {
    const Bench b("tower");
    REQUIRE(b.shell("$PLIANT print halves.zip --twin -q --speed 200 -o verdict.json", "said") == 0);
    CHECK(test::holds(b.text("verdict.json"), "\"passed\": true"));
}

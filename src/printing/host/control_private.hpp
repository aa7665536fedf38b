// The private state of a Control: what its threads share, and the steps of the working thread. Not for others: include
// control.hpp.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "printing/host/control.hpp"
#include "printing/host/desk.hpp"
#include "printing/host/journal.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/machine.hpp"
#include "printing/host/print_run.hpp"
#include "printing/host/resume_point.hpp"
#include "printing/host/script.hpp"

namespace pliant::host {

inline constexpr const char* after_emergency_stop =
    "emergency stop: the board is halted; reset it (its button, or its power off and on) before anything else";

/// Errors: the printer is in none of these states.
[[nodiscard]] std::function<Status(const Snapshot&)> only_when(std::vector<State> states);

/// A request that waits for the working thread.
struct Control::Task {
    std::function<void()> run;
    bool for_machine = true;  ///< dropped after a failure or an emergency stop, unlike the loading of a job
    long stops = 0;           ///< number of emergency stops when it was requested
};

/// The private state. The last members are used by the working thread only.
struct Control::Private {
    explicit Private(ControlSetup s) : setup(std::move(s)), desk(setup.clock) {}

    ControlSetup setup;
    Desk desk;
    std::mutex mutex;  ///< protects tasks, quitting, and `wire` while it is replaced
    std::condition_variable woken;
    std::deque<Task> tasks;
    bool quitting = false;
    bool hears_m112 = true;  ///< acts on M112 at once, even when busy: EMERGENCY_PARSER
    std::shared_ptr<Wire> wire;
    bool moves_by_hand = false;    ///< a single move, which the next one stops
    bool stopped_by_hand = false;  ///< this has happened

    // Working thread only:
    std::unique_ptr<Machine> machine;
    bool connects = false;  ///< until the controller has answered, and whatever is checked before the first command
    bool touched = false;   ///< something was sent to the controller since the last start
    /// Of the controller when the wire was opened, or before this host only asked questions.
    long last_line = 0;
    long sent_line = 0;  ///< the last one of the link before the present one
    long wire_line = 0;  ///< of the controller when the wire was opened, its questions included
    /// `last_line`, if only line numbers and queries have been sent since: connecting first, or idling, and resuming
    /// later then proves as much as resuming at once.
    std::optional<long> untouched_line;
    bool all_done = false;  ///< and the controller has carried out everything that the journal names up to that line
    long last_base = 0;     ///< of our previous session
    bool may_be_halted = false;  ///< the controller was halted when last heard
    std::optional<PrintJob> job;
    Script script;
    std::vector<double> times;

    [[nodiscard]] Status ask_for(std::optional<State> next, const std::function<Status(const Snapshot&)>& allowed,
                                 std::function<void()> task, bool for_machine = true);
    [[nodiscard]] bool stop_move();
    [[nodiscard]] Status run_one_move(const std::string& program);
    [[nodiscard]] Status by_hand(std::function<Result<std::string>(const machine::Interlock&)> program,
                                 bool one_move = false);
    bool run_next_task();

    [[nodiscard]] Status watch();
    [[nodiscard]] Status open_wire();
    [[nodiscard]] Status open();
    void renew_machine(const LinkOptions& options);
    void hear_machine();
    [[nodiscard]] Status find_last_line();
    [[nodiscard]] Status keep_line_numbers();
    void forget_line();
    [[nodiscard]] long begin_numbers(const JournalFacts& facts, const Standing& standing);
    [[nodiscard]] Status note_session(Journal& journal, long base, const Standing& standing) const;
    [[nodiscard]] Status connect_machine(long base, Journal* journal);
    [[nodiscard]] Status begin_journal(Journal& journal, long base, const Standing& standing);
    void close();
    void do_connect();
    void do_start(const StartOptions& options, bool abandon);
    [[nodiscard]] Result<Ending> print(const StartOptions& options, bool abandon, Journal* journal);
    [[nodiscard]] Result<Ending> print_anew(Journal* journal);
    [[nodiscard]] Result<Ending> go_on(const StartOptions& options, bool abandon, Journal& journal);
    [[nodiscard]] Status preflight() const;
    [[nodiscard]] Status check_journal(const JournalFacts& facts) const;
    void finish(const Result<Ending>& ending);
    void leave();
    void show_machine();
    void show_switches();
    void note_firmware();
    void fail(const Error& error);
    void look_at_journal();
};

}  // namespace pliant::host

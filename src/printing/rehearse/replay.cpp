#include "printing/rehearse/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <variant>

#include "printing/host/journal_facts.hpp"
#include "printing/host/script.hpp"

namespace pliant::rehearse {
namespace {

using host::JournalRecord;

/// Whether the machine is where a record says. Axes whose position the record does not know may be anywhere.
bool same_place(const machine::Interlock::State& a, const machine::Interlock::State& b) {
    for (const machine::Axis axis : machine::all_axes) {
        const auto i = static_cast<std::size_t>(axis);
        if (b.homed[i] && (!a.homed[i] || a.position[axis] != b.position[axis])) return false;
    }
    return a.hooked_vat == b.hooked_vat && a.slots == b.slots && a.pump == b.pump && a.magnet == b.magnet &&
           a.fork_out == b.fork_out;
}

/// Commands outside the job.
struct Program {
    long number = 0;  ///< of its record
    std::vector<std::string> commands;
    std::size_t next = 0;
};

class Replayer {
public:
    Replayer(const host::PrintJob& job, host::Script script, twin::Twin& twin)
        : job_(job), script_(std::move(script)), twin_(twin) {}

    Status run(const std::vector<JournalRecord>& records) {
        for (const JournalRecord& record : records) note_end_of_light(record);
        for (const JournalRecord& record : records) {
            if (Status status = take(record); !status)
                return failure("record {} of the journal: {}", record.number, status.error().message);
        }
        return set_line();
    }

private:
    /// Notes how long each exposure lasted, by the number of its record.
    void note_end_of_light(const JournalRecord& record) {
        if (record.kind != "dark") return;
        const auto light = record.whole("light");
        const auto on = record.number_of("on");
        if (light && on) lit_s_[*light] = *on;
    }

    Status take(const JournalRecord& record) {
        if (record.kind == "light") return light(record);
        if (record.kind == "go") return go(record);
        if (record.kind == "program") return begin_program(record);
        if (record.kind == "session") {
            // What was in progress when the host died stays undone: the machine is where the journal proves it to be.
            programs_.clear();
            return {};
        }
        if (record.kind == "pause") {
            const std::string* asked = record.find("asked");
            asked_ = asked != nullptr ? *asked : "";
            return end_programs();
        }
        if (record.kind == "resume") {
            pour();
            return {};
        }
        if (record.kind == "suspend" || record.kind == "cancel" || record.kind == "end") return end_programs();
        return {};
    }

    /// A program may begin in the middle of another, as a check of a switch does during homing; the outer one continues
    /// afterwards. Nothing is executed before a record proves it.
    Status begin_program(const JournalRecord& record) {
        const auto text = record.text("text");
        if (!text) return tl::unexpected(text.error());
        programs_.push_back({record.number, host::commands_of(*text)});
        return {};
    }

    /// Executes the rest of all programs, after which the journal continues.
    Status end_programs() {
        while (!programs_.empty()) {
            if (Status status = run_program(programs_.back(), programs_.back().commands.size()); !status) return status;
            programs_.pop_back();
        }
        return {};
    }

    Status run_program(Program& program, std::size_t to) {
        for (; program.next < std::min(to, program.commands.size()); ++program.next) {
            if (Status status = send(program.commands[program.next]); !status) return status;
        }
        return {};
    }

    Status go(const JournalRecord& record) {
        const auto program = record.whole("program"), step = record.whole("step"), line = record.whole("line");
        const auto word = record.text("state");
        if (!program) return tl::unexpected(program.error());
        if (!step) return tl::unexpected(step.error());
        if (!line) return tl::unexpected(line.error());
        if (!word) return tl::unexpected(word.error());
        const auto state = host::read_state(*word);
        if (!state) return tl::unexpected(state.error());
        if (*step < 0) return failure("there is no step {}", *step);
        Status there = *program == 0 ? go_in_job(static_cast<std::size_t>(*step))
                                     : go_in_program(*program, static_cast<std::size_t>(*step), *state);
        if (!there) return there;
        if (!same_place(twin_.interlock().state(), *state))
            return failure("the machine does not come by the place that it was at");
        line_ = *line;
        return {};
    }

    /// After a program that led to an exposure the job continues there; otherwise from where it was.
    Status go_in_job(std::size_t step) {
        const bool led = !programs_.empty();
        if (Status status = end_programs(); !status) return status;
        return led ? jump(step) : run_job(step);
    }

    Status go_in_program(long number, std::size_t step, const machine::Interlock::State& state) {
        const auto known = std::ranges::find(programs_, number, &Program::number);
        if (known == programs_.end()) return failure("there is no program {} there", number);
        while (programs_.back().number != number) {
            if (Status status = run_program(programs_.back(), programs_.back().commands.size()); !status) return status;
            programs_.pop_back();
        }
        if (step == 0 && programs_.back().next == 0) {
            if (Status status = come_to(state); !status) return status;
        }
        return run_program(programs_.back(), step);
    }

    /// Executes the rest of the previous program, or of the job, up to the place where the last program begins. A
    /// program that is then at its end is finished.
    Status come_to(const machine::Interlock::State& state) {
        if (programs_.size() < 2) return run_job_to(state);
        Program& before = programs_[programs_.size() - 2];
        while (before.next < before.commands.size() && !same_place(twin_.interlock().state(), state)) {
            if (Status status = run_program(before, before.next + 1); !status) return status;
        }
        if (before.next == before.commands.size()) programs_.erase(programs_.end() - 2);
        return {};
    }

    Status jump(std::size_t step) {
        if (step > script_.steps.size()) return failure("there is no step {} in this job", step);
        step_ = step;
        return {};
    }

    /// Executes the commands of the job up to a step, without the exposures on the way.
    Status run_job(std::size_t to) {
        if (to > script_.steps.size()) return failure("there is no step {} in this job", to);
        for (; step_ < to; ++step_) {
            if (const auto* command = std::get_if<std::string>(&script_.steps[step_])) {
                if (Status status = send(*command); !status) return status;
            }
        }
        return {};
    }

    /// Executes commands of the job, up to the next exposure, until the machine is at a place.
    Status run_job_to(const machine::Interlock::State& state) {
        while (step_ < script_.steps.size() && !same_place(twin_.interlock().state(), state)) {
            if (script_.light(step_) != nullptr) break;
            if (Status status = run_job(step_ + 1); !status) return status;
        }
        return {};
    }

    Status light(const JournalRecord& record) {
        const auto step = record.whole("step");
        if (!step) return tl::unexpected(step.error());
        if (*step < 0 || static_cast<std::size_t>(*step) >= script_.steps.size())
            return failure("there is no step {} in this job", *step);
        const machine::Expose* light = script_.light(static_cast<std::size_t>(*step));
        if (light == nullptr) return failure("step {} of this job is no light", *step);
        if (Status status = go_in_job(static_cast<std::size_t>(*step)); !status) return status;
        step_ = std::max(step_, static_cast<std::size_t>(*step) + 1);
        const auto on = lit_s_.find(record.number);
        if (on == lit_s_.end() || on->second <= 0) return {};
        const auto image = job_.images(light->layer, light->material);
        if (!image) return tl::unexpected(image.error());
        if (Status status = talk("M400"); !status) return status;
        twin_.light_on(*image);
        twin_.advance_to(twin_.now() + on->second);
        twin_.light_off();
        return {};
    }

    /// Before a resume, the operator has done what the pause asked for.
    void pour() {
        for (const host::Refill& refill : job_.refills) {
            if (asked_.empty() || refill.text != asked_) continue;
            if (refill.slot == 0)
                twin_.care(refill.care);
            else
                twin_.fill_vat(refill.slot);
        }
        asked_.clear();
    }

    Status send(const std::string& command) {
        if (line_ > 0) ++line_;
        return talk(command);
    }

    /// Repeats until the twin has accepted the line.
    Status talk(const std::string& line) {
        twin_.receive(line + "\n");
        std::string said = twin_.take_output();
        while (said.find("ok") == std::string::npos) {
            const auto next = twin_.next_event();
            if (!next) return failure("the virtual printer does not answer {}", line);
            twin_.advance_to(*next);
            said += twin_.take_output();
            if (said.find("Error") != std::string::npos) return failure("{}: {}", line, said);
        }
        return {};
    }

    Status set_line() {
        if (Status status = talk("M400"); !status || line_ <= 0) return status;
        return talk(fmt::format("M110 N{}", line_ - 1));
    }

    const host::PrintJob& job_;
    const host::Script script_;
    twin::Twin& twin_;
    std::map<long, double> lit_s_;
    std::size_t step_ = 0;           ///< next step of the job
    std::vector<Program> programs_;  ///< begun and not ended, each in the middle of the previous one
    long line_ = 0;                  ///< line number of the next command; 0: none was sent
    std::string asked_;
};

}  // namespace

Status replay(const std::vector<JournalRecord>& records, const host::PrintJob& job, twin::Twin& twin) {
    const auto facts = host::facts_of(records);
    if (!facts) return tl::unexpected(facts.error());
    if (!host::is_interrupted(*facts)) return {};
    if (facts->digest != job.digest) return failure("the journal is of another job, or the job has changed since");
    auto script = host::read_script(job.gcode);
    if (!script) return tl::unexpected(script.error());
    return Replayer(job, std::move(*script), twin).run(records);
}

}  // namespace pliant::rehearse

#include "printing/host/journal_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "printing/machine/gcode.hpp"

namespace pliant::host {
namespace {

using machine::Interlock;

std::string vat_word(const std::optional<int>& vat) {
    return vat ? fmt::format("{}", *vat) : "-";
}

/// Removes the text up to the next `end` from `rest` and returns it.
std::string_view take(std::string_view& rest, char end) {
    const std::string_view part = rest.substr(0, rest.find(end));
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
    return part;
}

/// Positions and the like, in micrometres: up to 100 m.
bool read_int(std::string_view text, int& value) {
    constexpr int most = 100'000'000;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return code == std::errc() && end == text.data() + text.size() && value >= -most && value <= most;
}

bool read_vat(std::string_view text, std::optional<int>& vat) {
    if (text == "-") return true;
    int value = 0;
    if (!read_int(text, value)) return false;
    vat = value;
    return true;
}

bool read_flag(std::string_view text, bool& flag) {
    flag = text == "1";
    return text == "0" || text == "1";
}

/// Processes the records one after the other.
class Reader {
public:
    explicit Reader(JournalFacts& facts) : facts_(facts) {}

    Status take(const JournalRecord& r) {
        if (Status once = keys_once(r); !once) return once;
        if (r.kind == "begin") return begin(r);
        if (!facts_.begun) return input_error("journal record {} ({}) stands before the beginning", r.number, r.kind);
        if (r.kind == "session") return session(r);
        if (r.kind == "program") return program(r);
        if (r.kind == "go") return go(r);
        if (r.kind == "light") return light(r);
        if (r.kind == "dark") return dark(r);
        if (r.kind == "exposure") return exposure(r);
        if (r.kind == "skip") return skip(r);
        if (r.kind == "hook") return hook(r);
        if (r.kind == "stop") return stop(r);
        if (r.kind == "pause") return pause(r);
        if (r.kind == "end") facts_.ended = true;
        if (r.kind == "cancel") facts_.cancelled = true;
        constexpr std::array<std::string_view, 6> others{"end", "cancel", "resume", "door", "suspend", "note"};
        if (std::ranges::find(others, r.kind) != others.end()) return {};
        return input_error(
            "journal record {}: no kind \"{}\" is known; it is of another version of Pliant, or no journal", r.number,
            r.kind);
    }

private:
    static Status keys_once(const JournalRecord& r) {
        for (const auto& [key, value] : r.values) {
            if (std::ranges::count(r.values, key, &std::pair<std::string, std::string>::first) > 1)
                return input_error("journal record {} ({}): {} stands there twice", r.number, r.kind, key);
        }
        return {};
    }
    /// A whole number that may count layers, steps or materials.
    static Result<int> index(const JournalRecord& r, std::string_view key) {
        const auto value = r.whole(key);
        if (!value) return tl::unexpected(value.error());
        if (*value < 0 || *value > 1'000'000'000)
            return input_error("journal record {} ({}): {}={} is out of range", r.number, r.kind, key, *value);
        return static_cast<int>(*value);
    }
    static Result<double> seconds(const JournalRecord& r, std::string_view key) {
        const auto value = r.number_of(key);
        if (value && !(*value >= 0))
            return input_error("journal record {} ({}): {}={:g} is below 0", r.number, r.kind, key, *value);
        return value;
    }
    /// nullopt: the record does not say.
    static Result<std::optional<bool>> flag(const JournalRecord& r, std::string_view key) {
        if (r.find(key) == nullptr) return std::optional<bool>();
        return r.whole(key).map([](long value) { return std::optional(value != 0); });
    }
    /// For the first journals, whose stops have no `halted`.
    static bool tells_of_halt(const JournalRecord& r) {
        const std::string* why = r.find("why");
        return why != nullptr && (why->find("emergency stop") == 0 || why->find("halted") != std::string::npos);
    }
    Status begin(const JournalRecord& r) {
        const std::string* format = r.find("format");  // the first journals had none
        if (format != nullptr && *format != "1")
            return input_error("journal record {} (begin): format {} is not known, this program writes 1", r.number,
                               format->substr(0, 40));
        const auto job = r.text("job"), digest = r.text("digest"), printer = r.text("printer");
        for (const auto* value : {&job, &digest, &printer}) {
            if (!*value) return tl::unexpected(value->error());
        }
        facts_.begun = true;
        facts_.job = *job;
        facts_.digest = *digest;
        facts_.printer = *printer;
        return {};
    }
    Status session(const JournalRecord& r) {
        const auto base = r.whole("base"), before = r.whole("before");
        const auto boot = r.text("boot"), word = r.text("state");
        if (!base) return tl::unexpected(base.error());
        if (!before) return tl::unexpected(before.error());
        if (!boot) return tl::unexpected(boot.error());
        const auto state = word ? read_state(*word) : tl::unexpected(word.error());
        if (!state) return input_error("journal record {}: {}", r.number, state.error().message);
        facts_.base = *base;
        facts_.before_base = *before;
        facts_.boot = *boot;
        facts_.stopped_short = facts_.halted = facts_.was_reset = false;
        facts_.go = GoFact{-1, 0, *base + 1, *state, 0, r.number};
        return {};
    }
    Status program(const JournalRecord& r) {
        const auto text = r.text("text");
        if (!text) return tl::unexpected(text.error());
        facts_.programs[r.number] = commands_of(*text);
        return {};
    }
    Status go(const JournalRecord& r) {
        const auto program = r.whole("program"), step = r.whole("step"), line = r.whole("line");
        for (const auto* value : {&program, &step, &line}) {
            if (!*value) return tl::unexpected(value->error());
            if (**value < 0) return input_error("journal record {} (go): below 0", r.number);
        }
        const auto word = r.text("state");
        const auto state = word ? read_state(*word) : tl::unexpected(word.error());
        if (!state) return input_error("journal record {}: {}", r.number, state.error().message);
        if (*program != 0 && facts_.programs.count(*program) == 0)
            return input_error("journal record {}: there is no program {}", r.number, *program);
        long most = 0;
        if (r.find("most") != nullptr) {
            const auto given = r.whole("most");
            if (!given) return tl::unexpected(given.error());
            most = std::max(0L, *given);
        }
        facts_.moved = true;
        facts_.go = GoFact{*program, static_cast<std::size_t>(*step), *line, *state, most, r.number};
        return {};
    }
    Status light(const JournalRecord& r) {
        const auto step = r.whole("step"), layer = r.whole("layer"), material = r.whole("material");
        for (const auto* value : {&step, &layer, &material}) {
            if (!*value) return tl::unexpected(value->error());
            if (**value < 0 || **value > 1'000'000'000)
                return input_error("journal record {} (light): out of range", r.number);
        }
        const auto planned = seconds(r, "planned"), at = r.number_of("at");
        if (!planned) return tl::unexpected(planned.error());
        if (!at) return tl::unexpected(at.error());
        const auto index = static_cast<std::size_t>(*step);
        LightFact& fact = facts_.lights[index];
        open_.erase(fact.open_light);
        open_[r.number] = index;
        fact.record = r.number;
        fact.layer = static_cast<int>(*layer);
        fact.material = static_cast<int>(*material);
        fact.planned_s = *planned;
        fact.open_light = r.number;
        fact.open_since_s = *at;
        facts_.last_light = index;
        facts_.asked.clear();
        return {};
    }
    Status pause(const JournalRecord& r) {
        if (const std::string* asked = r.find("asked")) facts_.asked.push_back(*asked);
        return {};
    }
    Status dark(const JournalRecord& r) {
        const auto light = r.whole("light"), done = r.whole("done");
        const auto on = r.number_of("on");
        if (!light) return tl::unexpected(light.error());
        if (!done) return tl::unexpected(done.error());
        if (!on) return tl::unexpected(on.error());
        constexpr double clock_step_s = 1;  // back, which a light that was just switched on may be measured across
        if (!(*on > -clock_step_s)) return input_error("journal record {} (dark): on={:g} is below 0", r.number, *on);
        const auto open = open_.find(*light);
        if (open == open_.end()) return input_error("journal record {} (dark): light {} was not on", r.number, *light);
        LightFact& fact = facts_.lights[open->second];
        open_.erase(open);
        fact.open_light = 0;
        fact.lit_s += std::max(0.0, *on);
        fact.complete = *done != 0;
        return {};
    }
    Status exposure(const JournalRecord& r) {
        const auto material = index(r, "material"), from = index(r, "from");
        const auto light_s = seconds(r, "seconds");
        if (!material) return tl::unexpected(material.error());
        if (!from) return tl::unexpected(from.error());
        if (!light_s) return tl::unexpected(light_s.error());
        facts_.changes.push_back({*material, *light_s, *from, r.number});
        return {};
    }
    Status skip(const JournalRecord& r) {
        const auto layer = index(r, "layer");
        if (!layer) return tl::unexpected(layer.error());
        facts_.skipped_layers.push_back(*layer);
        facts_.skip_records.push_back(r.number);
        return {};
    }
    Status hook(const JournalRecord& r) {
        const auto layer = index(r, "layer");
        if (!layer) return tl::unexpected(layer.error());
        facts_.hook = HookFact{*layer, r.number};
        return {};
    }
    Status stop(const JournalRecord& r) {
        const auto quick = r.whole("quick");
        if (!quick) return tl::unexpected(quick.error());
        facts_.stopped_short = facts_.stopped_short || *quick != 0;
        const auto halted = flag(r, "halted"), reset = flag(r, "reset");
        if (!halted) return tl::unexpected(halted.error());
        if (!reset) return tl::unexpected(reset.error());
        facts_.was_reset = reset->value_or(false);
        facts_.halted = halted->value_or(tells_of_halt(r));
        return {};
    }

    JournalFacts& facts_;
    std::map<long, std::size_t> open_;  ///< by record of a light without a `dark`: its step
};

}  // namespace

std::string write_state(const Interlock::State& state) {
    std::string position, homed, slots;
    for (const machine::Axis axis : machine::all_axes) {
        position += fmt::format("{},", state.position[axis]);
        homed += state.homed[static_cast<std::size_t>(axis)] ? '1' : '0';
    }
    for (const auto& vat : state.slots) slots += vat_word(vat) + ",";
    return fmt::format("{};{};{};{};{};{}", position, homed, vat_word(state.hooked_vat), state.part_height_um,
                       (state.pump ? 1 : 0) + (state.magnet ? 2 : 0) + (state.fork_out ? 4 : 0), slots);
}

Result<Interlock::State> read_state(std::string_view word) {
    constexpr std::size_t most_slots = 1000;
    const auto wrong = [&] { return input_error("\"{}\" is not the state of a machine", word.substr(0, 80)); };
    Interlock::State state;
    std::string_view rest = word;
    std::string_view position = take(rest, ';');
    for (const machine::Axis axis : machine::all_axes) {
        if (!read_int(take(position, ','), state.position[axis])) return wrong();
    }
    const std::string_view homed = take(rest, ';');
    if (homed.size() != machine::axis_count) return wrong();
    for (std::size_t i = 0; i < homed.size(); ++i) {
        if (!read_flag(homed.substr(i, 1), state.homed[i])) return wrong();
    }
    if (!read_vat(take(rest, ';'), state.hooked_vat)) return wrong();
    int outputs = 0;
    if (!read_int(take(rest, ';'), state.part_height_um) || !read_int(take(rest, ';'), outputs)) return wrong();
    if (outputs < 0 || outputs > 7) return wrong();
    state.pump = (outputs & 1) != 0;
    state.magnet = (outputs & 2) != 0;
    state.fork_out = (outputs & 4) != 0;
    while (!rest.empty()) {
        if (state.slots.size() == most_slots) return wrong();
        if (!read_vat(take(rest, ','), state.slots.emplace_back())) return wrong();
    }
    return state;
}

bool is_interrupted(const JournalFacts& facts) {
    return facts.begun && !facts.ended && !facts.cancelled && (facts.moved || !facts.lights.empty());
}

Result<JournalFacts> facts_of(const std::vector<JournalRecord>& records) {
    JournalFacts facts;
    Reader reader(facts);
    for (const JournalRecord& record : records) {
        if (Status status = reader.take(record); !status) return tl::unexpected(status.error());
    }
    return facts;
}

std::vector<std::string> commands_of(std::string_view program) {
    std::vector<std::string> commands;
    while (!program.empty()) {
        const std::string_view line = program.substr(0, program.find('\n'));
        program.remove_prefix(std::min(program.size(), line.size() + 1));
        const std::string_view command = machine::is_directive(line) ? "" : machine::strip_comment(line);
        if (!command.empty()) commands.emplace_back(command);
    }
    return commands;
}

}  // namespace pliant::host

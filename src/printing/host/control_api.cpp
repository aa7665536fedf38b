#include "printing/host/control_api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/core/json.hpp"

namespace pliant::host {
namespace {

using json = nlohmann::json;
using machine::Axis;

// State as JSON.

json state_json(const Snapshot& s) {
    const bool connected = s.state != State::offline && s.state != State::connecting && s.state != State::halted;
    return {{"text", state_text(s)},
            {"message", s.message},
            {"flags",
             {{"operational", connected},
              {"ready", s.state == State::idle},
              {"printing", s.state == State::printing},
              {"pausing", s.state == State::pausing},
              {"paused", s.state == State::paused},
              {"cancelling", s.state == State::cancelling},
              {"working", s.state == State::working},
              {"error", s.state == State::halted},
              {"closedOrError", !connected}}}};
}

json or_null(bool known, json value) {
    return known ? std::move(value) : json(nullptr);
}

json job_json(const Snapshot& s) {
    return {{"file", {{"name", or_null(!s.job.empty(), s.job)}}},
            {"estimatedPrintTime", or_null(!s.job.empty(), s.seconds_planned)},
            {"layers", s.layers},
            {"canResume", s.can_resume}};
}

json progress_json(const Snapshot& s) {
    return {{"completion", or_null(!s.job.empty(), s.completion * 100)},
            {"printTime", or_null(!s.job.empty(), s.seconds_done)},
            {"begun", s.begun_s ? json(*s.begun_s) : json(nullptr)},
            {"printTimeLeft", or_null(!s.job.empty(), s.seconds_left)},
            {"layer", or_null(s.layer >= 0, s.layer)},
            {"material", or_null(s.material >= 0, s.material)},
            {"image", or_null(!s.image.empty(), s.image)},
            {"lit", s.lit},
            {"litTime", s.lit_s},
            {"exposureTime", s.exposure_s},
            {"exposures", s.exposures_s},
            {"prompt", or_null(!s.prompt.empty(), s.prompt)},
            {"finished", s.finished},
            {"failed", s.failed}};
}

json machine_json(const Snapshot& s) {
    json axes = json::object();
    for (const Axis axis : machine::all_axes) {
        const auto index = static_cast<std::size_t>(axis);
        if (!s.has_axis[index]) continue;
        axes[std::string(machine::axis_name(axis))] = {{"position", s.position[axis] / 1000.0},
                                                       {"homed", s.homed[index]}};
    }
    json switches = json::object();
    for (const machine::SwitchReading& reading : s.switches) switches[reading.name] = reading.pressed;
    return {{"axes", axes},
            {"slot", s.slot},
            {"switches", switches},
            {"pump", s.pump},
            {"door", s.door_open ? json(*s.door_open ? "open" : "shut") : json(nullptr)},
            {"firmware", s.firmware},
            {"linesSent", s.lines_sent},
            {"resends", s.resends}};
}

json event_json(const Event& e) {
    return {{"number", e.number}, {"clock", e.clock_s}, {"kind", e.kind}, {"text", e.text}};
}

std::string message(const Control& control, std::string_view kind, long& last_event) {
    const std::vector<Event> events = control.events_since(last_event);
    const Snapshot s = control.snapshot();
    json list = json::array();
    for (const Event& event : events) {
        list.push_back(event_json(event));
        last_event = std::max(last_event, event.number);
    }
    const json content = {{"state", state_json(s)},
                          {"job", job_json(s)},
                          {"progress", progress_json(s)},
                          {"machine", machine_json(s)},
                          {"events", list}};
    // Names and messages may contain any bytes.
    return json_text(json{{std::string(kind), content}});
}

// Requests.

ApiAnswer with(const json& content) {
    return {200, json_text(content)};
}

ApiAnswer refusal(int status, std::string_view why) {
    return {status, json_text(json{{"error", why}})};
}

/// Bad input is a bad request; what the present state forbids is a conflict.
ApiAnswer answer(const Status& status) {
    if (status) return {204, ""};
    return refusal(status.error().cause == Cause::input ? 400 : 409, status.error().message);
}

/// 100 m, as in printer files: such positions and their differences in micrometres fit an int.
constexpr double farthest_mm = 1e5;

struct Request {
    Control& control;
    json body;

    [[nodiscard]] std::string text(const char* key) const {
        const auto found = body.find(key);
        return found != body.end() && found->is_string() ? found->get<std::string>() : "";
    }
    [[nodiscard]] std::optional<double> number(const char* key) const {
        const auto found = body.find(key);
        if (found == body.end() || !found->is_number()) return std::nullopt;
        const double value = found->get<double>();
        return std::isfinite(value) && std::abs(value) < 1e9 ? std::optional(value) : std::nullopt;
    }
    /// An integer in the range of an int.
    [[nodiscard]] std::optional<int> whole(const char* key) const {
        const auto value = number(key);
        return value && *value == std::trunc(*value) ? std::optional(static_cast<int>(*value)) : std::nullopt;
    }
    [[nodiscard]] bool flag(const char* key) const {
        const auto found = body.find(key);
        return found != body.end() && found->is_boolean() && found->get<bool>();
    }
};

ApiAnswer needs(std::string_view what) {
    return refusal(400, fmt::format("the body must have {}", what));
}

/// A key that a body may have, and what stands there.
struct Key {
    enum class Kind { text, number, flag, list };
    const char* name;
    Kind kind = Kind::text;
};

bool has_kind(const json& value, Key::Kind kind) {
    switch (kind) {
        case Key::Kind::text:
            return value.is_string();
        case Key::Kind::number:
            return value.is_number();
        case Key::Kind::flag:
            return value.is_boolean();
        case Key::Kind::list:
            break;
    }
    return value.is_array();
}

/// What is wrong with the keys of the body: a value that would be ignored is a mistake of its sender.
std::optional<ApiAnswer> wrong_key(const Request& r, std::initializer_list<Key> keys) {
    constexpr std::array<std::string_view, 4> names = {"a text", "a number", "true or false", "a list"};
    for (auto given = r.body.begin(); given != r.body.end(); ++given) {
        const std::string& name = given.key();
        const auto known = std::ranges::find_if(keys, [&](const Key& key) { return name == key.name; });
        if (known == keys.end()) return refusal(400, fmt::format("\"{}\" has no meaning here", name));
        if (!has_kind(*given, known->kind))
            return refusal(400, fmt::format("\"{}\" must be {}", name, names[static_cast<std::size_t>(known->kind)]));
        if (known->kind == Key::Kind::number && !r.number(known->name))
            return refusal(400, fmt::format("\"{}\" is out of range", name));
    }
    return std::nullopt;
}

ApiAnswer get_job(const Request& r) {
    const Snapshot s = r.control.snapshot();
    return with({{"job", job_json(s)}, {"progress", progress_json(s)}, {"state", state_text(s)}});
}

ApiAnswer pause_job(const Request& r) {
    const bool paused = r.control.snapshot().state == State::paused;
    if (const auto wrong = wrong_key(r, {{"command"}, {"action"}, {"now", Key::Kind::flag}})) return *wrong;
    const std::string action = r.text("action").empty() ? "toggle" : r.text("action");
    if (action == "resume" || (action == "toggle" && paused)) return answer(r.control.resume());
    if (action != "pause" && action != "toggle") return needs(R"("action": "pause", "resume" or "toggle")");
    if (paused) return {204, ""};
    return answer(r.control.pause(r.flag("now") ? PauseWhen::now : PauseWhen::after_exposure));
}

ApiAnswer start_job(const Request& r) {
    const auto wrong = wrong_key(r, {{"command"},
                                     {"resume", Key::Kind::flag},
                                     {"assumeLit", Key::Kind::number},
                                     {"assumeVatsUntouched", Key::Kind::flag}});
    if (wrong) return *wrong;
    StartOptions options;
    options.resume = r.flag("resume");
    options.assume.lit_s = r.number("assumeLit");
    options.assume.vats_untouched = r.flag("assumeVatsUntouched");
    const Snapshot now = r.control.snapshot();
    if (now.job.empty()) return refusal(409, "no job is loaded");
    const bool waits = !is_printing(now.state);  // a print that runs has a refusal of its own
    if (waits && options.resume && !now.can_resume)
        return refusal(409, "there is no interrupted print of this job that can be resumed");
    if (waits && !options.resume && now.can_resume)
        return refusal(409, "the print of this job was interrupted: resume or cancel it first");
    return answer(r.control.start(options));
}

ApiAnswer post_job(const Request& r) {
    const std::string command = r.text("command");
    if (command == "start") return start_job(r);
    if (command == "pause") return pause_job(r);
    if (const auto wrong = wrong_key(r, {{"command"}})) return *wrong;
    if (command == "resume") return answer(r.control.resume());
    if (command == "cancel") return answer(r.control.cancel());
    if (command == "suspend") return answer(r.control.suspend());
    return needs(R"("command": "start", "pause", "resume", "cancel" or "suspend")");
}

ApiAnswer post_exposure(const Request& r) {
    if (const auto wrong = wrong_key(r, {{"material", Key::Kind::number}, {"seconds", Key::Kind::number}}))
        return *wrong;
    const auto material = r.whole("material");
    const auto seconds = r.number("seconds");
    if (!material || !seconds) return needs(R"("material" (from 0) and "seconds")");
    return answer(r.control.set_exposure(*material, *seconds));
}

ApiAnswer post_skip(const Request& r) {
    if (const auto wrong = wrong_key(r, {{"layer", Key::Kind::number}})) return *wrong;
    const auto layer = r.whole("layer");
    if (!layer) return needs(R"("layer" (from 0))");
    return answer(r.control.skip_layer(*layer));
}

ApiAnswer get_connection(const Request& r) {
    const Snapshot s = r.control.snapshot();
    return with({{"current", {{"state", state_text(s)}, {"firmware", s.firmware}, {"message", s.message}}}});
}

ApiAnswer post_connection(const Request& r) {
    if (const auto wrong = wrong_key(r, {{"command"}})) return *wrong;
    const std::string command = r.text("command");
    if (command == "connect") return answer(r.control.connect());
    if (command == "disconnect") return answer(r.control.disconnect());
    if (command == "reset") return answer(r.control.reset_controller());
    return needs(R"("command": "connect", "disconnect" or "reset")");
}

ApiAnswer get_printer(const Request& r) {
    const Snapshot s = r.control.snapshot();
    return with({{"state", state_json(s)}, {"machine", machine_json(s)}});
}

std::optional<Axis> axis_named(std::string_view name) {
    for (const Axis axis : machine::all_axes) {
        if (machine::axis_name(axis) == name) return axis;
    }
    return std::nullopt;
}

ApiAnswer jog(const Request& r) {
    const auto wrong = wrong_key(r, {{"command"},
                                     {"absolute", Key::Kind::flag},
                                     {"speed", Key::Kind::number},
                                     {"platform", Key::Kind::number},
                                     {"carriage", Key::Kind::number},
                                     {"tower", Key::Kind::number},
                                     {"table", Key::Kind::number}});
    if (wrong) return *wrong;
    std::vector<std::pair<Axis, double>> wanted;
    for (const Axis axis : machine::all_axes) {
        if (const auto mm = r.number(std::string(machine::axis_name(axis)).c_str())) wanted.emplace_back(axis, *mm);
    }
    if (wanted.size() != 1) return needs(R"(one of "platform", "carriage", "tower", "table" in mm)");
    const auto [axis, mm] = wanted.front();
    if (std::abs(mm) > farthest_mm) return refusal(400, fmt::format("{:g} mm: no machine is so large", mm));
    const double feed_mm_s = r.number("speed").value_or(0);
    const int um = static_cast<int>(std::lround(mm * 1000));
    return answer(r.flag("absolute") ? r.control.move_to(axis, um, feed_mm_s) : r.control.jog(axis, um, feed_mm_s));
}

ApiAnswer post_axes(const Request& r) {
    const std::string command = r.text("command");
    if (command == "jog") return jog(r);
    if (command != "home") return needs(R"("command": "jog" or "home")");
    if (const auto wrong = wrong_key(r, {{"command"}, {"axes", Key::Kind::list}})) return *wrong;
    std::vector<Axis> axes;
    const auto listed = r.body.find("axes");
    if (listed != r.body.end()) {
        for (const json& name : *listed) {
            const auto axis = name.is_string() ? axis_named(name.get<std::string>()) : std::nullopt;
            if (!axis) return needs(R"("axes" out of "platform", "carriage", "tower", "table")");
            axes.push_back(*axis);
        }
    }
    return answer(r.control.home(std::move(axes)));
}

ApiAnswer post_vat(const Request& r) {
    if (const auto wrong = wrong_key(r, {{"slot", Key::Kind::number}})) return *wrong;
    const auto slot = r.whole("slot");
    if (!slot) return needs(R"("slot" (0: put the vat away))");
    return answer(r.control.bring_vat(*slot));
}

ApiAnswer post_clean(const Request& r) {
    if (const auto wrong = wrong_key(r, {{"seconds", Key::Kind::number}})) return *wrong;
    const auto seconds = r.number("seconds");
    if (!seconds) return needs("\"seconds\"");
    return answer(r.control.clean(*seconds));
}

ApiAnswer post_prime(const Request& r) {
    if (const auto wrong = wrong_key(r, {{"seconds", Key::Kind::number}})) return *wrong;
    const auto seconds = r.number("seconds");
    if (!seconds) return needs("\"seconds\"");
    return answer(r.control.prime(*seconds));
}

ApiAnswer post_stop(const Request& r) {
    r.control.emergency_stop();
    return {204, ""};
}

struct Route {
    std::string_view method, path;
    ApiAnswer (*run)(const Request&);
};

constexpr std::array<Route, 13> routes = {{{"GET", "/api/job", get_job},
                                           {"POST", "/api/job", post_job},
                                           {"POST", "/api/job/exposure", post_exposure},
                                           {"POST", "/api/job/skip", post_skip},
                                           {"GET", "/api/connection", get_connection},
                                           {"POST", "/api/connection", post_connection},
                                           {"GET", "/api/printer", get_printer},
                                           {"POST", "/api/printer/axes", post_axes},
                                           {"POST", "/api/printer/vat", post_vat},
                                           {"POST", "/api/printer/clean", post_clean},
                                           {"POST", "/api/printer/prime", post_prime},
                                           {"POST", "/api/printer/stop", post_stop},
                                           {"GET", "/api/version", [](const Request&) {
                                                return with({{"api", "1"}, {"text", "Pliant"}});
                                            }}}};

}  // namespace

ApiAnswer handle_api(Control& control, std::string_view method, std::string_view path, std::string_view body) {
    json parsed = body.empty() ? json::object() : parse_json(body);
    bool path_known = false;
    for (const Route& route : routes) {
        if (route.path != path) continue;
        path_known = true;
        if (route.method != method) continue;
        if (!parsed.is_object()) return refusal(400, "the body is not a JSON object");
        return route.run({control, std::move(parsed)});
    }
    return path_known ? refusal(405, "this path does not take this method") : refusal(404, "there is no such path");
}

std::string history_message(const Control& control, long& last_event) {
    last_event = 0;
    return message(control, "history", last_event);
}

std::string current_message(const Control& control, long& last_event) {
    return message(control, "current", last_event);
}

}  // namespace pliant::host

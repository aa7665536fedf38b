#include "studio/server/studio.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <variant>

#include "base/core/files.hpp"
#include "printing/job/sha256.hpp"
#include "printing/machine/printer.hpp"
#include "robot/file/robot_file.hpp"
#include "studio/base/dumped.hpp"
#include "studio/base/limits.hpp"
#include "studio/built_in/examples.hpp"
#include "studio/requests/json_keys.hpp"

namespace pliant::studio {
namespace {

constexpr std::size_t most_undo = 200;
constexpr std::string_view first_example = "cable_gripper";
constexpr std::string_view host_path = "/api/print/host/";  // its interface has statuses of its own

/// Since 1970.
std::int64_t milliseconds_now() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

std::string document_event(const Studio::Document& d) {
    const nlohmann::json json = {
        {"type", "document"},    {"name", d.name},        {"unsaved", d.text != d.saved},
        {"undo", d.undo.size()}, {"redo", d.redo.size()}, {"accuracy", name(d.accuracy)},
        {"opened", d.opened},    {"digest", d.digest()},  {"title", d.name.empty() ? d.title : d.name}};
    return dumped(json);
}

/// "" if there is no second robot.
std::string comparison_event(const std::string& title) {
    const nlohmann::json json = {{"type", "comparison"}, {"title", title}};
    return dumped(json);
}

tl::unexpected<Error> not_a_robot(const std::string& name) {
    return input_error("\"{}\": a robot file ends with .toml", name);
}

/// Lines end with LF, as the page's editor ends them.
std::string with_short_ends(const std::string& text) {
    std::string out;
    out.reserve(text.size());
    for (std::size_t k = 0; k < text.size(); ++k)
        if (text[k] != '\r' || k + 1 == text.size() || text[k + 1] != '\n') out += text[k];
    return out;
}

std::string with_windows_ends(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '\n') out += '\r';
        out += c;
    }
    return out;
}

/// Most of its lines end with CR LF.
bool has_windows_ends(const std::string& text) {
    const auto all = std::ranges::count(text, '\n');
    return all < 2 * (std::ssize(text) - std::ssize(with_short_ends(text)));
}

/// Refuses a printer file, which is opened elsewhere.
Status check_kind(const std::string& text, const std::filesystem::path& file) {
    if (!machine::parse_printer(text, file)) return {};
    return input_error("{} is a printer file: choose it under Prepare, when the robot is sliced",
                       file.filename().string());
}

/// Of an input that a frame would answer.
std::optional<double> tag_of(const Message& message) {
    return std::visit(
        [](const auto& kind) -> std::optional<double> {
            if constexpr (requires { kind.tag; }) return kind.tag;
            return std::nullopt;
        },
        message);
}

}  // namespace

Result<std::unique_ptr<Studio>> Studio::open(const Start& start) {
    Result<ProjectFolder> folder = ProjectFolder::open(start.file.parent_path());
    if (!folder) return tl::unexpected(folder.error());
    std::unique_ptr<Studio> studio(new Studio(std::move(*folder), start));
    if (Status status = studio->start(start.file); !status) return tl::unexpected(status.error());
    return studio;
}

Studio::Studio(ProjectFolder folder, Start start)
    : folder_(std::move(folder)), start_(std::move(start)), routes_(all_routes()), numbers_from_(milliseconds_now()) {
    const auto send = [this](const std::string& json) { hub_.send_text(json); };
    simulation_ = std::make_unique<SimulationSession>(SessionEvents{
        send, [this](auto frame) { hub_.send_frame(frame); }, [this] { return hub_.fields(); }, false, numbers_from_});
    search_ = std::make_unique<SearchSession>(send);
    make_ = std::make_unique<MakeSession>(send, start_.version, numbers_from_);
    print_ = std::make_unique<PrintSession>(send, start_.notify);
    queue_ = std::make_unique<PrintQueue>(folder_, send);
    projector_ = std::make_unique<ProjectorSession>();
}

Studio::~Studio() {
    beside_.reset();  // its thread uses the hub
}

Status Studio::start(const std::filesystem::path& file) {
    if (lower_extension(file) == ".zip") {
        if (Status status = make_->open(file); !status) return status;
    }
    if (file.empty() || lower_extension(file) == ".zip") {
        open_example(std::string(first_example));
        return {};
    }
    const Result<std::string> text = read_file(file, largest_robot);
    if (!text) return tl::unexpected(text.error());
    if (Status status = check_kind(*text, file); !status) return status;
    const std::string name = file.filename().string();
    const std::string edited = with_short_ends(*text);
    document_ = {name, folder_.path() / name, edited, edited, {}, {}, Accuracy::automatic, {}};
    document_.windows_lines = has_windows_ends(*text);
    // Files named by the user's own file are allowed wherever they are.
    document_.outside = folder_.texts_leading_outside(*text, document_.file);
    rebuild(After::from_rest);
    return {};
}

std::string Studio::Document::digest() const {
    return job::sha256_hex(text + stamps);
}

std::shared_ptr<const std::string> Studio::first_picture(bool dark, const std::stop_token& stop) {
    const Document d = document();
    return thumbnails_.of(d.text, d.file, folder_, first_picture_style(dark), d.outside, stop);
}

Studio::Document Studio::document() {
    const std::lock_guard lock(mutex_);
    return document_;
}

void Studio::rebuild(After after) {
    if (after == After::from_rest) ++opened_;
    document_.opened = opened_;
    // A text that was checked when it came may lead outside since a file on which it is based has changed.
    if (const Status inside = check_text(document_.text); !inside) {
        hub_.send_text(dumped({{"type", "error"}, {"error", inside.error().message}}));
        hub_.send_text(document_event(document_));
        return;
    }
    document_.stamps = folder_.stamps_of(document_.text, document_.file);
    // Before the news of its building: a page must know which text these are of.
    hub_.send_text(document_event(document_));
    simulation_->open({document_.file, document_.text, document_.accuracy, document_.opened}, after);
}

/// A text received over the network must be short, and must not make the program read files outside the folder.
Status Studio::check_text(const std::string& text) const {
    if (text.size() > largest_robot) return input_error("a robot file of over 4 MB is refused");
    return folder_.check_texts(text, document_.file, document_.outside);
}

Status Studio::edit(const std::string& text) {
    const std::lock_guard lock(mutex_);
    return replace(with_short_ends(text));
}

Status Studio::edit_by(const std::function<Result<std::string>(const std::string&)>& change) {
    const std::lock_guard lock(mutex_);
    const Result<std::string> text = change(document_.text);
    return text ? replace(*text) : tl::unexpected(text.error());
}

Status Studio::replace(const std::string& text) {
    if (Status status = check_text(text); !status) return status;
    if (text != document_.text) {
        document_.undo.push_back(document_.text);
        if (document_.undo.size() > most_undo) document_.undo.erase(document_.undo.begin());
        document_.redo.clear();
        document_.text = text;
    }
    rebuild(After::as_before);
    return {};
}

void Studio::look_at_files() {
    const std::lock_guard lock(mutex_);
    if (folder_.stamps_of(document_.text, document_.file) != document_.stamps) rebuild(After::as_before);
}

Status Studio::check(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (Status status = check_text(text); !status) return status;
    const Result<robot::Robot> robot = robot::parse_robot(text, document_.file);
    return robot ? Status{} : tl::unexpected(robot.error());
}

void Studio::take_back(std::vector<std::string>& from, std::vector<std::string>& to) {
    to.push_back(std::exchange(document_.text, from.back()));
    from.pop_back();
    rebuild(After::as_before);
}

Status Studio::undo() {
    const std::lock_guard lock(mutex_);
    if (document_.undo.empty()) return input_error("there is nothing to undo");
    take_back(document_.undo, document_.redo);
    return {};
}

Status Studio::redo() {
    const std::lock_guard lock(mutex_);
    if (document_.redo.empty()) return input_error("there is nothing to redo");
    take_back(document_.redo, document_.undo);
    return {};
}

Result<Studio::Saved> Studio::save(const std::string& name, bool overwrite) {
    const std::lock_guard lock(mutex_);
    const Result<std::filesystem::path> path = folder_.resolve(name.empty() ? document_.name : name);
    if (!path) return tl::unexpected(path.error());
    if (lower_extension(*path) != ".toml") return not_a_robot(name);
    std::error_code ignored;
    // An example or a new robot has a place in the folder, where another file may be.
    const bool is_its_own = !document_.name.empty() && *path == document_.file;
    const bool exists = std::filesystem::exists(*path, ignored);
    if (!is_its_own && exists) return input_error("\"{}\" exists; choose another name", name);
    if (is_its_own && exists && !overwrite) {
        const Result<std::string> there = read_file(*path, largest_robot);
        if (!there || with_short_ends(*there) != document_.saved) return Saved::changed_elsewhere;
    }
    // In another folder the same names are those of other files.
    std::vector<std::string> outside = document_.outside;
    const bool moves = path->parent_path() != document_.file.parent_path();
    if (moves)
        std::erase_if(outside, [](const std::string& text) { return std::filesystem::path(text).is_relative(); });
    if (Status inside = folder_.check_texts(document_.text, *path, outside); !inside)
        return tl::unexpected(inside.error());
    // A text with an error of its own may be saved anywhere.
    if (moves && robot::parse_robot(document_.text, document_.file)) {
        if (const auto there = robot::parse_robot(document_.text, *path); !there) return tl::unexpected(there.error());
    }
    const std::string bytes = document_.windows_lines ? with_windows_ends(document_.text) : document_.text;
    if (Status status = write_file(*path, bytes); !status) return tl::unexpected(status.error());
    document_.name = path->lexically_relative(folder_.path()).generic_string();
    document_.file = *path;
    document_.saved = document_.text;
    document_.outside = std::move(outside);
    hub_.send_text(document_event(document_));
    return Saved::done;
}

Status Studio::open_file(const std::string& name) {
    const Result<std::filesystem::path> path = folder_.resolve(name);
    if (!path) return tl::unexpected(path.error());
    if (lower_extension(*path) == ".zip") return make_->open(*path);
    if (lower_extension(*path) != ".toml")
        return input_error("\"{}\": a robot file (.toml) or a job (.zip) is needed", name);
    const Result<std::string> text = read_file(*path, largest_robot);
    if (!text) return tl::unexpected(text.error());
    if (Status status = check_kind(*text, *path); !status) return status;
    const std::lock_guard lock(mutex_);
    const std::string edited = with_short_ends(*text);
    Document opened{name, *path, edited, edited, {}, {}, document_.accuracy, {}};
    opened.windows_lines = has_windows_ends(*text);
    std::swap(document_, opened);
    if (Status status = check_text(edited); !status) {
        std::swap(document_, opened);
        return status;
    }
    rebuild(After::from_rest);
    return {};
}

void Studio::open_example(const std::string& name) {
    const EmbeddedFile* example = find_file(example_robots(), name);
    if (example == nullptr) return;
    const std::lock_guard lock(mutex_);
    const std::string text(example->text);
    document_ = {"", folder_.path() / (name + ".toml"), text, text, {}, {}, document_.accuracy, {}, "example"};
    rebuild(After::from_rest);
}

Status Studio::open_new(const std::string& text, const std::string& name) {
    const Result<std::filesystem::path> place = folder_.resolve(name.empty() ? "robot.toml" : name);
    if (!place) return tl::unexpected(place.error());
    if (lower_extension(*place) != ".toml") return not_a_robot(name);
    const std::lock_guard lock(mutex_);
    Document fresh{"", *place, with_short_ends(text), "", {}, {}, document_.accuracy, {}};
    fresh.windows_lines = has_windows_ends(text);
    if (!name.empty()) fresh.title = name;
    std::swap(document_, fresh);
    if (Status status = check_text(text); !status) {
        std::swap(document_, fresh);
        return status;
    }
    rebuild(After::from_rest);
    return {};
}

void Studio::set_accuracy(Accuracy accuracy) {
    const std::lock_guard lock(mutex_);
    if (document_.accuracy == accuracy) return;
    document_.accuracy = accuracy;
    rebuild(After::as_before);
    if (!beside_) return;
    text_beside_.accuracy = accuracy;
    if (!folder_.check_texts(text_beside_.text, text_beside_.file, outside_beside_)) return;
    beside_->open(text_beside_, After::as_before);
}

SessionEvents Studio::events_beside() {
    const auto text = [this](const std::string& json) {
        hub_.send_text(fmt::format(R"({{"type":"beside","event":{}}})", json));
    };
    return {text, [this](auto frame) { hub_.send_frame_beside(frame); }, [this] { return hub_.fields(); }, true,
            numbers_from_};
}

Status Studio::compare(const std::string& name, const std::string& example) {
    RobotText source;
    std::string title = name.empty() ? example : name;
    std::vector<std::string> outside;
    if (!example.empty()) {
        const EmbeddedFile* found = find_file(example_robots(), example);
        if (found == nullptr) return input_error("\"{}\": there is no such example", example);
        source = {folder_.path() / (example + ".toml"), std::string(found->text)};
    } else if (!name.empty()) {
        const Result<std::filesystem::path> path = folder_.resolve(name);
        if (!path) return tl::unexpected(path.error());
        if (lower_extension(*path) != ".toml") return input_error("\"{}\": a robot file (.toml) is needed", name);
        Result<std::string> text = read_file(*path, largest_robot);
        if (!text) return tl::unexpected(text.error());
        if (Status status = check_kind(*text, *path); !status) return status;
        if (Status status = folder_.check_texts(*text, *path); !status) return status;
        source = {*path, std::move(*text)};
    }
    auto session = std::make_shared<SimulationSession>(events_beside());
    std::shared_ptr<SimulationSession> before;
    {
        const std::lock_guard lock(mutex_);
        if (title.empty()) {
            source = {document_.file, document_.text};
            title = "as it was";
            outside = document_.outside;
        }
        source.accuracy = document_.accuracy;
        text_beside_ = source;
        outside_beside_ = std::move(outside);
        title_beside_ = title;
        before = std::exchange(beside_, session);
    }
    before.reset();  // its thread must end before the new one sends
    hub_.send_text(comparison_event(title));
    session->open(source);
    return {};
}

void Studio::stop_comparing() {
    std::shared_ptr<SimulationSession> before;
    {
        const std::lock_guard lock(mutex_);
        before = std::exchange(beside_, nullptr);
    }
    before.reset();
    hub_.send_text(comparison_event(""));
}

std::shared_ptr<SimulationSession> Studio::beside() {
    const std::lock_guard lock(mutex_);
    return beside_;
}

Response Studio::handle(const Request& request) {
    Request asked = request;
    bool known = false;
    for (const Route& route : routes_) {
        if (!matches(route, asked)) continue;
        known = true;
        if (route.method != request.method) continue;
        if (route.steers && !hub_.may_steer(request.page))
            return error_response(423, "another page has control; request control first");
        if (route.takes == "application/json" && !request.body.empty() && !is_object(request.body))
            return error_response(request.path.starts_with(host_path) ? 400 : 422, "a JSON object is needed");
        return route.answer(*this, asked);
    }
    return known ? error_response(405, "method not allowed") : error_response(404, "not found");
}

bool Studio::streams(const Request& request) const {
    Request asked = request;
    return std::ranges::any_of(routes_, [&](const Route& route) {
        return route.streams && route.method == request.method && matches(route, asked);
    });
}

void Studio::greet(const std::shared_ptr<Connection>& connection) {
    const auto send = [&](const std::string& json) {
        connection->send_text(std::make_shared<const std::string>(json));
    };
    {
        // Sent under the lock, so that a later change is also sent later.
        const std::lock_guard lock(mutex_);
        send(document_event(document_));
    }
    for (const std::string& news : simulation_->news()) send(news);
    if (const auto second = beside()) {
        {
            const std::lock_guard lock(mutex_);
            send(comparison_event(title_beside_));
        }
        for (const std::string& news : second->news()) send(fmt::format(R"({{"type":"beside","event":{}}})", news));
        if (const auto frame = second->last_frame()) connection->send_frame_beside(frame);
    } else {
        send(comparison_event(""));
    }
    for (const std::string& news : search_->news()) send(news);
    for (const std::string& news : make_->news()) send(news);
    for (const std::string& news : print_->news()) send(news);
    for (const std::string& news : queue_->news()) send(news);
    if (const auto frame = simulation_->last_frame()) connection->send_frame(frame);
}

/// Pulling one robot does not affect the other; actuators that it lacks are skipped.
void Studio::steer(const Message& message, SimulationSession& simulation, bool beside) {
    if (const auto* drive = std::get_if<DriveMessage>(&message)) simulation.drive(*drive);
    if (const auto* follow = std::get_if<Follow>(&message)) simulation.follow(*follow);
    if (const auto* play = std::get_if<Play>(&message)) simulation.play(play->on);
    if (std::holds_alternative<Rest>(message)) simulation.rest();
    if (beside) return;
    if (const auto* pull = std::get_if<PullMessage>(&message)) simulation.pull(*pull);
    if (const auto* lead = std::get_if<LeadMessage>(&message)) simulation.lead(*lead);
    if (std::holds_alternative<Release>(message)) simulation.release();
}

void Studio::receive(const std::shared_ptr<Connection>& connection, std::string_view text) {
    const auto refuse = [&](const std::string& why, std::optional<double> tag = {}) {
        nlohmann::json json = {{"type", "error"}, {"error", why}};
        if (tag) json["tag"] = *tag;
        connection->send_text(std::make_shared<const std::string>(dumped(json)));
    };
    const Result<Message> message = parse_message(text);
    if (!message) return refuse(message.error().message);
    if (const auto* hello = std::get_if<Hello>(&*message)) {
        hub_.hello(connection, hello->page);
        return greet(connection);
    }
    if (const auto* fields = std::get_if<FieldsMessage>(&*message)) {
        for (const std::string& name : fields->names)
            if (!view::is_field(name))
                return refuse(fmt::format(
                    "message: names: there is no field \"{}\"; there are J, von_mises, stretch and energy", name));
        std::set<std::string> names(fields->names.begin(), fields->names.end());
        hub_.want_fields(connection, std::move(names));
        if (const auto second = beside()) second->show_again();
        return simulation_->show_again();
    }
    if (const auto* steer = std::get_if<Steer>(&*message)) {
        if (steer->action == Steer::Action::ask) return hub_.ask(connection);
        return steer->action == Steer::Action::give ? hub_.give(connection) : hub_.let_go(connection);
    }
    if (std::holds_alternative<Ping>(*message)) {
        hub_.ping();
        return connection->send_text(std::make_shared<const std::string>(R"({"type":"pong"})"));
    }
    if (connection->page.empty() || !hub_.may_steer(connection->page))
        return refuse("another page has control", tag_of(*message));
    if (const Status possible = simulation_->check(*message); !possible)
        return refuse(possible.error().message, tag_of(*message));
    steer(*message, *simulation_, false);
    if (const auto second = beside()) steer(*message, *second, true);
}

}  // namespace pliant::studio

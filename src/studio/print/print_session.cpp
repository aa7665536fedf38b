#include "studio/print/print_session.hpp"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "printing/host/journal.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/programs.hpp"
#include "printing/rehearse/replay.hpp"
#include "printing/screen/projector.hpp"
#include "printing/wire/serial.hpp"
#include "studio/base/access.hpp"
#include "studio/base/dumped.hpp"
#include "studio/print/growing_part.hpp"
#include "studio/print/journal_names.hpp"
#include "studio/print/printer_files.hpp"
#include "studio/print/printer_json.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

constexpr std::chrono::milliseconds between_messages{200};
constexpr double slowest = 0.1, fastest = 10000;

/// `{"current": ...}` as an event for the pages.
std::string event_of(const std::string& message) {
    return R"({"type":"print",)" + message.substr(1);
}

bool is_under_way(host::State state) {
    using host::State;
    return state == State::printing || state == State::pausing || state == State::paused ||
           state == State::cancelling || state == State::working;
}

/// True if the journal's print is complete or cancelled for good.
bool is_over(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return false;
    const auto journal = host::Journal::open(path, false);
    const auto facts = journal ? host::facts_of(journal->records()) : tl::unexpected(journal.error());
    return facts && (facts->ended || facts->cancelled);
}

/// A request to the host's control.
struct Asked {
    std::string command, action;  ///< "" if it has none
    bool resume = false;
};

Asked read_asked(std::string_view body) {
    const Json json = parse_json(body);
    if (!json.is_object()) return {};
    const auto text = [&](const char* key) {
        return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
    };
    return {text("command"), text("action"), json.contains("resume") && json["resume"] == true};
}

}  // namespace

/// A virtual exposure ends with the program that it was in; the part of it that was not journaled did not take place
/// when the twin was restored.
class RecalledGuard final : public host::Guard {
public:
    Status announced(long light) override {
        last_ = light;
        return {};
    }
    void lit(double) override {}
    void dark(double) override {}
    [[nodiscard]] std::optional<double> lit_s(long light) override {
        return light == last_ ? std::nullopt : std::optional(0.0);
    }
    void forget() override { last_ = 0; }

private:
    long last_ = 0;  ///< in this session
};

/// Either a twin or a machine at a port.
struct PrintSession::Machine {
    Machine(Order order_, operate::ReadyJob ready_, twin::Options options, double speed)
        : order(std::move(order_)),
          ready(std::move(ready_)),
          twin(std::make_unique<PacedTwin>(ready.printer, std::move(options), speed)),
          part(order.job, ready),
          control(setup()) {}
    Machine(Order order_, operate::ReadyJob ready_, std::unique_ptr<operate::PortStation> port_, std::string device_)
        : order(std::move(order_)),
          ready(std::move(ready_)),
          port(std::move(port_)),
          device(std::move(device_)),
          part(order.job, ready),
          control(setup()) {}

    host::ControlSetup setup() {
        if (port) {
            host::ControlSetup made = port->setup(ready.printer);
            made.after_light = [this](const host::Given& given) { part.exposed(given); };
            return made;
        }
        return {ready.printer,
                [this]() -> Result<std::unique_ptr<host::Wire>> { return twin->wire(); },
                twin->projector(),
                twin->clock(),
                operate::programs_of(ready.printer),
                operate::link_options(ready.printer.controller),
                nullptr,
                {},
                &guard,
                {},
                "virtual"};
    }
    /// True if there is neither a running nor an interrupted print.
    [[nodiscard]] bool is_free() const {
        const host::Snapshot now = control.snapshot();
        return !is_under_way(now.state) && !now.can_resume;
    }

    Order order;
    operate::ReadyJob ready;
    std::unique_ptr<PacedTwin> twin;
    std::unique_ptr<operate::PortStation> port;
    std::string device;
    RecalledGuard guard;
    bool keeps_journal = false;  ///< beside the job, as part of the print history
    GrowingPart part;
    host::Control control;
    std::atomic<bool> ending = false;
    std::mutex block_mutex;
    std::shared_ptr<const report::CuredBlock> block;  ///< of the last complete print; null: not requested yet
    std::thread worker, watcher;
};

PrintSession::PrintSession(std::function<void(const std::string&)> tell, std::string notify)
    : tell_(std::move(tell)),
      notify_(std::move(notify)),
      scratch_(std::filesystem::temp_directory_path() / ("pliant_studio_" + random_key())) {}

PrintSession::~PrintSession() {
    end(machine());
    std::error_code ignored;
    std::filesystem::remove_all(scratch_, ignored);
}

std::shared_ptr<PrintSession::Machine> PrintSession::machine() const {
    const std::lock_guard lock(mutex_);
    return machine_;
}

PrintSession::Files PrintSession::files() const {
    const auto machine = this->machine();
    if (!machine) return {};
    return {machine->order.job, machine->ready.job.journal};
}

report::PrintExtras PrintSession::extras() const {
    const auto machine = this->machine();
    if (!machine) return {};
    const host::Snapshot now = machine->control.snapshot();
    report::PrintExtras extras{machine->twin ? "virtual printer" : machine->device, now.firmware, now.lines_sent,
                               now.resends, nullptr};
    // A block that still grows is not compared.
    if (machine->twin && machine->is_free()) extras.block = block_of(*machine->twin, machine->order.job);
    return extras;
}

std::string PrintSession::verdict() const {
    const auto machine = this->machine();
    const auto block = machine ? finished_block(*machine) : nullptr;
    if (!block) return "null";
    return dumped(
        {{"passed", block->report.passed}, {"reasons", parse_json(twin::report_json(block->report))["reasons"]}});
}

/// Null: the print is not complete, or on a real machine.
std::shared_ptr<const report::CuredBlock> PrintSession::finished_block(Machine& machine) {
    if (!machine.twin || !machine.is_free() || !machine.control.snapshot().finished) return nullptr;
    const std::lock_guard lock(machine.block_mutex);
    if (!machine.block) machine.block = block_of(*machine.twin, machine.order.job);
    return machine.block;
}

Result<std::string> PrintSession::verdict_picture() const {
    const auto machine = this->machine();
    const auto block = machine ? finished_block(*machine) : nullptr;
    if (!block) return input_error("no virtual print is complete");
    return report::block_picture(*block, machine->ready.archive->manifest(), machine->ready.printer.projector);
}

Status PrintSession::take_twin(const Order& order, double speed) {
    if (!(speed >= slowest && speed <= fastest)) return input_error("speed: {} to {} is needed", slowest, fastest);
    const std::lock_guard one_at_a_time(orders_);
    if (Status unchanged = order.unchanged(); !unchanged) return unchanged;  // with the machine still connected
    if (Status status = leave(); !status) return status;
    Result<operate::ReadyJob> ready = operate::load_job(order.job);
    if (!ready) return tl::unexpected(ready.error());
    if (Status unchanged = order.unchanged(); !unchanged) return unchanged;
    Result<std::optional<job::Image>> mask = operate::mask_of(*ready->archive, ready->printer.projector);
    if (!mask) return tl::unexpected(mask.error());
    twin::Options options;
    options.mask = std::move(*mask);
    std::error_code error;
    std::filesystem::create_directories(scratch_, error);
    std::filesystem::permissions(scratch_, std::filesystem::perms::owner_all, error);
    ready->job.journal =
        order.journal.empty() ? scratch_ / fmt::format("twin_{}.journal", taken_.load()) : order.journal;
    ready->job.sync_journal = false;  // a virtual machine needs no protection against power cuts
    ++taken_;
    const auto made = std::make_shared<Machine>(order, std::move(*ready), std::move(options), speed);
    made->keeps_journal = !order.journal.empty();
    if (Status recalled = recall(*made); !recalled) return recalled;
    return take(made);
}

/// Restores the twin to the state at which a print was interrupted.
Status PrintSession::recall(Machine& machine) {
    const std::filesystem::path& path = machine.ready.job.journal;
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return {};
    auto journal = host::Journal::open(path, false);
    if (!journal) return tl::unexpected(journal.error());
    const std::vector<host::JournalRecord> records = journal->records();
    const auto facts = host::facts_of(records);
    if (!facts) return tl::unexpected(facts.error());
    if (!host::is_interrupted(*facts)) return {};
    if (facts->digest != machine.ready.job.digest) {
        std::filesystem::rename(path, path.string() + ".old", error);
        return error ? Status(failure("{}: cannot be put aside: {}", path.string(), error.message())) : Status{};
    }
    make_ready(machine);
    const Status done =
        machine.twin->with([&](twin::Twin& twin) { return rehearse::replay(records, machine.ready.job, twin); });
    machine.twin->pace().begin_at(machine.twin->with([](twin::Twin& twin) { return twin.now(); }));
    return done;
}

Status PrintSession::take_port(const Order& order, const operate::PortOptions& port) {
    if (Status status = check_device(port.device); !status) return status;
    const std::lock_guard one_at_a_time(orders_);
    if (Status unchanged = order.unchanged(); !unchanged) return unchanged;  // with the machine still connected
    if (Status status = leave(); !status) return status;
    Result<operate::ReadyJob> ready = operate::load_job(order.job);
    if (!ready) return tl::unexpected(ready.error());
    if (Status unchanged = order.unchanged(); !unchanged) return unchanged;
    auto station = operate::PortStation::open(port, *ready);
    if (!station) return tl::unexpected(station.error());
    ++taken_;
    const auto made = std::make_shared<Machine>(order, std::move(*ready), std::move(*station), port.device);
    made->keeps_journal = true;
    return take(made);
}

Status PrintSession::take(const std::shared_ptr<Machine>& made) {
    if (Status loaded = made->control.load(made->ready.job); !loaded) return loaded;
    made->control.serve_until_idle();
    // Nothing is sent to a machine with an interrupted print: resuming must be the first contact.
    if (!made->control.snapshot().can_resume) {
        if (Status status = made->control.connect(); !status) return status;
    } else if (made->port) {
        made->part.recall(made->ready.job.journal);
    }
    made->worker = std::thread([made = made.get()] { made->control.serve(); });
    {
        const std::lock_guard lock(mutex_);
        machine_ = made;
    }
    watch(made);
    tell_(R"({"type":"machine"})");
    return {};
}

/// Sends changes a few times a second.
void PrintSession::watch(const std::shared_ptr<Machine>& machine) {
    machine->watcher = std::thread([this, m = machine.get()] {
        long last = 0;
        std::string before;
        host::Snapshot known = m->control.snapshot();
        while (!m->ending) {
            host::Snapshot now = m->control.snapshot();
            if (const auto news = news_between(known, now)) announce(*news, m->ready.job.name);
            known = std::move(now);
            std::string message = host::current_message(m->control, last);
            if (message != before) tell_(event_of(message));
            before = std::move(message);
            if (m->twin) m->part.look_at(*m->twin, m->is_free());
            if (const std::string grown = m->part.news(); !grown.empty()) tell_(grown);
            std::this_thread::sleep_for(between_messages);
        }
    });
}

void PrintSession::announce(const PrintNews& news, const std::string& job) const {
    tell_(dumped({{"type", "news"}, {"event", news.event}, {"text", news.text}, {"job", job}}));
    if (notify_.empty()) return;
    if (const Status told = tell_by_command(notify_, news, job); !told)
        tell_(dumped({{"type", "error"}, {"error", "--notify: " + told.error().message}}));
}

void PrintSession::end(const std::shared_ptr<Machine>& machine) {
    if (!machine) return;
    machine->ending = true;
    if (machine->watcher.joinable()) machine->watcher.join();
    if (machine->twin) machine->twin->pace().let_go();
    machine->control.quit();
    if (machine->worker.joinable()) machine->worker.join();
}

Status PrintSession::give_back() {
    const std::lock_guard one_at_a_time(orders_);
    return leave();
}

Status PrintSession::leave() {
    std::shared_ptr<Machine> machine = this->machine();
    if (!machine) return {};
    if (is_under_way(machine->control.snapshot().state))
        return failure("a print is under way: cancel it before you disconnect");
    {
        const std::lock_guard lock(mutex_);
        machine_.reset();
    }
    end(machine);
    machine.reset();  // its device must be free before the pages are told
    tell_(R"({"type":"machine"})");
    return {};
}

Status PrintSession::discard() {
    const auto machine = this->machine();
    if (!machine || !machine->twin) return failure("there is no virtual printer");
    const host::Snapshot now = machine->control.snapshot();
    if (is_under_way(now.state) || !now.can_resume) return failure("there is no interrupted print");
    const std::filesystem::path journal = machine->ready.job.journal;
    std::error_code error;
    if (!std::filesystem::remove(journal, error) || error)
        return failure("{}: cannot be removed: {}", journal.string(), error.message());
    // The interrupted print may have left a vat on the carriage: the next one begins on another virtual printer.
    const Order order = machine->order;  // the machine ends before the next one begins
    return take_twin(order, machine->twin->pace().speed());
}

Status PrintSession::set_speed(double speed) {
    const auto machine = this->machine();
    if (!machine || !machine->twin) return failure("there is no virtual printer");
    if (!(speed >= slowest && speed <= fastest)) return input_error("speed: {} to {} is needed", slowest, fastest);
    machine->twin->pace().set_speed(speed);
    return {};
}

Status PrintSession::set_door(bool open) {
    const auto machine = this->machine();
    if (!machine || !machine->twin) return failure("there is no virtual printer");
    if (!machine->ready.printer.door.present()) return failure("{} has no door", machine->ready.printer.name);
    machine->twin->with([&](twin::Twin& twin) { twin.set_door(open); });
    return {};
}

/// A new print finds a clean platform and, in the virtual printer, full vats: the page has asked for this before.
void PrintSession::prepare_start(Machine& machine) {
    if (machine.twin) make_ready(machine);
    machine.part.clear();
    const std::lock_guard lock(machine.block_mutex);
    machine.block.reset();
}

void PrintSession::make_ready(Machine& machine) {
    machine.twin->with([&](twin::Twin& twin) {
        twin.take_part_off();
        for (const plan::VatUse& use : machine.ready.plan.vats) twin.fill_vat(use.slot);
        for (const plan::CareBefore& care : machine.ready.plan.solution.care) {
            if (care.layer == 0) twin.care(care.care);
        }
    });
}

/// Confirming that a vat is filled fills the virtual one.
void PrintSession::pour(Machine& machine) {
    const std::string prompt = machine.control.snapshot().prompt;
    if (!machine.twin || prompt.empty()) return;
    for (const host::Refill& refill : machine.ready.job.refills) {
        if (refill.text != prompt) continue;
        machine.twin->with([&](twin::Twin& twin) {
            if (refill.slot == 0)
                twin.care(refill.care);
            else
                twin.fill_vat(refill.slot);
        });
    }
}

host::ApiAnswer PrintSession::ask(std::string_view method, std::string_view path, std::string_view body) {
    const auto machine = this->machine();
    if (!machine) return {404, R"({"error":"no machine is connected"})"};
    if (method == "POST" && path == "/api/job") {
        // If two pages start at once, the second must not clear what the first has begun.
        const std::lock_guard one_at_a_time(orders_);
        const auto [command, action, resume] = read_asked(body);
        const host::Snapshot now = machine->control.snapshot();
        if (command == "start" && now.door_open.value_or(false))
            return {409, R"({"error":"the door is open: close it, then start"})"};
        if (command == "start" && !resume && machine->is_free() && now.state != host::State::connecting) {
            prepare_start(*machine);
            if (machine->keeps_journal && is_over(machine->ready.job.journal)) keep_journal(machine->ready.job.journal);
        }
        if (command == "resume" || (command == "pause" && action != "pause")) pour(*machine);
        return host::handle_api(machine->control, method, path, body);
    }
    return host::handle_api(machine->control, method, path, body);
}

std::string PrintSession::describe() const {
    const auto machine = this->machine();
    if (!machine) return R"({"machine":null})";
    Json vats = Json::array(), refills = Json::array();
    for (const plan::VatUse& use : machine->ready.plan.vats)
        vats.push_back({{"slot", use.slot},
                        {"resin", use.resin},
                        {"needed", plan::needed_text(use)},
                        {"materials", use.materials}});
    for (const host::Refill& refill : machine->ready.job.refills)
        refills.push_back({{"layer", refill.layer}, {"slot", refill.slot}, {"text", refill.text}});
    Json materials = Json::array();
    const auto& listed = machine->ready.archive->manifest().materials;
    for (std::size_t m = 0; m < listed.size(); ++m) {
        materials.push_back({{"name", listed[m].name},
                             {"resin", listed[m].resin},
                             {"exposure_s", listed[m].exposure_s},
                             {"colour", m < machine->order.colours.size() ? machine->order.colours[m] : ""}});
    }
    long last = 0;
    const Json history = parse_json(host::history_message(machine->control, last));
    return dumped({{"machine", printer_json(machine->ready.printer)},
                   {"twin", machine->twin != nullptr},
                   {"device", machine->device},
                   {"speed", machine->twin ? machine->twin->pace().speed() : 1},
                   {"key", machine->order.key},
                   {"file", machine->order.job.filename().string()},
                   {"materials", materials},
                   {"taken", taken_.load()},
                   {"job", machine->ready.job.name},
                   {"seconds", machine->ready.plan.seconds.total},
                   {"vats", vats},
                   {"refills", refills},
                   {"warnings", machine->ready.warnings},
                   {"now", history["history"]}});
}

Result<std::string> PrintSession::image(int layer, int material) const {
    const auto machine = this->machine();
    if (!machine) return input_error("no machine is connected");
    return machine->part.image(layer, material);
}

std::string PrintSession::part(int revision, std::size_t from) const {
    const auto machine = this->machine();
    return machine ? machine->part.packet(revision, from) : "";
}

/// "No machine" is news too: for a page that knew a machine before the studio was restarted.
std::vector<std::string> PrintSession::news() const {
    return {R"({"type":"machine"})"};
}

Status check_device(const std::string& device) {
    std::error_code error;
    const std::filesystem::path real = std::filesystem::canonical(device, error);
    if (error)
        return input_error(
            "device: there is no {}; is the machine plugged in and switched on? A port looks like /dev/ttyACM0",
            device);
    if (!real.string().starts_with("/dev/") || !std::filesystem::is_character_file(real, error))
        return input_error("device: {} is not a serial port; one such as /dev/ttyACM0 is needed", device);
    return {};
}

std::string ports_json() {
    Json ports = Json::array(), displays = Json::array();
    for (const host::SerialPort& port : host::serial_ports())
        ports.push_back({{"device", port.device}, {"name", port.name}});
    const Result<std::vector<host::PanelInfo>> panels = host::list_displays();
    if (panels) {
        for (const host::PanelInfo& p : *panels)
            displays.push_back(
                {{"number", p.number}, {"name", p.name}, {"width", p.width_px}, {"height", p.height_px}});
    }
    return dumped({{"ports", ports}, {"displays", displays}, {"without", panels ? "" : panels.error().message}});
}

}  // namespace pliant::studio

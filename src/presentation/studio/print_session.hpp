// A print that pages watch and steer: a job, a machine (virtual or at a port) and the host's control over both.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "presentation/print_report/print_report.hpp"
#include "presentation/studio/paced_twin.hpp"
#include "presentation/studio/print_news.hpp"
#include "printing/host/control.hpp"
#include "printing/host/control_api.hpp"
#include "printing/operate/port_station.hpp"
#include "printing/operate/print_job.hpp"

namespace pliant::studio {

class PrintSession {
public:
    /// `tell` sends a JSON event to all pages.
    /// `notify`: a command that hears of what news_between() finds; "": none.
    explicit PrintSession(std::function<void(const std::string& json)> tell, std::string notify = "");
    ~PrintSession();  ///< a print under way is suspended
    PrintSession(const PrintSession&) = delete;
    PrintSession& operator=(const PrintSession&) = delete;

    /// A job, and what its materials are drawn in.
    struct Order {
        std::filesystem::path job;
        std::vector<std::string> colours;
        std::filesystem::path journal{};  ///< of a virtual print; "": one that goes with the session
    };
    /// Takes the machine that the job was made for, as a twin. Refused while a print is under way. If the journal holds
    /// an interrupted print of this job, the twin is brought to where that one was left, and it can be gone on with; a
    /// journal of another job is put aside (".old"). Errors: the job cannot be printed.
    [[nodiscard]] Status take_twin(const Order& order, double speed);
    /// Takes the machine at a serial port. The journal stands beside the job, so that an interrupted print is gone on
    /// with. Whether the port answers shows in the state. Errors: the job cannot be printed, the device is none, no
    /// such projector.
    [[nodiscard]] Status take_port(const Order& order, const operate::PortOptions& port);
    /// Gives the machine back; a print under way is refused.
    [[nodiscard]] Status give_back();
    /// An interrupted print on the virtual printer is not gone on with: its journal goes, and the next print begins
    /// anew. (A real machine has to be parked: that is a command to its control.) Errors: none waits, none is virtual.
    [[nodiscard]] Status discard();
    /// Of the virtual printer.
    [[nodiscard]] Status set_speed(double speed);
    /// Opens or shuts the door of the virtual printer. Errors: there is none, or it has no door.
    [[nodiscard]] Status set_door(bool open);

    /// One request of docs/reference/host-api.md; 404 while there is no machine.
    [[nodiscard]] host::ApiAnswer ask(std::string_view method, std::string_view path, std::string_view body);
    /// The machine and the job for the page: JSON.
    [[nodiscard]] std::string describe() const;
    /// The part as far as it is printed, a packet (see GrowingPart): what has cured in the virtual printer, what has
    /// been exposed at a port. From slab `from` on if the page knows that `revision`, else from the first. "": there is
    /// no machine.
    [[nodiscard]] std::string part(int revision, std::size_t from) const;
    /// An image of the job that is printed, PNG: another one may be at hand meanwhile. Errors: there is none.
    [[nodiscard]] Result<std::string> image(int layer, int material) const;
    [[nodiscard]] std::vector<std::string> news() const;
    /// Job and journal of the machine at hand; both empty while there is none.
    struct Files {
        std::filesystem::path job, journal;
    };
    [[nodiscard]] Files files() const;
    /// What its journal does not hold.
    [[nodiscard]] report::PrintExtras extras() const;
    /// What has come of a print that is complete, JSON: {"passed", "reasons": [...]}, null where nobody can know (at a
    /// port, in mid-print). Cost: as report::cured_block(), once a print.
    [[nodiscard]] std::string verdict() const;
    /// The cured block beside the drawing, PNG. Errors: as verdict() is null; nothing to draw.
    [[nodiscard]] Result<std::string> verdict_picture() const;

private:
    struct Machine;
    [[nodiscard]] Status take(const std::shared_ptr<Machine>& machine);
    [[nodiscard]] Status leave();
    [[nodiscard]] static Status recall(Machine& machine);
    void watch(const std::shared_ptr<Machine>& machine);
    static void prepare_start(Machine& machine);
    static void make_ready(Machine& machine);
    static void pour(Machine& machine);
    [[nodiscard]] std::shared_ptr<Machine> machine() const;
    void end(const std::shared_ptr<Machine>& machine);
    void announce(const PrintNews& news, const std::string& job) const;
    [[nodiscard]] static std::shared_ptr<const report::CuredBlock> finished_block(Machine& machine);

    std::function<void(const std::string& json)> tell_;
    std::string notify_;
    std::filesystem::path scratch_;  ///< folder for the journals of virtual printers; gone with the session
    std::atomic<int> taken_ = 0;     ///< machines, so far
    std::mutex orders_;              ///< held while a machine is taken or left, or a print is begun: one at a time
    mutable std::mutex mutex_;
    std::shared_ptr<Machine> machine_;
};

/// A page may name no file but a terminal's: what is opened is written to. Errors: there is none, it is no terminal.
[[nodiscard]] Status check_device(const std::string& device);

/// How the machine's images lie on its platform, for pages that draw them: JSON.
[[nodiscard]] std::string projector_json(const machine::Projector& projector);

/// The ports that have something behind them and the displays that a projector may be: JSON.
[[nodiscard]] std::string ports_json();

}  // namespace pliant::studio

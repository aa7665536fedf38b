// A print that pages view and control: a job, a machine (virtual or at a port) and the host's control of both.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "presentation/print_report/print_report.hpp"
#include "printing/host/control.hpp"
#include "printing/host/control_api.hpp"
#include "printing/operate/port_station.hpp"
#include "printing/operate/print_job.hpp"
#include "studio/base/file_stamp.hpp"
#include "studio/print/paced_twin.hpp"
#include "studio/print/print_news.hpp"

namespace pliant::studio {

class PrintSession {
public:
    /// `tell` sends a JSON event to all pages. `notify`: the command for notifications of news_between(); "": none.
    explicit PrintSession(std::function<void(const std::string& json)> tell, std::string notify = "");
    ~PrintSession();  ///< a print under way is suspended
    PrintSession(const PrintSession&) = delete;
    PrintSession& operator=(const PrintSession&) = delete;

    /// A job, and the display colours of its materials.
    struct Order {
        std::filesystem::path job;
        std::vector<std::string> colours;
        std::filesystem::path journal{};        ///< of a virtual print; "": a temporary one, deleted with the session
        std::string key{};                      ///< of the job, see OpenJob::key
        std::shared_ptr<const void> scratch{};  ///< keeps the job's file, if that is a temporary one
        std::optional<FileStamp> stamp{};       ///< of that file as it is shown; nullopt: it may be any
        /// Error: the file has another stamp by now.
        [[nodiscard]] Status unchanged() const { return stamp ? check_unchanged(job, stamp) : Status{}; }
    };
    /// Connects to a twin of the machine that the job was made for. Refused during a print. If the journal holds an
    /// interrupted print of this job, the twin is restored to the state at the interruption, and the print can be
    /// resumed; a journal of another job is put aside (".old"). Errors: the job cannot be printed, or has changed.
    [[nodiscard]] Status take_twin(const Order& order, double speed);
    /// Connects to the machine at a serial port. The journal is beside the job, so that an interrupted print can be
    /// resumed. Whether the port answers is shown in the state. Errors: the job cannot be printed, the device does not
    /// exist, no such projector.
    [[nodiscard]] Status take_port(const Order& order, const operate::PortOptions& port);
    /// Disconnects the machine; refused during a print.
    [[nodiscard]] Status give_back();
    /// Discards an interrupted print on the virtual printer: its journal is deleted, and the next print starts anew. (A
    /// real machine must be parked, by a command to its control.) Errors: no interrupted print, or not a virtual
    /// printer.
    [[nodiscard]] Status discard();
    /// Speed factor of the virtual printer.
    [[nodiscard]] Status set_speed(double speed);
    /// Opens or closes the door of the virtual printer. Errors: no virtual printer, or it has no door.
    [[nodiscard]] Status set_door(bool open);

    /// One request of docs/reference/host-api.md; 404 if no machine is connected.
    [[nodiscard]] host::ApiAnswer ask(std::string_view method, std::string_view path, std::string_view body);
    /// The machine and the job for the page: JSON.
    [[nodiscard]] std::string describe() const;
    /// The part printed so far, a packet (see GrowingPart): what has cured in the virtual printer, or what has been
    /// exposed on a real machine. From slab `from` on if the page has that `revision`, else from the first. "": no
    /// machine is connected.
    [[nodiscard]] std::string part(int revision, std::size_t from) const;
    /// An image of the job being printed, PNG; it may differ from the current job of the page. Errors: there is none.
    [[nodiscard]] Result<std::string> image(int layer, int material) const;
    [[nodiscard]] std::vector<std::string> news() const;
    /// Job and journal of the connected machine; both empty if there is none.
    struct Files {
        std::filesystem::path job, journal;
    };
    [[nodiscard]] Files files() const;
    /// Facts for the report that the journal does not hold.
    [[nodiscard]] report::PrintExtras extras() const;
    /// The verdict on a completed print, JSON: {"passed", "reasons": [...]}; null if unknown (on a real machine, during
    /// a print). Cost: that of report::cured_block(), once per print.
    [[nodiscard]] std::string verdict() const;
    /// The cured block beside the drawing, PNG. Errors: the verdict is null; nothing to draw.
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
    std::filesystem::path scratch_;  ///< folder for the journals of virtual printers; deleted with the session
    std::atomic<int> taken_ = 0;     ///< number of machines connected so far
    std::mutex orders_;              ///< serialises connecting, disconnecting and starting a print
    mutable std::mutex mutex_;
    std::shared_ptr<Machine> machine_;
};

/// Only terminal devices are allowed, because the opened device is written to. Errors: it does not exist, or is not a
/// terminal.
[[nodiscard]] Status check_device(const std::string& device);

/// The ports with a device and the displays that may be projectors: JSON.
[[nodiscard]] std::string ports_json();

}  // namespace pliant::studio

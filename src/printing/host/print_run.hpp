// One print from some step to its end: commands, exposures, pauses, prompts, parking.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/desk.hpp"
#include "printing/host/journal.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/machine.hpp"
#include "printing/host/script.hpp"

namespace pliant::host {

/// All references must outlive the run.
struct RunSetup {
    const ControlSetup& setup;
    const PrintJob& job;
    const Script& script;
    const std::vector<double>& times;  ///< result of script_times()
    Machine& machine;
    Journal* journal;  ///< nullptr: no journal
    Desk& desk;
};

enum class Ending {
    finished,
    cancelled,
    suspended,
    left,  ///< suspended, but not parked: the door is open
};

/// print_run.cpp goes through its steps; print_run_light.cpp has the exposures, print_run_requests.cpp what is asked of
/// it meanwhile.
class PrintRun {
public:
    PrintRun(const RunSetup& run, JournalFacts facts);
    ~PrintRun();
    PrintRun(const PrintRun&) = delete;
    PrintRun& operator=(const PrintRun&) = delete;

    /// Prints from the beginning.
    [[nodiscard]] Result<Ending> print();
    /// Continues from where the machine is.
    [[nodiscard]] Result<Ending> resume(const Recovery& recovery);
    /// Ends an interrupted print for good.
    [[nodiscard]] Result<Ending> abandon(const Recovery& recovery);
    /// After an error: light off, and whatever else can be made safe.
    void make_safe(const Error& error);

private:
    [[nodiscard]] Status on_the_way();
    [[nodiscard]] Result<Ending> steps_from(std::size_t step);
    [[nodiscard]] Status expose(std::size_t step);
    /// `entry`: the image's name in the job.
    [[nodiscard]] Status shine(std::size_t step, const job::Image& image, const std::string& entry, LightFact& fact);
    [[nodiscard]] Status announce(std::size_t step, LightFact& fact);
    void show_light(const LightFact& fact, const std::string& entry, double left_s);
    struct Darkness {
        double on_s = 0;  ///< how long the light was on
        Status status;    ///< of the projector
    };
    [[nodiscard]] Darkness go_dark(bool whole, double start_s);
    [[nodiscard]] Status note_dark(LightFact& fact, double on_s);
    [[nodiscard]] Status burn(double until_s, double before_s, bool& whole);
    [[nodiscard]] Status serve_wishes(std::size_t step);
    [[nodiscard]] Status between_layers(std::size_t step);
    [[nodiscard]] Status call_hook();
    [[nodiscard]] Status keep_changes();
    [[nodiscard]] Status pause(const std::string& prompt);
    [[nodiscard]] Status hold_for_door();
    [[nodiscard]] Status halt(const std::string& prompt, const Programs::Make& begin, const Programs::Make& end);
    [[nodiscard]] Status wait_for_resume();
    [[nodiscard]] Status listen_at_door(double seconds);
    [[nodiscard]] Result<Ending> wait_to_park(Ending ending);
    [[nodiscard]] bool door_is_open() const { return run_.machine.door_open().value_or(false); }
    void show_switches();
    [[nodiscard]] Result<Ending> park_as_wished();
    [[nodiscard]] Result<Ending> park(Ending ending);
    [[nodiscard]] Status note(std::string_view kind, const JournalValues& values);
    [[nodiscard]] double exposure_s(const machine::Expose& light) const;
    [[nodiscard]] bool skipped(int layer) const;
    [[nodiscard]] bool at_safe_point() const;
    [[nodiscard]] int next_layer(std::size_t step) const;
    [[nodiscard]] bool wants_to_end() const;
    /// Ends a run early without an error of its own.
    [[nodiscard]] static tl::unexpected<Error> wish_to_end() { return cancelled(); }
    void show_progress();
    void reach(std::size_t step);
    void recall_layer(std::size_t next);
    void recall_refill(int layer);

    RunSetup run_;
    JournalFacts facts_;
    const machine::Printer& printer_;
    Projector& projector_;
    Clock& clock_;
    double begin_s_;
    // Planned seconds of the job: reached for certain (and when), sent, shown.
    double reached_s_ = 0, reached_at_s_ = 0, sent_s_ = 0, done_s_ = 0;
    bool waits_ = false;      ///< waiting for resume(), which does not count as time of the job
    int layer_ = -1;          ///< of the last exposure, also before this print was resumed
    int told_layer_ = -1;     ///< of the last event "layer"
    int hooked_layer_ = -1;   ///< last layer for which after_layer was called
    bool owes_hook_ = false;  ///< that of the last layer before this print was resumed
    bool told_of_end_ = false, told_of_pause_ = false;  ///< when it will be, while the print resumes
    int refilled_layer_ = -1;                           ///< last layer before which a refill was requested
    bool has_refilled_ = false;                         ///< since that request, while the print was interrupted
    long last_record_ = 0;
    bool without_guard_ = false;  ///< it has ended, and that was said
    bool journal_failed_ = false;
};

}  // namespace pliant::host

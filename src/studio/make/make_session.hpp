// The current job: opened from a file, or sliced from the robot in the editor, on a thread of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/core/progress.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/prepare/slice_job.hpp"
#include "studio/base/access.hpp"
#include "studio/base/file_stamp.hpp"
#include "studio/make/job_under_way.hpp"

namespace pliant::studio {

struct SliceOrder {
    std::string robot_text;
    std::filesystem::path robot_file;
    prepare::PrinterFile printer;
    prepare::Order order;  ///< its inputs are the robot's
    std::string source{};  ///< see JobOrigin::source
};

/// A file that is deleted with the last object that uses it.
class ScratchFile {
public:
    explicit ScratchFile(std::filesystem::path path) : path_(std::move(path)) {}
    ~ScratchFile();
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

private:
    std::filesystem::path path_;
};

/// Where a job comes from: what its file does not tell.
struct JobOrigin {
    std::string source{};  ///< robot text and options, as JSON for the page; "": it was not sliced from the editor
    std::vector<std::string> colours{};            ///< (materials); empty: those of the file
    std::shared_ptr<const ScratchFile> scratch{};  ///< null: its file stays
};

/// A job and the machine that it was made for.
struct OpenJob {
    OpenJob(job::Archive archive_, machine::Printer printer_, std::filesystem::path file_, std::int64_t revision_)
        : archive(std::move(archive_)), printer(std::move(printer_)), file(std::move(file_)), revision(revision_) {}
    job::Archive archive;
    machine::Printer printer;
    std::filesystem::path file;
    std::int64_t revision;
    std::string key = random_key();    ///< in the addresses of its images, which browsers keep for ever
    std::optional<FileStamp> stamp{};  ///< of the file when it was opened
    JobOrigin origin{};                ///< with colours of all materials
    std::mutex mutex{};                ///< an archive must be used by one thread at a time
    std::string part{};                ///< see job_part(); "": not requested yet

    /// Error: the file is not the one that was opened. What is printed is read from it again, and must be what is
    /// shown.
    [[nodiscard]] Status unchanged() const { return check_unchanged(file, stamp); }
};

/// The error of every request that needs a job.
inline constexpr std::string_view no_job_text = "there is no job yet: slice the robot, or open a job file";

class MakeSession {
public:
    /// The first job has the revision after `numbers_from`.
    MakeSession(std::function<void(const std::string& json)> tell, std::string version, std::int64_t numbers_from = 0);
    ~MakeSession();
    MakeSession(const MakeSession&) = delete;
    MakeSession& operator=(const MakeSession&) = delete;

    [[nodiscard]] Status open(const std::filesystem::path& file);
    /// Saves the current job to a file, which it uses from then on; it keeps its key. Errors: there is none, its
    /// own file has changed, the file exists, it cannot be written.
    [[nodiscard]] Status save(const std::filesystem::path& file);
    /// Starts slicing; the pages are told of its progress and its end. Errors: it is slicing already.
    [[nodiscard]] Status slice(SliceOrder order);
    void cancel();
    [[nodiscard]] std::shared_ptr<OpenJob> job() const;
    /// The layers of the job that is being sliced.
    [[nodiscard]] const JobUnderWay& under_way() const { return under_way_; }
    /// A job to compare the current one with: the previous one, null if there was none, or `file`, whose revision is
    /// below 0; read again once it has changed. Errors: not a job.
    [[nodiscard]] Result<std::shared_ptr<OpenJob>> other(const std::filesystem::path& file = {});
    [[nodiscard]] std::vector<std::string> news() const;

private:
    class Watch;
    /// `saved`: the job that the file is a copy of; null: a new job.
    [[nodiscard]] Status adopt(const std::filesystem::path& file, JobOrigin origin, const std::string& key = {},
                               const std::shared_ptr<OpenJob>& saved = nullptr);
    void work(const SliceOrder& order);

    std::function<void(const std::string& json)> tell_;
    std::string version_;
    std::filesystem::path scratch_;  ///< folder for sliced jobs; deleted with the session
    mutable std::mutex mutex_;
    std::shared_ptr<OpenJob> job_, before_, other_;
    std::int64_t revision_;
    int others_ = 0;
    JobUnderWay under_way_;
    std::atomic<bool> slicing_ = false, cancelled_ = false;
    std::thread thread_;
};

}  // namespace pliant::studio

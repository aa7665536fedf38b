#include "studio/make/make_session.hpp"

#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "presentation/print_report/material_colours.hpp"
#include "printing/operate/job_file.hpp"
#include "studio/base/dumped.hpp"
#include "studio/make/slice_robot.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// Of its materials: the chosen ones, else those of the palette.
std::vector<std::string> colours_of(const job::Manifest& manifest) {
    std::vector<std::string> colours;
    for (const report::Colour& colour : report::material_colours(manifest)) colours.push_back(report::hex(colour));
    return colours;
}

}  // namespace

ScratchFile::~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
}

class MakeSession::Watch final : public Progress {
public:
    explicit Watch(MakeSession& session) : session_(session) {}
    void advance(std::string_view stage, double fraction) override {
        const auto now = std::chrono::steady_clock::now();
        if (now - last_ < std::chrono::milliseconds(100)) return;
        last_ = now;
        session_.tell_(dumped(
            {{"type", "slicing"}, {"stage", stage}, {"fraction", fraction}, {"layers", session_.under_way_.layers()}}));
    }
    [[nodiscard]] bool cancelled() const override { return session_.cancelled_; }

private:
    MakeSession& session_;
    std::chrono::steady_clock::time_point last_{};
};

MakeSession::MakeSession(std::function<void(const std::string&)> tell, std::string version, std::int64_t numbers_from)
    : tell_(std::move(tell)),
      version_(std::move(version)),
      scratch_(std::filesystem::temp_directory_path() / ("pliant_studio_" + random_key())),
      revision_(numbers_from) {}

MakeSession::~MakeSession() {
    cancel();
    if (thread_.joinable()) thread_.join();
    std::error_code ignored;
    std::filesystem::remove_all(scratch_, ignored);
}

Status MakeSession::open(const std::filesystem::path& file) {
    return adopt(file, {});
}

Status MakeSession::save(const std::filesystem::path& file) {
    const auto job = this->job();
    if (!job) return failure("{}", no_job_text);
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored))
        return input_error("{} exists; choose another name", file.filename().string());
    if (!std::filesystem::is_directory(file.parent_path(), ignored))
        return input_error("there is no folder {}", file.parent_path().filename().string());
    const Result<std::string> bytes = read_file(job->file);
    if (!bytes) return tl::unexpected(bytes.error());
    if (Status unchanged = job->unchanged(); !unchanged) return unchanged;
    if (Status written = write_file(file, *bytes); !written) return written;
    return adopt(file, {job->origin.source, job->origin.colours, nullptr}, job->key, job);
}

Status MakeSession::adopt(const std::filesystem::path& file, JobOrigin origin, const std::string& key,
                          const std::shared_ptr<OpenJob>& saved) {
    // Before the file is read: a change meanwhile is then noticed later.
    const std::optional<FileStamp> stamp = stamp_of(file);
    Result<operate::OpenJob> open = operate::open_job(file);
    if (!open) return tl::unexpected(open.error());
    if (origin.colours.empty()) origin.colours = colours_of(open->archive.manifest());
    std::string news;
    {
        const std::lock_guard lock(mutex_);
        if (saved && job_ != saved) return {};                     // another one has become the job since
        if (job_ && job_->file != file && !saved) before_ = job_;  // under another name it is the same job
        job_ = std::make_shared<OpenJob>(std::move(open->archive), std::move(open->printer), file, ++revision_);
        job_->stamp = stamp;
        job_->origin = std::move(origin);
        if (!key.empty()) job_->key = key;
        news = dumped({{"type", "job"}, {"revision", revision_}});
    }
    tell_(news);
    return {};
}

Status MakeSession::slice(SliceOrder order) {
    if (slicing_.exchange(true)) return failure("a job is being sliced already; cancel it first");
    if (thread_.joinable()) thread_.join();
    cancelled_ = false;
    order.order.version = version_;
    thread_ = std::thread([this, order = std::move(order)] { work(order); });
    return {};
}

void MakeSession::work(const SliceOrder& order) {
    Watch watch(*this);
    tell_(dumped({{"type", "slicing"}, {"stage", "read"}, {"fraction", 0}}));
    std::error_code error;
    std::filesystem::create_directories(scratch_, error);
    std::filesystem::permissions(scratch_, std::filesystem::perms::owner_all, error);
    const std::filesystem::path file = scratch_ / ("job_" + random_key() + ".zip");
    auto scratch = std::make_shared<const ScratchFile>(file);
    Result<std::vector<std::string>> colours = slice_robot(order, file, watch, under_way_);
    if (colours && cancelled_) colours = cancelled();  // since the slicer last looked
    Status status = colours ? adopt(file, {order.source, std::move(*colours), std::move(scratch)})
                            : Status(tl::unexpected(colours.error()));
    under_way_.clear();
    slicing_ = false;  // before the pages are told: they may start the next one at once
    const bool was_cancelled = !status && status.error().cause == Cause::cancelled;
    tell_(dumped({{"type", "slicing"},
                  {"stage", ""},
                  {"fraction", 1},
                  {"cancelled", was_cancelled},
                  {"error", status || was_cancelled ? "" : status.error().message}}));
}

Result<std::shared_ptr<OpenJob>> MakeSession::other(const std::filesystem::path& file) {
    const std::optional<FileStamp> stamp = stamp_of(file);
    {
        const std::lock_guard lock(mutex_);
        if (file.empty()) return before_;
        if (other_ && other_->file == file && other_->stamp == stamp) return other_;
    }
    Result<operate::OpenJob> open = operate::open_job(file);
    if (!open) return tl::unexpected(open.error());
    const std::lock_guard lock(mutex_);
    auto made = std::make_shared<OpenJob>(std::move(open->archive), std::move(open->printer), file, -(++others_));
    made->stamp = stamp;
    made->origin.colours = colours_of(made->archive.manifest());
    return other_ = made;
}

void MakeSession::cancel() {
    cancelled_ = true;
}

std::shared_ptr<OpenJob> MakeSession::job() const {
    const std::lock_guard lock(mutex_);
    return job_;
}

std::vector<std::string> MakeSession::news() const {
    const std::lock_guard lock(mutex_);
    // "No job" is news too: for a page that knew a job before the studio was restarted.
    return {dumped({{"type", "job"}, {"revision", job_ ? revision_ : 0}})};
}

}  // namespace pliant::studio

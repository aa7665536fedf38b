#include "loop/study/folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/core/file_lock.hpp"
#include "base/core/files.hpp"

namespace pliant::study {
namespace {

namespace fs = std::filesystem;

/// True if the folder holds only what a study killed before it had a plan may have left, or a plan that another process
/// has placed just now.
bool is_beginning(const fs::path& folder) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name != "records" && name != "lock" && name != "slurm" && name != "rows" && name != "plan.json" &&
            !name.starts_with("plan.json."))
            return false;
    }
    return !error;
}

/// A name beside plan.json that no other process has.
fs::path plan_aside(const fs::path& folder) {
    std::array<char, 256> host{};
    (void)::gethostname(host.data(), host.size() - 1);
    return folder / fmt::format("plan.json.{}.{}", host.data(), ::getpid());
}

/// Writes plan.json unless it exists: of several processes that begin at once, one wins.
Status place_plan(const Plan& plan, const fs::path& folder) {
    const fs::path aside = plan_aside(folder);
    if (Status status = write_file(aside, plan_json(plan)); !status) return status;
    const bool placed = ::link(aside.c_str(), (folder / "plan.json").c_str()) == 0 || errno == EEXIST;
    const int error = errno;
    std::error_code ignored;
    fs::remove(aside, ignored);
    if (!placed) return failure("{}: cannot be written: {}", (folder / "plan.json").string(), std::strerror(error));
    return {};
}

Status make_folder(const Plan& plan, const fs::path& folder) {
    std::error_code error;
    if (fs::exists(folder, error) && (!fs::is_directory(folder, error) || !is_beginning(folder)))
        return input_error("{}: contains files that are not a study; choose another folder with -o", folder.string());
    fs::create_directories(folder / "records", error);
    if (error) return failure("{}: cannot be made: {}", folder.string(), error.message());
    return place_plan(plan, folder);
}

Status check_same(const Plan& plan, const Plan& there, const fs::path& folder) {
    if (there.fingerprint == plan.fingerprint) return {};
    if (there.version != plan.version)
        return input_error(
            "{}: was begun with pliant {}, and this is {}; go on with that one, or choose another folder with -o",
            folder.string(), there.version, plan.version);
    return input_error(
        "{}: holds another study, or this one before its files were changed; choose another folder with -o",
        folder.string());
}

/// The plan in the folder, whose rows run where the study file is now: the project may have been copied or renamed
/// since, and the files of the command are those at its present place, from which the fingerprint was made. The folder
/// learns it too, for tasks that know nothing but the folder.
Result<Plan> at_present_place(const Plan& plan, Plan there, const fs::path& folder) {
    if (there.folder == plan.folder && there.study_file == plan.study_file) return there;
    const bool moved = there.folder != plan.folder;
    there.folder = plan.folder;
    there.study_file = plan.study_file;
    if (!moved) return there;
    const fs::path aside = plan_aside(folder);
    if (Status status = write_file(aside, plan_json(there)); !status) return tl::unexpected(status.error());
    std::error_code error;
    fs::rename(aside, folder / "plan.json", error);
    if (error) return failure("{}: cannot be written: {}", (folder / "plan.json").string(), error.message());
    return there;
}

/// Replaces a study that was planned here and has no rows: its file was corrected since.
Status plan_anew(const Plan& plan, const fs::path& folder) {
    const auto leader = lead(folder);
    if (!leader) return tl::unexpected(leader.error());
    std::error_code error;
    fs::remove_all(folder / "records", error);
    fs::remove(folder / "plan.json", error);
    return make_folder(plan, folder);
}

/// The number of rows with a record.
Result<std::size_t> recorded_rows(const Plan& plan, const fs::path& folder) {
    const Result<Collected> found = collect(plan, folder);
    if (!found) return tl::unexpected(found.error());
    return found->recorded();
}

}  // namespace

Result<Plan> load_plan(const fs::path& folder) {
    const fs::path file = folder / "plan.json";
    const Result<std::string> text = read_file(file);
    if (!text) return tl::unexpected(text.error());
    return parse_plan(*text, file.string());
}

Result<Plan> open_folder(const Plan& plan, const fs::path& folder, Begin begin) {
    std::error_code error;
    if (!fs::exists(folder / "plan.json", error)) {
        if (Status status = make_folder(plan, folder); !status) return tl::unexpected(status.error());
    }
    Result<Plan> there = load_plan(folder);
    if (!there) return there;
    const Status same = check_same(plan, *there, folder);
    if (same) there = at_present_place(plan, std::move(*there), folder);
    if (!there) return there;
    if (begin == Begin::resume) return same ? there : tl::unexpected(same.error());
    const Result<std::size_t> recorded = recorded_rows(*there, folder);
    if (!recorded) return tl::unexpected(recorded.error());
    if (!same && *recorded > 0) return tl::unexpected(same.error());
    if (!same) {
        if (Status status = plan_anew(plan, folder); !status) return tl::unexpected(status.error());
        return load_plan(folder);
    }
    if (*recorded > 0)
        return input_error("{}: holds {} of {} rows; --resume goes on with them, -o names another folder",
                           folder.string(), *recorded, there->rows.size());
    return there;
}

Result<FileHandle> lead(const fs::path& folder) {
    const std::string name = (folder / "lock").string();
    FileHandle file(::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
    if (!file.is_open()) return failure("{}: cannot be opened: {}", name, std::strerror(errno));
    const LockOutcome outcome = try_lock(file);
    if (outcome == LockOutcome::ours) return file;
    if (outcome == LockOutcome::taken)
        return input_error("{}: another process is at work on this study", folder.string());
    return failure("{}: cannot be locked: {}; a study needs a file system with locks (NFS 4, Lustre with -o flock)",
                   name, std::strerror(errno));
}

Result<Collected> collect(const Plan& plan, const fs::path& folder) {
    Collected all;
    all.rows.resize(plan.rows.size());
    for (std::size_t chunk = 0; chunk < plan.chunk_count(); ++chunk) {
        auto records = read_records(plan, folder, chunk);
        if (!records) return tl::unexpected(records.error());
        for (RowRecord& row : records->rows) {
            (row.done ? all.done : all.failed) += 1;
            all.warned += row.done && !row.warning.empty() ? 1 : 0;
            all.rows[row.row] = std::move(row);
        }
        all.tasks.insert(all.tasks.end(), records->tasks.begin(), records->tasks.end());
        all.damaged += records->damaged;
        all.doubled += records->doubled;
    }
    return all;
}

Follower::Follower(const Plan& plan, fs::path folder)
    : plan_(plan), folder_(std::move(folder)), chunks_(plan.chunk_count()) {}

Result<Follower::Count> Follower::look() {
    Count sum;
    for (std::size_t chunk = 0; chunk < chunks_.size(); ++chunk) {
        Seen& seen = chunks_[chunk];
        std::error_code error;
        const std::uintmax_t bytes = fs::file_size(records_file(folder_, chunk), error);
        if (!error && bytes != seen.bytes) {
            const auto records = read_records(plan_, folder_, chunk);
            if (!records) return tl::unexpected(records.error());
            seen = {bytes, {}};
            for (const RowRecord& row : records->rows) {
                ++seen.count.recorded;
                seen.count.done += row.done ? 1 : 0;
                seen.count.missing_path += row.missing_path ? 1 : 0;
                if (row.missing_path && seen.count.missing_reason.empty()) seen.count.missing_reason = row.reason;
            }
        }
        sum.recorded += seen.count.recorded;
        sum.done += seen.count.done;
        sum.missing_path += seen.count.missing_path;
        if (sum.missing_reason.empty()) sum.missing_reason = seen.count.missing_reason;
    }
    return sum;
}

std::vector<std::size_t> Follower::open_chunks() const {
    std::vector<std::size_t> open;
    for (std::size_t chunk = 0; chunk < chunks_.size(); ++chunk) {
        if (chunks_[chunk].count.recorded < plan_.chunk_end(chunk) - plan_.chunk_begin(chunk)) open.push_back(chunk);
    }
    return open;
}

}  // namespace pliant::study

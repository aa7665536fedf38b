// The queue of jobs to be printed, stored in a file of the project folder, so that it outlives the studio.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "studio/requests/project_folder.hpp"

namespace pliant::studio {

class PrintQueue {
public:
    /// `tell` sends a JSON event to all pages. An invalid file counts as an empty queue.
    PrintQueue(const ProjectFolder& folder, std::function<void(const std::string& json)> tell);

    /// Names of jobs, relative to the folder; a name may occur several times.
    [[nodiscard]] std::vector<std::string> jobs() const;
    /// Replaces the list. Errors: more than `most_jobs`, a name that is not a job of the folder, a write error.
    [[nodiscard]] Status set(std::vector<std::string> jobs);
    /// Removes the first entry of that name: its print has begun. No effect if there is none.
    void begun(const std::string& job);

    /// For pages: {"jobs": [{"name", "error" or "title", "printer", "layers", "seconds"}]}. Cost: each job is opened.
    [[nodiscard]] std::string json() const;
    [[nodiscard]] std::vector<std::string> news() const;

    static constexpr std::size_t most_jobs = 50;
    static constexpr const char* file_name = "print_queue.json";

private:
    /// In the file and here; call it with the lock.
    [[nodiscard]] Status replace(std::vector<std::string> jobs);
    [[nodiscard]] Status write(const std::vector<std::string>& jobs) const;
    void read();

    const ProjectFolder& folder_;
    std::function<void(const std::string& json)> tell_;
    mutable std::mutex mutex_;
    std::vector<std::string> jobs_;
};

}  // namespace pliant::studio

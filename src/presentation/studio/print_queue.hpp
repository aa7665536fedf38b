// Jobs that wait to be printed, in their order, in a file of the project folder: they outlive the studio.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "presentation/studio/project_folder.hpp"

namespace pliant::studio {

class PrintQueue {
public:
    /// `tell` sends a JSON event to all pages. A file that is none of ours counts as an empty queue.
    PrintQueue(const ProjectFolder& folder, std::function<void(const std::string& json)> tell);

    /// Names of jobs, relative to the folder; one may come several times.
    [[nodiscard]] std::vector<std::string> jobs() const;
    /// Another list in its place. Errors: more than `most_jobs`, a name that is no job of the folder, the disk.
    [[nodiscard]] Status set(std::vector<std::string> jobs);
    /// The first of that name goes: its print has begun. Nothing if it does not wait.
    void begun(const std::string& job);

    /// For pages: {"jobs": [{"name", "error" or "title", "printer", "layers", "seconds"}]}. Cost: each job is opened.
    [[nodiscard]] std::string json() const;
    [[nodiscard]] std::vector<std::string> news() const;

    static constexpr std::size_t most_jobs = 50;
    static constexpr const char* file_name = "print_queue.json";

private:
    [[nodiscard]] Status write(const std::vector<std::string>& jobs) const;
    void read();

    const ProjectFolder& folder_;
    std::function<void(const std::string& json)> tell_;
    mutable std::mutex mutex_;
    std::vector<std::string> jobs_;
};

}  // namespace pliant::studio

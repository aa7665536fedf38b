#include "studio/print/print_queue.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/core/files.hpp"
#include "base/core/json.hpp"
#include "printing/job/job.hpp"
#include "printing/operate/job_file.hpp"
#include "studio/base/dumped.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// The total time in the job's plan; nullopt: it has none.
std::optional<double> planned_s(const job::Archive& archive) {
    const Result<std::string> text = archive.file("plan.json");
    if (!text) return std::nullopt;
    const Json plan = parse_json(*text);
    if (!plan.is_object() || !plan.contains("seconds") || !plan["seconds"].is_object()) return std::nullopt;
    const Json total = plan["seconds"].value("total", Json());
    if (!total.is_number()) return std::nullopt;
    return total.get<double>();
}

Json queue_line(const std::string& name, const Result<std::filesystem::path>& path) {
    Json line = {{"name", name}};
    if (!path) {
        line["error"] = path.error().message;
        return line;
    }
    const Result<operate::OpenJob> open = operate::open_job(*path);
    if (!open) {
        line["error"] = open.error().message;
        return line;
    }
    const job::Manifest& manifest = open->archive.manifest();
    line["title"] = manifest.name;
    line["printer"] = open->printer.name;
    line["layers"] = manifest.layers.size();
    if (const auto seconds = planned_s(open->archive)) line["seconds"] = *seconds;
    return line;
}

}  // namespace

PrintQueue::PrintQueue(const ProjectFolder& folder, std::function<void(const std::string&)> tell)
    : folder_(folder), tell_(std::move(tell)) {
    read();
}

void PrintQueue::read() {
    constexpr std::uintmax_t largest = 1 << 20;
    const Result<std::string> text = read_file(folder_.path() / file_name, largest);
    if (!text) return;
    const Json json = parse_json(*text);
    if (!json.is_object() || !json.contains("jobs") || !json["jobs"].is_array()) return;
    for (const Json& name : json["jobs"]) {
        if (name.is_string() && jobs_.size() < most_jobs) jobs_.push_back(name.get<std::string>());
    }
}

std::vector<std::string> PrintQueue::jobs() const {
    const std::lock_guard lock(mutex_);
    return jobs_;
}

Status PrintQueue::set(std::vector<std::string> jobs) {
    if (jobs.size() > most_jobs) return input_error("jobs: at most {} wait", most_jobs);
    for (const std::string& name : jobs) {
        const Result<std::filesystem::path> path = folder_.resolve(name);
        if (!path) return tl::unexpected(path.error());
        if (lower_extension(*path) != ".zip") return input_error("\"{}\": a job (.zip) is needed", name);
    }
    {
        const std::lock_guard lock(mutex_);
        if (Status put = replace(std::move(jobs)); !put) return put;
    }
    tell_(news().front());
    return {};
}

Status PrintQueue::replace(std::vector<std::string> jobs) {
    if (Status written = write(jobs); !written) return written;
    jobs_ = std::move(jobs);
    return {};
}

Status PrintQueue::write(const std::vector<std::string>& jobs) const {
    return write_file(folder_.path() / file_name, json_text(Json{{"jobs", jobs}}, 1) + "\n");
}

void PrintQueue::begun(const std::string& job) {
    {
        const std::lock_guard lock(mutex_);
        std::vector<std::string> rest = jobs_;
        const auto found = std::find(rest.begin(), rest.end(), job);
        if (found == rest.end()) return;
        rest.erase(found);
        if (!replace(std::move(rest))) return;  // it is asked for again
    }
    tell_(news().front());
}

std::string PrintQueue::json() const {
    Json lines = Json::array();
    for (const std::string& name : jobs()) lines.push_back(queue_line(name, folder_.resolve(name)));
    return dumped({{"jobs", std::move(lines)}});
}

std::vector<std::string> PrintQueue::news() const {
    return {dumped({{"type", "queue"}, {"jobs", jobs()}})};
}

}  // namespace pliant::studio

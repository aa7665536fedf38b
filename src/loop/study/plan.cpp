#include "loop/study/plan.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"

namespace pliant::study {
namespace {

constexpr std::array<std::string_view, 5> design_names{"grid", "latin-hypercube", "sobol", "sensitivity", "table"};

std::string replaced(std::string word, const std::string& what, const std::string& by) {
    for (std::size_t at = word.find(what); at != std::string::npos; at = word.find(what, at + by.size()))
        word.replace(at, what.size(), by);
    return word;
}

nlohmann::json slurm_json(const SlurmOptions& slurm) {
    return {{"partition", slurm.partition}, {"account", slurm.account}, {"time", slurm.time},
            {"memory", slurm.memory},       {"options", slurm.options}, {"cpus_per_task", slurm.cpus_per_task}};
}

SlurmOptions slurm_of(const nlohmann::json& json) {
    SlurmOptions slurm;
    slurm.partition = json.at("partition").get<std::string>();
    slurm.account = json.at("account").get<std::string>();
    slurm.time = json.at("time").get<std::string>();
    slurm.memory = json.at("memory").get<std::string>();
    slurm.options = json.at("options").get<std::vector<std::string>>();
    slurm.cpus_per_task = json.at("cpus_per_task").get<int>();
    return slurm;
}

/// Checks that a plan read from JSON is consistent and can be run.
bool fits_together(const Plan& plan) {
    const bool counts = plan.rows_per_chunk >= 1 && plan.rows.size() <= most_rows && !plan.rows.empty() &&
                        plan.keys.size() <= most_keys && !plan.command.empty() && plan.slurm.cpus_per_task >= 1;
    return counts && std::all_of(plan.rows.begin(), plan.rows.end(),
                                 [&](const auto& row) { return row.size() == plan.keys.size(); });
}

Plan plan_of(const nlohmann::json& json) {
    Plan plan;
    plan.study = json.at("study").get<std::string>();
    plan.study_file = json.at("study_file").get<std::string>();
    plan.version = json.at("pliant").get<std::string>();
    plan.fingerprint = json.at("fingerprint").get<std::string>();
    plan.folder = json.at("folder").get<std::string>();
    plan.command = json.at("command").get<std::vector<std::string>>();
    const auto design = std::find(design_names.begin(), design_names.end(), json.at("design").get<std::string>());
    if (design == design_names.end()) throw nlohmann::json::other_error::create(501, "unknown design", nullptr);
    plan.design = static_cast<Design>(design - design_names.begin());
    plan.samples = json.at("samples").get<std::size_t>();
    for (const auto& key : json.at("keys"))
        plan.keys.push_back({key.at("name").get<std::string>(), key.at("set").get<std::string>(),
                             key.at("option").get<std::string>(), key.at("unit").get<std::string>(),
                             key.at("numeric").get<bool>(), key.value("gap", " ")});
    for (const auto& result : json.at("results"))
        plan.results.push_back(
            {result.at("name").get<std::string>(), result.at("path").get<std::string>(), result.at("line").get<int>()});
    plan.rows = json.at("rows").get<std::vector<std::vector<std::string>>>();
    plan.row_limit_s = json.at("row_limit_s").get<double>();
    plan.rows_per_chunk = json.at("rows_per_chunk").get<std::size_t>();
    plan.slurm = slurm_of(json.at("slurm"));
    return plan;
}

}  // namespace

std::string_view name(Design design) {
    return design_names[static_cast<std::size_t>(design)];
}

std::size_t Plan::chunk_end(std::size_t chunk) const {
    return std::min(rows.size(), (chunk + 1) * rows_per_chunk);
}

std::vector<std::string> row_words(const Plan& plan, std::size_t row, const std::filesystem::path& row_folder) {
    std::vector<std::string> words = plan.command;
    for (std::string& word : words) word = replaced(std::move(word), "{row}", row_folder.string());
    for (std::size_t k = 0; k < plan.keys.size(); ++k) {
        const Key& key = plan.keys[k];
        const std::string value = plan.rows[row][k] + (key.unit.empty() ? "" : key.gap + key.unit);
        if (!key.set.empty())
            words.insert(words.end(), {"--set", key.set + "=" + value});
        else if (!key.option.empty())
            words.push_back(key.option + "=" + value);
        else
            for (std::string& word : words) word = replaced(std::move(word), "{" + key.name + "}", value);
    }
    words.emplace_back("--json");
    return words;
}

bool wants_row_folder(const Plan& plan) {
    return std::any_of(plan.command.begin(), plan.command.end(),
                       [](const std::string& word) { return word.find("{row}") != std::string::npos; });
}

std::size_t usual_rows_per_chunk(std::size_t rows) {
    constexpr std::size_t busy = 64, most = 200, most_chunks = 1000;
    const auto over = [rows](std::size_t parts) { return (rows + parts - 1) / parts; };
    return std::max({std::size_t{1}, std::min(over(busy), most), over(most_chunks)});
}

std::string plan_json(const Plan& plan) {
    nlohmann::json keys = nlohmann::json::array(), results = nlohmann::json::array();
    for (const Key& key : plan.keys)
        keys.push_back({{"name", key.name},
                        {"set", key.set},
                        {"option", key.option},
                        {"unit", key.unit},
                        {"numeric", key.numeric},
                        {"gap", key.gap}});
    for (const Wanted& wanted : plan.results)
        results.push_back({{"name", wanted.name}, {"path", wanted.path}, {"line", wanted.line}});
    const nlohmann::json json = {{"study", plan.study},
                                 {"study_file", plan.study_file},
                                 {"pliant", plan.version},
                                 {"fingerprint", plan.fingerprint},
                                 {"folder", plan.folder.string()},
                                 {"command", plan.command},
                                 {"design", name(plan.design)},
                                 {"samples", plan.samples},
                                 {"keys", keys},
                                 {"results", results},
                                 {"rows", plan.rows},
                                 {"row_limit_s", plan.row_limit_s},
                                 {"rows_per_chunk", plan.rows_per_chunk},
                                 {"slurm", slurm_json(plan.slurm)}};
    return json_text(json) + "\n";
}

Result<Plan> parse_plan(std::string_view text, const std::string& file) {
    try {
        Plan plan = plan_of(parse_json(text));
        if (!fits_together(plan)) return input_error("{}: its rows and keys do not fit together", file);
        return plan;
    } catch (const nlohmann::json::exception&) {
        return input_error("{}: is not the plan of a study, or was damaged", file);
    }
}

}  // namespace pliant::study

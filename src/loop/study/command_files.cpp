#include "loop/study/command_files.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "base/core/files.hpp"
#include "robot/file/robot_document.hpp"

namespace pliant::study {
namespace {

namespace fs = std::filesystem;

/// The plan with only those keys that can name a file: the others may have a million values.
Plan with_names(const Plan& plan) {
    Plan part;
    part.command = plan.command;
    std::vector<std::size_t> columns;
    for (std::size_t k = 0; k < plan.keys.size(); ++k) {
        const Key& key = plan.keys[k];
        const bool is_in_words = key.set.empty() && key.option.empty();
        if (key.numeric && !is_in_words) continue;
        part.keys.push_back(key);
        columns.push_back(k);
    }
    part.rows.resize(columns.empty() ? 1 : plan.rows.size());
    for (std::size_t row = 0; row < part.rows.size(); ++row)
        for (const std::size_t column : columns) part.rows[row].push_back(plan.rows[row][column]);
    return part;
}

/// The words of all rows, each once, in the order of the first row and then of the alphabet.
std::vector<std::string> words_of(const Plan& plan) {
    const Plan part = with_names(plan);
    std::vector<std::string> words = plan.command;
    std::set<std::string> more;
    for (std::size_t row = 0; row < part.rows.size(); ++row)
        for (std::string& word : row_words(part, row, "{row}")) more.insert(std::move(word));
    for (const std::string& word : plan.command) more.erase(word);
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// What follows the first `=`, without quotation marks; empty without one.
std::string value_in(const std::string& word) {
    const std::size_t sign = word.find('=');
    std::string value = sign == std::string::npos ? "" : word.substr(sign + 1);
    const bool is_quoted =
        value.size() >= 2 && value.front() == value.back() && (value.front() == '"' || value.front() == '\'');
    return is_quoted ? value.substr(1, value.size() - 2) : value;
}

bool is_robot_file(const fs::path& file) {
    return lower_extension(file) == ".toml";
}

/// The robots that a robot file stands on, and what they are read from.
std::vector<fs::path> read_with(const fs::path& file) {
    std::vector<fs::path> files = robot::files_of(file, {});
    files.erase(files.begin());
    return files;
}

}  // namespace

std::vector<fs::path> files_of(const std::string& word, const fs::path& folder) {
    std::vector<fs::path> files{folder / word};
    if (const std::string value = value_in(word); !value.empty()) files.push_back(folder / value);
    std::erase_if(files, [](const fs::path& file) {
        std::error_code error;
        return !fs::is_regular_file(file, error);
    });
    for (std::size_t k = 0, count = files.size(); k < count; ++k) {
        if (!is_robot_file(files[k])) continue;
        for (fs::path& more : read_with(files[k]))
            if (is_robot_file(more)) files.push_back(std::move(more));
    }
    return files;
}

std::vector<fs::path> files_of(const Plan& plan) {
    std::vector<fs::path> files;
    std::set<fs::path> known, folders;
    const auto add = [&](const fs::path& file) {
        std::error_code error;
        const fs::path place = fs::weakly_canonical(file, error);
        if (known.insert(error ? file : place).second) files.push_back(file);
        if (is_robot_file(file)) folders.insert(file.parent_path());
    };
    const std::vector<std::string> words = words_of(plan);
    for (const std::string& word : words) {
        for (const fs::path& file : files_of(word, plan.folder)) {
            add(file);
            if (!is_robot_file(file)) continue;
            for (const fs::path& more : read_with(file)) add(more);
        }
    }
    // A path that --set gives counts from the robot file.
    for (const std::string& word : words) {
        const std::string value = value_in(word);
        for (const fs::path& folder : std::set<fs::path>(folders)) {
            std::error_code error;
            if (!value.empty() && fs::is_regular_file(folder / value, error)) add(folder / value);
        }
    }
    return files;
}

}  // namespace pliant::study

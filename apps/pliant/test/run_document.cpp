// Runs the commands of a document one after the other in a temporary folder, and compares their output with that in the
// document:
//   pliant_run_document PLIANT DOCUMENT.md [--update]      from the root of the repository
// --update replaces the output in the document where it differs. document.hpp says what is run.
#include <fmt/core.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "document.hpp"

namespace {

using namespace pliant;
using app::DocumentStep;
namespace fs = std::filesystem;

struct Outcome {
    int status = 0;
    std::vector<std::string> lines;
};

class Runner {
public:
    Runner(const fs::path& pliant, const fs::path& repository) : folder_("document") {
        fs::create_directory(folder_ / "bin");
        fs::create_directory(folder_ / "tmp");
        fs::create_directory(folder_ / "work");
        fs::create_symlink(fs::absolute(pliant), folder_ / "bin" / "pliant");
        for (const char* name : {"examples", "docs", "data"})
            fs::create_symlink(repository / name, folder_ / "work" / name);
    }

    /// Lines of output and errors in the order in which a terminal shows them. Files that a document puts in /tmp are
    /// redirected to the folder.
    Outcome shell(const std::string& command) const {
        const std::string here = (folder_ / "").string(), file = (folder_ / "command").string();
        const std::string script = fmt::format("cd '{0}work'; PATH='{0}bin':$PATH\n{1}\n", here,
                                               replaced(command, "/tmp/", (folder_ / "tmp/").string()));
        Outcome outcome{-1, {}};
        if (!write_file(file, script)) return outcome;
        FILE* pipe = popen(fmt::format("stdbuf -oL bash '{}' 2>&1", file).c_str(), "r");
        if (pipe == nullptr) return outcome;
        std::string text;
        char buffer[4096];
        for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
        const int status = pclose(pipe);
        outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
        std::istringstream in(replaced(text, (folder_ / "tmp/").string(), "/tmp/"));
        for (std::string line; std::getline(in, line);) outcome.lines.push_back(line);
        return outcome;
    }

    Status edit(const DocumentStep& step) const {
        const fs::path file = folder_ / "work" / step.file;
        const Result<std::string> old = step.kind == DocumentStep::Kind::save ? std::string() : read_file(file);
        if (!old) return tl::unexpected(old.error());
        const Result<std::string> made = app::edited(*old, step);
        if (!made) return tl::unexpected(made.error());
        return write_file(file, *made);
    }

private:
    static std::string replaced(std::string text, const std::string& from, const std::string& to) {
        for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
            text.replace(at, from.size(), to);
        return text;
    }

    test::Folder folder_;
};

std::string command_of(const DocumentStep& step) {
    const std::string command = step.text + step.options;
    return step.interrupt_s > 0 ? fmt::format("timeout -s INT {} {}", step.interrupt_s, command) : command;
}

/// The error of a step, "" if none.
std::string problem_of(const DocumentStep& step, const Runner& runner, std::vector<std::string>& printed) {
    if (step.kind == DocumentStep::Kind::skipped) {
        fmt::print("line {}: not run: {}: {}\n", step.line, step.text, step.reason);
        return "";
    }
    if (step.kind == DocumentStep::Kind::command || step.kind == DocumentStep::Kind::shell) {
        const Outcome outcome = runner.shell(command_of(step));
        printed = outcome.lines;
        const bool shown = step.shows_output;
        fmt::print("line {}: {}{}: exit status {}\n", step.line, step.text, step.options, outcome.status);
        if (!shown && outcome.status != 0 && step.interrupt_s == 0) {
            std::string text = fmt::format("exit status {}", outcome.status);
            for (const std::string& line : printed) text += "\n" + line;
            return text;
        }
        return app::difference(step, printed);
    }
    const Status done = runner.edit(step);
    return done ? "" : done.error().message;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        fmt::print(stderr, "pliant_run_document PLIANT DOCUMENT.md [--update]\n");
        return 2;
    }
    const std::string document = argv[2];
    const bool update = argc > 3 && std::string_view(argv[3]) == "--update";
    const Result<std::string> text = read_file(document);
    const Result<std::vector<DocumentStep>> steps = text ? app::document_steps(*text) : tl::unexpected(text.error());
    if (!steps) {
        fmt::print("{}: {}\n", document, steps.error().message);
        return 1;
    }
    const Runner runner(argv[1], fs::current_path());
    int wrong = 0;
    std::vector<std::vector<std::string>> printed(steps->size());
    for (std::size_t i = 0; i < steps->size(); ++i) {
        const std::string problem = problem_of((*steps)[i], runner, printed[i]);
        if (problem.empty()) {
            printed[i] = (*steps)[i].output;
            continue;
        }
        ++wrong;
        fmt::print("{}:{}: {}\n{}\n", document, (*steps)[i].line, (*steps)[i].text, problem);
    }
    fmt::print("{}: {} steps, {} wrong\n", document, steps->size(), wrong);
    if (update) return write_file(document, app::updated(*text, *steps, printed)) ? 0 : 1;
    return wrong == 0 && !steps->empty() ? 0 : 1;
}

// Devices for tests: a wire whose other end is a function, a clock that only counts, a projector that records.
#pragma once

#include <fmt/format.h>

#include <cstdlib>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "printing/wire/devices.hpp"

namespace pliant::host::test {

class CountingClock final : public Clock {
public:
    [[nodiscard]] double now() const override { return now_s; }
    void sleep(double seconds) override { now_s += seconds; }
    double now_s = 0;
};

/// A line number far ahead, which a host uses to query the last line.
inline bool is_probe(const std::string& line) {
    return line.rfind("N2147483640 ", 0) == 0;
}

inline std::string refusal(long last_line) {
    return fmt::format("Error:Line Number is not Last Line Number+1, Last Line: {}\nResend: {}\nok\n", last_line,
                       last_line + 1);
}

/// `answer` is called for every written line and returns the answer. Before the first line, `start` is sent. A probe
/// that would get a plain `ok` is answered like a Marlin that has accepted every numbered line so far.
class ScriptedWire final : public Wire {
public:
    ScriptedWire(CountingClock& clock, std::function<std::string(const std::string&)> answer)
        : clock_(clock), answer_(std::move(answer)) {}

    Status write(std::string_view bytes) override {
        for (const char c : bytes) {
            if (c != '\n') {
                line_ += c;
                continue;
            }
            if (line_.empty()) continue;  // firmware does not answer an empty line
            written.push_back(line_);
            pending_ += answer_to(line_);
            line_.clear();
        }
        return {};
    }
    Result<std::string> read(double timeout_s) override {
        if (Status status = at_read ? at_read() : Status{}; !status) return tl::unexpected(status.error());
        if (!pending_.empty()) return std::exchange(pending_, {});
        const bool talks = !talk.empty() && timeout_s >= 1;
        clock_.now_s += talks ? 1 : timeout_s;
        return talks ? talk : "";
    }

    std::vector<std::string> written;
    std::string forgets;              ///< a line that contains this is dropped once, whatever its answer
    std::string talk;                 ///< sent every second, unasked
    std::function<Status()> at_read;  ///< called before each read; an error is that of the wire

private:
    std::string answer_to(const std::string& line) {
        const std::string said = answer_(line);
        if (is_probe(line) && said == "ok\n") return refusal(last_line_);
        const bool taken =
            said.size() >= 3 && said.substr(said.size() - 3) == "ok\n" && said.find("Resend") == said.npos;
        if (!forgets.empty() && line.find(forgets) != line.npos) return forgets.clear(), said;
        if (line[0] == 'N' && taken && !is_probe(line)) last_line_ = std::atol(line.c_str() + 1);
        return said;
    }

    CountingClock& clock_;
    std::function<std::string(const std::string&)> answer_;
    long last_line_ = 0;
    std::string pending_ = "start\n";
    std::string line_;
};

class RememberingProjector final : public Projector {
public:
    Status show(const job::Image& image) override {
        lit = true;
        shown.push_back(image);
        return {};
    }
    Status black() override {
        lit = false;
        return {};
    }
    bool lit = false;
    std::vector<job::Image> shown;
};

/// Marlin's answer to a valid line: the echo of M118, and ok.
inline std::string good_answer(const std::string& line) {
    const std::size_t token = line.find("M118 E1 ");
    if (token == std::string::npos) return "ok\n";
    return fmt::format("echo:{}\nok\n", line.substr(token + 8, line.find('*') - token - 8));
}

}  // namespace pliant::host::test

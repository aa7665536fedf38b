#include "base/core/process.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <sstream>

#include "base/core/file_handle.hpp"
#include "base/core/shell_word.hpp"

using namespace pliant;

namespace {

struct Pipe {
    FileHandle out, in;
};

Pipe make_pipe() {
    std::array<int, 2> ends{};
    REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0);
    return {FileHandle(ends[0]), FileHandle(ends[1])};
}

std::string read_all(const FileHandle& file) {
    std::string text;
    std::array<char, 256> bytes;
    for (ssize_t got = 1; got > 0;) {
        got = ::read(file.number(), bytes.data(), bytes.size());
        if (got > 0) text.append(bytes.data(), static_cast<std::size_t>(got));
    }
    return text;
}

struct Ran {
    pid_t process = 0;
    std::string said;
    int status = 0;  ///< as of waitpid()
};

/// Output of /bin/sh running `script` with `input`; -1: no input.
Ran run(const std::string& script, int input = -1) {
    Pipe pipe = make_pipe();
    const Result<pid_t> process =
        start_process("/bin/sh", {"-c", script, "sh", "two words", ""}, {input, pipe.in.number()});
    REQUIRE(process);
    pipe.in.close();
    Ran ran{*process, read_all(pipe.out), 0};
    REQUIRE(::waitpid(*process, &ran.status, 0) == *process);
    return ran;
}

}  // namespace

TEST_CASE("a process gets its arguments unchanged, and its output is redirected") {
    const Ran ran = run("printf '%s|' \"$#\" \"$@\"; echo unheard >&2; exit 3");
    CHECK(ran.said == "2|two words||");
    CHECK(WEXITSTATUS(ran.status) == 3);
}

TEST_CASE("a process reads its input, or nothing if there is none") {
    Pipe pipe = make_pipe();
    REQUIRE(::write(pipe.in.number(), "given\n", 6) == 6);
    pipe.in.close();
    CHECK(run("cat", pipe.out.number()).said == "given\n");
    CHECK(run("cat").said.empty());
}

TEST_CASE("a process leads its own session and blocks no signal") {
    sigset_t all, before;
    sigfillset(&all);
    REQUIRE(::sigprocmask(SIG_SETMASK, &all, &before) == 0);
    // By the shell alone: while it starts a program it may block every signal for a moment.
    const Ran ran =
        run("read -r a b c d e session rest < /proc/$$/stat; echo $session; "
            "while read -r key value; do [ $key = SigBlk: ] && echo $key $value; done < /proc/$$/status; true");
    REQUIRE(::sigprocmask(SIG_SETMASK, &before, nullptr) == 0);
    std::istringstream words(ran.said);
    pid_t session = 0;
    std::string key, blocked;
    words >> session >> key >> blocked;
    CHECK(session == ran.process);
    // Bit 16 is SIGCHLD, which a shell may block while it waits.
    CHECK((std::stoull(blocked, nullptr, 16) & ~(1ULL << 16)) == 0);
}

TEST_CASE("a missing program is reported") {
    const Result<pid_t> process = start_process("/no/such/program", {}, {});
    REQUIRE_FALSE(process);
    CHECK(process.error().message == "/no/such/program: cannot be started: No such file or directory");
}

TEST_CASE("a child process is killed with its owner, or ends by itself within a second") {
    const auto start = [](const std::string& script) { return start_process("/bin/sh", {"-c", script}, {}); };
    pid_t process = 0;
    {
        const auto sleeper = start("exec sleep 60");
        REQUIRE(sleeper);
        const ChildProcess child(process = *sleeper);
    }
    CHECK(::kill(process, 0) != 0);
    ChildProcess quick(*start("exit 3"));
    CHECK(end_text(quick.let_end()) == "exit status 3");
    CHECK(end_text(quick.end()) == "exit status 3");
    ChildProcess slow(*start("exec sleep 60"));
    CHECK(end_text(slow.end()) == "signal 9: Killed");
}

TEST_CASE("a forked program leaves the child processes of the one before it alone") {
    const Result<pid_t> sleeper = start_process("/bin/sh", {"-c", "exec sleep 60"}, {});
    REQUIRE(sleeper);
    ChildProcess child(*sleeper);
    const pid_t fork = ::fork();
    REQUIRE(fork >= 0);
    if (fork == 0) {
        const bool is_ours = child.is_ours();
        (void)child.let_end();
        (void)child.end();
        ::_exit(is_ours ? 1 : 0);
    }
    int status = -1;
    REQUIRE(::waitpid(fork, &status, 0) == fork);
    CHECK(status == 0);
    CHECK(child.is_ours());
    siginfo_t info{};
    REQUIRE(::waitid(P_PID, static_cast<id_t>(*sleeper), &info, WEXITED | WNOHANG | WNOWAIT) == 0);
    CHECK(info.si_pid == 0);  // it has not ended
    CHECK(end_text(child.end()) == "signal 9: Killed");
}

TEST_CASE("texts in shell quotes come back from a shell as they were") {
    const std::string text = "it's $HOME `x` \"y\" \\";
    CHECK(run("printf %s " + in_shell_quotes(text)).said == text);
    CHECK(run("printf %s " + shell_word(text)).said == text);
    CHECK(shell_word("jobs/my_finger-2.zip") == "jobs/my_finger-2.zip");
    CHECK(shell_word("my finger.toml") == "'my finger.toml'");
    CHECK(shell_word("") == "''");
}

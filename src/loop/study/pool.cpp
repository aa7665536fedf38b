#include "loop/study/pool.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/core/file_handle.hpp"
#include "base/core/process.hpp"
#include "loop/study/wire.hpp"

namespace pliant::study {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int look_every_ms = 100;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A process that serves rows, killed with its owner.
class Worker {
public:
    Worker(pid_t process, FileHandle socket) : process_(process), socket_(std::move(socket)) {}

    [[nodiscard]] ChildProcess& process() { return process_; }
    /// Closes its socket, so that it ends by itself.
    ProcessEnd finish() {
        ::shutdown(socket_.number(), SHUT_RDWR);
        return process_.let_end();
    }
    [[nodiscard]] int file() const { return socket_.number(); }

    Inbox inbox;
    bool ready = false;
    std::optional<RowOrder> order;
    Clock::time_point begun;
    double rows_cpu_s = 0;  ///< of the rows it has completed

private:
    ChildProcess process_;
    FileHandle socket_;
};

Result<std::unique_ptr<Worker>> start_worker(const PoolOptions& options) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
        return failure("no socket for the rows can be made: {}", std::strerror(errno));
    FileHandle ours(ends[0]);
    const FileHandle theirs(ends[1]);
    const auto process = start_process(options.worker.program, options.worker.words, {.input = theirs.number()});
    if (!process) return tl::unexpected(process.error());
    auto worker = std::make_unique<Worker>(*process, std::move(ours));
    // If the process is already dead, the next read notices it.
    (void)send_message(worker->file(), {{"paths", options.paths}, {"work_in", options.folder.string()}});
    return worker;
}

Result<RowRecord> record_of(std::size_t row, const nlohmann::json& answer, std::size_t results) try {
    RowRecord record{row,
                     answer.at("done").get<bool>(),
                     answer.at("missing_path").get<bool>(),
                     answer.at("reason").get<std::string>(),
                     {},
                     answer.at("wall_s").get<double>(),
                     answer.at("cpu_s").get<double>(),
                     answer.at("wrong_input").get<bool>(),
                     answer.at("warning").get<std::string>()};
    for (const auto& value : answer.at("values"))
        record.values.push_back(value.is_null() ? std::nan("") : value.get<double>());
    if (record.values.size() != results) return failure("row {}: an answer with {} numbers", row, record.values.size());
    return record;
} catch (const nlohmann::json::exception&) {
    return failure("row {}: an answer that cannot be read", row);
}

class Pool {
public:
    Pool(const PoolOptions& options, const PoolCalls& calls, const Progress& progress)
        : options_(options), calls_(calls), progress_(progress) {}

    Result<double> run() {
        for (;;) {
            if (progress_.cancelled()) return cancel();
            if (Status status = give_orders(); !status) return tl::unexpected(status.error());
            if (busy() == 0 && exhausted_ && again_.empty()) break;
            if (Status status = listen(); !status) return tl::unexpected(status.error());
            if (Status status = end_late_rows(); !status) return tl::unexpected(status.error());
            if (calls_.look) calls_.look();
        }
        for (auto& worker : workers_) cpu_s_ += worker->finish().cpu_s;
        workers_.clear();
        return cpu_s_;
    }

private:
    [[nodiscard]] std::size_t busy() const {
        return static_cast<std::size_t>(std::count_if(workers_.begin(), workers_.end(),
                                                      [](const auto& worker) { return worker->order.has_value(); }));
    }

    Result<double> cancel() {
        Status told;
        for (auto& worker : workers_) {
            worker->process().end();
            if (worker->order && told) told = calls_.given_up(worker->order->row);
        }
        if (!told) return tl::unexpected(told.error());
        return cancelled();
    }

    Result<std::optional<RowOrder>> next_order() {
        if (!again_.empty()) {
            RowOrder order = std::move(again_.front());
            again_.pop_front();
            return std::optional(std::move(order));
        }
        if (exhausted_) return std::optional<RowOrder>{};
        auto order = calls_.next();
        if (order && !*order) exhausted_ = true;
        return order;
    }

    /// Processes that have not reported ready yet.
    [[nodiscard]] std::size_t starting() const {
        return static_cast<std::size_t>(
            std::count_if(workers_.begin(), workers_.end(), [](const auto& worker) { return !worker->ready; }));
    }

    /// Whether more than `count` rows wait: no process is started in vain.
    Result<bool> more_than(std::size_t count) {
        while (again_.size() <= count) {
            if (exhausted_) return false;
            auto order = calls_.next();
            if (!order) return tl::unexpected(order.error());
            exhausted_ = !*order;
            if (*order) again_.push_back(std::move(**order));
        }
        return true;
    }

    /// Gives a row to every waiting process; there are as many processes as parallel rows.
    Status give_orders() {
        for (std::size_t k = 0; k <= workers_.size() && k < static_cast<std::size_t>(options_.jobs); ++k) {
            if (k < workers_.size() && (!workers_[k]->ready || workers_[k]->order)) continue;
            if (k == workers_.size()) {
                const Result<bool> wanted = more_than(starting());
                if (!wanted) return tl::unexpected(wanted.error());
                if (!*wanted) return {};
                auto worker = start_worker(options_);
                if (!worker) return tl::unexpected(worker.error());
                workers_.push_back(std::move(*worker));
                continue;
            }
            auto order = next_order();
            if (!order) return tl::unexpected(order.error());
            if (!*order) return {};
            if (Status status = calls_.begun((*order)->row); !status) return status;
            Worker& worker = *workers_[k];
            worker.order = std::move(**order);
            worker.begun = Clock::now();
            (void)send_message(worker.file(), {{"words", worker.order->words}, {"folder", worker.order->folder}});
        }
        return {};
    }

    Status listen() {
        std::vector<pollfd> files;
        for (const auto& worker : workers_) files.push_back({worker->file(), POLLIN, 0});
        if (::poll(files.data(), files.size(), look_every_ms) <= 0) return {};
        std::vector<std::unique_ptr<Worker>> kept;
        Status status;
        for (std::size_t k = 0; k < files.size(); ++k) {
            bool alive = true;
            if (files[k].revents != 0 && status) status = hear(*workers_[k], alive);
            if (alive) kept.push_back(std::move(workers_[k]));
        }
        workers_ = std::move(kept);
        return status;
    }

    Status hear(Worker& worker, bool& alive) {
        alive = worker.inbox.read_some(worker.file());
        if (!alive) return bury(worker);
        while (const auto message = worker.inbox.take()) {
            if (!worker.ready) {
                worker.ready = true;
                failed_starts_ = 0;
                continue;
            }
            if (!worker.order) continue;
            const auto record = record_of(worker.order->row, *message, options_.paths.size());
            worker.order.reset();
            if (!record) return tl::unexpected(record.error());
            worker.rows_cpu_s += record->cpu_s;
            if (Status status = calls_.ended(*record); !status) return status;
        }
        return {};
    }

    /// Handles a dead process: its row fails, unless the process was killed from outside.
    Status bury(Worker& worker) {
        constexpr int most_failed_starts = 3;
        const ProcessEnd death = worker.process().let_end();
        cpu_s_ += death.cpu_s;
        if (!worker.ready && ++failed_starts_ >= most_failed_starts)
            return failure("{}: worker exited before its first row ({})", options_.worker.program.string(),
                           end_text(death));
        if (!worker.order) return {};
        const bool killed = WIFSIGNALED(death.status) && WTERMSIG(death.status) == SIGKILL;
        RowOrder order = std::move(*worker.order);
        if (killed && ++kills_[order.row] < options_.tries) {
            again_.push_back(std::move(order));
            return {};
        }
        return fail(order.row,
                    killed ? fmt::format("was killed {} times ({}); was there too little memory?", options_.tries,
                                         end_text(death))
                           : fmt::format("crashed ({})", end_text(death)),
                    worker, death);
    }

    Status fail(std::size_t row, std::string reason, const Worker& worker, const ProcessEnd& death) {
        RowRecord record{row,
                         false,
                         false,
                         std::move(reason),
                         {},
                         seconds_since(worker.begun),
                         std::max(0.0, death.cpu_s - worker.rows_cpu_s)};
        record.values.assign(options_.paths.size(), std::nan(""));
        return calls_.ended(record);
    }

    Status end_late_rows() {
        if (!(options_.row_limit_s > 0)) return {};
        for (std::size_t k = 0; k < workers_.size(); ++k) {
            Worker& worker = *workers_[k];
            if (!worker.order || seconds_since(worker.begun) < options_.row_limit_s) continue;
            const ProcessEnd death = worker.process().end();
            cpu_s_ += death.cpu_s;
            Status status =
                fail(worker.order->row, fmt::format("took longer than {:g} s", options_.row_limit_s), worker, death);
            workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(k));
            return status;
        }
        return {};
    }

    const PoolOptions& options_;
    const PoolCalls& calls_;
    const Progress& progress_;
    std::vector<std::unique_ptr<Worker>> workers_;
    std::deque<RowOrder> again_;  ///< rows taken but not running, to be run before others
    std::map<std::size_t, int> kills_;
    bool exhausted_ = false;
    int failed_starts_ = 0;
    double cpu_s_ = 0;
};

}  // namespace

Result<double> run_pool(const PoolOptions& options, const PoolCalls& calls, const Progress& progress) {
    return Pool(options, calls, progress).run();
}

}  // namespace pliant::study

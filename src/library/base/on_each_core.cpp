#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "base/core/own_core.hpp"
#include "library/base/calls.hpp"
#include "pliant/batch.hpp"

namespace pliant {
namespace {

/// Threads that process work items one after the other, until none is left or the work is cancelled.
class Crew {
public:
    Crew(std::size_t n, const std::function<void(std::size_t)>& work, const Watch& watch)
        : n_(n), work_(work), watch_(watch), thrown_(n) {}

    void run(int threads) {
        std::vector<std::jthread> helpers;
        busy_ = std::max(0, threads - 1);
        for (int h = 1; h < threads; ++h) {
            helpers.emplace_back([this] {
                take(false);
                const std::lock_guard lock(mutex_);
                --busy_;
                done_.notify_all();
            });
        }
        take(true);
        wait();
    }
    /// Rethrows the exception of a work item.
    void tell() const {
        if (asked_) std::rethrow_exception(asked_);
        for (const std::exception_ptr& one : thrown_)
            if (one) std::rethrow_exception(one);
        if (stop_) throw Failure(Failure::Kind::cancelled, "cancelled");
    }

private:
    void take(bool asks) {
        on_own_core([&] {
            while (!stop_ && !failed_) {
                if (asks) ask();
                const std::size_t i = next_++;
                if (stop_ || i >= n_) return;
                try {
                    work_(i);
                } catch (...) {
                    thrown_[i] = std::current_exception();
                    failed_ = true;
                }
                ++finished_;
            }
        });
    }
    void wait() {
        std::unique_lock lock(mutex_);
        while (busy_ > 0) {
            done_.wait_for(lock, std::chrono::milliseconds(50));
            lock.unlock();
            ask();
            lock.lock();
        }
    }
    void ask() {
        if (!watch_ || stop_) return;
        try {
            const double share = n_ == 0 ? 1 : static_cast<double>(finished_) / static_cast<double>(n_);
            stop_ = !watch_("robots", share);
        } catch (...) {
            asked_ = std::current_exception();
            stop_ = true;
        }
    }

    const std::size_t n_;
    const std::function<void(std::size_t)>& work_;
    const Watch& watch_;
    std::vector<std::exception_ptr> thrown_;
    std::exception_ptr asked_;
    std::atomic<std::size_t> next_ = 0, finished_ = 0;
    std::atomic<bool> stop_ = false, failed_ = false;
    std::mutex mutex_;
    std::condition_variable done_;
    int busy_ = 0;
};

}  // namespace

void on_each_core(std::size_t n, const std::function<void(std::size_t)>& work, int threads, const Watch& watch) {
    if (threads < 0) throw Failure(Failure::Kind::input, "the number of threads is negative");
    if (!work) throw Failure(Failure::Kind::input, "the work for each core is an empty function");
    const std::size_t most = threads > 0 ? static_cast<std::size_t>(threads) : static_cast<std::size_t>(core_count());
    Crew crew(n, work, watch);
    crew.run(static_cast<int>(std::min({most, n, std::size_t{1024}})));
    crew.tell();
}

}  // namespace pliant

// Searches requested by a page, on a thread of their own: one at a time, with progress; the result is kept until the
// next one.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "simulation/parts/inverse_task.hpp"
#include "studio/requests/search_order.hpp"
#include "studio/search/motion.hpp"
#include "studio/simulate/simulation_session.hpp"

namespace pliant::studio {

/// Result of a search.
struct SearchResult {
    std::string json;  ///< {"kind": "goal", "identify", "workspace", "sweep" or "motion", "revision", "opened",
                       ///< "order", "found": ...}
    struct Plot {
        std::string unit;  ///< of the values
        std::string png;
    };
    std::vector<Plot> plots{};               ///< for an identification
    std::shared_ptr<const Motion> motion{};  ///< for a motion
};

class SearchSession {
public:
    /// `tell` sends events to the pages, from the search's thread.
    explicit SearchSession(std::function<void(const std::string& json)> tell) : tell_(std::move(tell)) {}
    ~SearchSession();
    SearchSession(const SearchSession&) = delete;
    SearchSession& operator=(const SearchSession&) = delete;

    /// Starts the search; the pages are told of its progress and its end. Errors: one is running already.
    [[nodiscard]] Status find_inputs(std::shared_ptr<const Built> built, sim::InverseTask task);
    [[nodiscard]] Status identify(std::shared_ptr<const Built> built, IdentifyOrder order);
    [[nodiscard]] Status find_workspace(std::shared_ptr<const Built> built, sim::InverseTask task,
                                        const WorkspaceOrder& order);
    [[nodiscard]] Status sweep(std::shared_ptr<const Built> built, SweepOrder order);
    /// Runs the whole program, for playback.
    [[nodiscard]] Status run_motion(std::shared_ptr<const Built> built);
    void cancel() { cancelled_ = true; }

    /// Result of the last completed search; null if there is none.
    [[nodiscard]] std::shared_ptr<const SearchResult> result() const;
    [[nodiscard]] std::vector<std::string> news() const;

private:
    class Watch;
    [[nodiscard]] Status begin(const char* kind, std::function<Result<SearchResult>(Progress&)> work);

    std::function<void(const std::string& json)> tell_;
    mutable std::mutex mutex_;
    std::shared_ptr<const SearchResult> result_;
    int results_ = 0;
    std::string kind_;
    std::atomic<bool> running_ = false, cancelled_ = false;
    std::thread thread_;
};

}  // namespace pliant::studio

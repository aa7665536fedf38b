#include "pliant/batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <utility>

#include "base/core/own_core.hpp"
#include "library/base/calls.hpp"
#include "library/base/in_use.hpp"

namespace pliant {

struct Batch::Work {
    std::vector<Stepper> steppers;
    int threads = 1;
    library::InUse in_use{"batch"};
};

namespace {

/// One Watch for all robots: called on the calling thread, its answer is seen by all.
class SharedWatch {
public:
    SharedWatch(const Watch& watch, std::size_t robots) : watch_(watch), robots_(robots) {}

    [[nodiscard]] bool go_on() {
        if (std::this_thread::get_id() == caller_ && watch_ && !stop_) ask();
        return !stop_;
    }
    void count() { ++done_; }
    void tell() const {
        if (thrown_) std::rethrow_exception(thrown_);
        if (stop_) throw Failure(Failure::Kind::cancelled, "cancelled");
    }

private:
    void ask() {
        try {
            const double share = robots_ == 0 ? 1 : static_cast<double>(done_) / static_cast<double>(robots_);
            stop_ = !watch_("robots", share);
        } catch (...) {
            thrown_ = std::current_exception();
            stop_ = true;
        }
    }

    const Watch& watch_;
    const std::size_t robots_;
    const std::thread::id caller_ = std::this_thread::get_id();
    std::atomic<std::size_t> done_ = 0;
    std::atomic<bool> stop_ = false;
    std::exception_ptr thrown_;
};

[[noreturn]] void fail_of(std::size_t robot, const Failure& failure) {
    throw Failure(failure.kind(), fmt::format("robot {}: {}", robot, failure.what()), failure.file(), failure.line(),
                  failure.key());
}

void expect_count(std::size_t given, std::size_t robots, const char* what) {
    if (given == robots) return;
    throw Failure(Failure::Kind::input, fmt::format("{} {} for {} robots", given, what, robots));
}

}  // namespace

Batch::Batch(const std::vector<Model>& models, const StepOptions& options, int threads, const Watch& watch)
    : work_(std::make_unique<Work>()) {
    if (threads < 0) throw Failure(Failure::Kind::input, "the number of threads is negative");
    const auto most = static_cast<int>(std::max<std::size_t>(models.size(), 1));
    work_->threads = std::min(threads > 0 ? threads : core_count(), most);
    std::vector<std::unique_ptr<Stepper>> made(models.size());
    on_each_core(
        models.size(), [&](std::size_t i) { made[i] = std::make_unique<Stepper>(models[i], options); }, threads, watch);
    for (auto& stepper : made) work_->steppers.push_back(std::move(*stepper));
}
Batch::Batch(Batch&&) noexcept = default;
Batch& Batch::operator=(Batch&&) noexcept = default;
Batch::~Batch() = default;

std::size_t Batch::size() const {
    return work_->steppers.size();
}
int Batch::threads() const {
    return work_->threads;
}

Stepper& Batch::stepper(std::size_t index) {
    if (index >= size())
        throw Failure(Failure::Kind::input, fmt::format("there is no robot {}; there are {}", index, size()));
    return work_->steppers[index];
}

std::vector<State> Batch::rest() const {
    const library::Use use(work_->in_use);
    std::vector<State> states;
    for (const Stepper& stepper : work_->steppers) states.push_back(stepper.rest());
    return states;
}

std::vector<StepResult> Batch::step(std::vector<State>& states, const std::vector<Inputs>& inputs, const Watch& watch) {
    expect_count(states.size(), size(), "states");
    expect_count(inputs.size(), size(), "inputs");
    const library::Use use(work_->in_use);
    std::vector<State> next = states;
    std::vector<StepResult> results(size());
    SharedWatch shared(watch, size());
    const Watch heard = [&shared](std::string_view, double) { return shared.go_on(); };
    const auto step_one = [&](std::size_t i) {
        try {
            results[i] = work_->steppers[i].step(next[i], inputs[i], heard);
        } catch (const Failure& failure) {
            if (failure.kind() != Failure::Kind::cancelled) fail_of(i, failure);
        }
        shared.count();
    };
    try {
        on_each_core(size(), step_one, work_->threads, heard);
    } catch (const Failure& failure) {
        if (failure.kind() != Failure::Kind::cancelled) throw;
    }
    states = std::move(next);
    shared.tell();
    return results;
}

std::vector<Observation> Batch::observe(const std::vector<State>& states) {
    expect_count(states.size(), size(), "states");
    const library::Use use(work_->in_use);
    std::vector<Observation> seen(size());
    const auto observe_one = [&](std::size_t i) {
        try {
            seen[i] = work_->steppers[i].observe(states[i]);
        } catch (const Failure& failure) {
            fail_of(i, failure);
        }
    };
    on_each_core(size(), observe_one, work_->threads);
    return seen;
}

}  // namespace pliant

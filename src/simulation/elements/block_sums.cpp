#include "simulation/elements/block_sums.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "base/core/parallel.hpp"
#include "simulation/elements/element_kernels.hpp"

namespace pliant::sim {
namespace {

constexpr std::size_t least_batches = 128, most_runs = 16;  // the more runs, the more blocks are shared
constexpr std::size_t largest_share = 2;                    // at most one in this many blocks may be shared
constexpr std::size_t shared_at_once = 512;
constexpr int nobody = -1, several = -2;

/// Records that `run` adds to a block; may be called concurrently, with the same result.
void claim(int& owner, int run) {
    const std::atomic_ref<int> at(owner);
    int before = at.load(std::memory_order_relaxed);
    if (before == run || before == several) return;
    if (before == nobody && at.compare_exchange_strong(before, run, std::memory_order_relaxed)) return;
    at.store(several, std::memory_order_relaxed);
}

}  // namespace

BlockSums::BlockSums(std::vector<int> slots, std::size_t batches, std::size_t blocks)
    : batches_(batches),
      width_(batches == 0 ? 0 : slots.size() / batches),
      blocks_(static_cast<int>(blocks)),
      slots_(std::move(slots)) {
    list_start_.assign(std::clamp<std::size_t>(batches / least_batches, 1, most_runs) + 1, 0);
    std::vector<int> owner(blocks, nobody);
    parallel_for(runs(), 1, [&](std::size_t run, std::size_t) {
        for (const int slot : slots_of(run)) {
            if (slot != no_slot) claim(owner[slot / 2], static_cast<int>(run));
        }
    });
    for (int block = 0; block < blocks_; ++block) {
        if (owner[block] == several) shared_.push_back(block);
    }
    if (shared_.size() <= blocks / largest_share) {
        share_out();
    } else {  // unordered tets would share nearly all blocks, and lists take memory: use a single run
        list_start_.assign(2, 0);
        shared_.clear();
    }
}

std::span<int> BlockSums::slots_of(std::size_t run) {
    return std::span(slots_).subspan(first_batch(run) * width_, (first_batch(run + 1) - first_batch(run)) * width_);
}

/// Gives each run a place in its list for each of the shared blocks that it adds to.
void BlockSums::share_out() {
    std::vector<int> number(static_cast<std::size_t>(blocks_), -1);
    for (std::size_t k = 0; k < shared_.size(); ++k) number[shared_[k]] = static_cast<int>(k);
    linalg::Lists lists = linalg::make_lists(static_cast<int>(runs()), [&] {
        return [&, place = std::vector<int>()](int run, std::vector<int>& list) mutable {
            const std::size_t begin = list.size();
            place.assign(shared_.size(), -1);
            for (int& slot : slots_of(static_cast<std::size_t>(run))) {
                const int k = slot == no_slot ? -1 : number[slot / 2];
                if (k < 0) continue;
                if (place[k] < 0) {
                    place[k] = static_cast<int>(list.size() - begin);
                    list.push_back(k);
                }
                slot = 2 * (blocks_ + place[k]) + slot % 2;
            }
        };
    });
    uses_ = linalg::members_of(lists.item, static_cast<int>(shared_.size()));
    list_start_ = std::move(lists.start);
}

void BlockSums::add(const Fill& fill, std::size_t size, std::span<double> values, ArrayPool<double>& scratch) const {
    const auto places = static_cast<std::size_t>(list_start_.back());
    const auto lists = scratch.lend(places * size);
    parallel_for(runs(), 1, [&](std::size_t run, std::size_t) {
        const auto written = scratch.lend(width_ * size);
        double* list = lists.data() + static_cast<std::size_t>(list_start_[run]) * size;
        std::fill(list, lists.data() + static_cast<std::size_t>(list_start_[run + 1]) * size, 0.0);
        for (std::size_t b = first_batch(run); b < first_batch(run + 1); ++b) {
            fill(b, written.data());
            if (size == 1)
                add_batch<1>(b, written.data(), values.data(), list);
            else
                add_batch<9>(b, written.data(), values.data(), list);
        }
    });
    parallel_for(shared_.size(), shared_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            double* to = values.data() + static_cast<std::size_t>(shared_[k]) * size;
            for (const int place : uses_[k]) {
                const double* from = lists.data() + static_cast<std::size_t>(place) * size;
                for (std::size_t i = 0; i < size; ++i) to[i] += from[i];
            }
        }
    });
}

template <std::size_t size>
void BlockSums::add_batch(std::size_t batch, const double* written, double* values, double* list) const {
    const int* slot = slots_.data() + batch * width_;
    for (const int* end = slot + width_; slot != end; slot += batch_lanes, written += size * batch_lanes) {
        for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
            if (slot[lane] == no_slot) continue;
            const int at = slot[lane] / 2;
            double* to = at < blocks_ ? values + static_cast<std::size_t>(at) * size
                                      : list + static_cast<std::size_t>(at - blocks_) * size;
            const double* from = written + lane;
            if (size == 1 || slot[lane] % 2 == 0) {
                for (std::size_t k = 0; k < size; ++k) to[k] += from[k * batch_lanes];
            } else {
                for (std::size_t k = 0; k < size; ++k) to[k] += from[(k % 3 * 3 + k / 3) * batch_lanes];
            }
        }
    }
}

}  // namespace pliant::sim

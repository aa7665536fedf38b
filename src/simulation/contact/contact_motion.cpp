// How far nodes may move until features meet.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

#include "base/linalg/extents.hpp"
#include "simulation/contact/ccd.hpp"
#include "simulation/contact/contact_search.hpp"

namespace pliant::sim::contact {
namespace {

constexpr int few_looks = 8;

/// A clearance that answers fewer calls than this has cost more than it saved.
constexpr int worth_knowing = 4;

}  // namespace

bool Contact::is_clear(std::span<const double> x, std::span<const double> dx) const {
    std::shared_ptr<const Clearance> known;
    {
        const std::lock_guard lock(memory_->mutex);
        if (!memory_->clear.known) return false;
        if (dx.empty() && std::ranges::equal(memory_->clear.end, x)) return true;
        known = memory_->clear.known;
    }
    const bool holds = known->holds(x, dx);
    const std::lock_guard lock(memory_->mutex);
    auto& clear = memory_->clear;
    if (holds) {
        ++clear.served;
        clear.end.assign(x.begin(), x.end());
        for (std::size_t i = 0; i < dx.size(); ++i) clear.end[i] += dx[i];
        return true;
    }
    if (clear.known != known) return false;
    if (clear.served >= worth_knowing)
        clear.patience = 1, clear.wait = 0;
    else
        clear.grow_patience();
    clear.known.reset();
    clear.end.clear();
    return false;
}

void Contact::wait_for_clearance() const {
    const std::lock_guard lock(memory_->mutex);
    memory_->clear.grow_patience();
}

void Contact::note_clearance(std::span<const double> x) const {
    {
        const std::lock_guard lock(memory_->mutex);
        if (memory_->clear.known || memory_->clear.wait-- > 0) return;
    }
    struct Seen {
        Search::Candidate candidate;
        double now_m, rest_m;  ///< apart
    };
    const auto look = [&](const Search::Candidate& c, std::vector<Seen>& seen) {
        if (c.distance_bound(x) >= seen_m_) return;
        const double now = std::sqrt(c.squared_distance(x)), rest = std::sqrt(c.squared_distance(rest_));
        if (now < seen_m_ && !left_out(c.first_nodes(), c.second_nodes(), rest)) seen.push_back({c, now, rest});
    };
    const Search search(*this, x, {}, seen_m_, Search::What::pairs, settings_.self);
    std::vector<Seen> all;
    for (const std::vector<Seen>& piece : search.run(std::vector<Seen>{}, look))
        all.insert(all.end(), piece.begin(), piece.end());
    const auto reach_of = [&](const Seen& s) { return reach(std::span(s.candidate.nodes).first<4>(), s.rest_m); };
    if (std::ranges::any_of(all, [&](const Seen& s) { return s.now_m <= reach_of(s); })) return wait_for_clearance();
    std::vector<Clearance::Side> sides;
    for (std::size_t k = 0; k < 2 + parts_.size(); ++k) sides.push_back({&side(k).surface, side(k).regions});
    const auto meetings = this->meetings(settings_.self);
    Clearance clearance(sides, meetings, x, seen_m_, settings_.distance_m);
    for (const Seen& seen : all) {
        const auto first = seen.candidate.first_nodes(), second = seen.candidate.second_nodes();
        const std::pair both(side_of(first[0]), side_of(second[0]));
        const auto is_it = [&](const auto& m) { return m == both || m == std::pair(both.second, both.first); };
        const auto meeting = std::ranges::find_if(meetings, is_it);
        const bool in_order = *meeting == both;
        clearance.offer(static_cast<std::size_t>(meeting - meetings.begin()), in_order ? first : second,
                        in_order ? second : first, seen.now_m, reach_of(seen));
    }
    const std::lock_guard lock(memory_->mutex);
    memory_->clear.known = std::make_shared<const Clearance>(std::move(clearance));
    memory_->clear.end.assign(x.begin(), x.end());
    memory_->clear.served = 0;
}

/// Of a motion that is longer than the robot all pairs would have to be followed for a long way, although it ends
/// early: the search begins with a part of it that is blocked.
double Contact::largest_step(std::span<const double> x, std::span<const double> dx) const {
    if (!(linalg::longest(dx) > linalg::diagonal(x))) return free_step(x, dx, 0);
    constexpr double shorter = 1.0 / 16, least = 1e-12;
    std::vector<double> part(dx.begin(), dx.end());
    double share = 1;
    while (share > least) {
        std::vector<double> next = part;
        for (double& d : next) d *= shorter;
        if (is_free(x, next)) break;
        part = std::move(next);
        share *= shorter;
    }
    return share * free_step(x, part, 0);
}

bool Contact::is_free(std::span<const double> x, std::span<const double> dx) const {
    return free_step(x, dx, 1) >= 1;
}

double Contact::free_step(std::span<const double> x, std::span<const double> dx, double enough) const {
    const double free = largest_exact_step(x, dx);
    if (free < enough || is_clear(x, dx)) return free;
    const double margin = kept_share * settings_.distance_m;
    std::atomic<bool> ended = false;
    const auto limit = [&](const Search::Candidate& c, double& step) {
        if (ended.load(std::memory_order_relaxed) || !c.comes_near(x, dx, margin)) return;
        const Stencil from = stencil_at(c.nodes, x), by = stencil_at(c.nodes, dx);
        // Neighbours, which do not count, are followed the longest, since they stay near each other.
        const Advance first = advance(c.features(), from, by, kept_share, step, few_looks);
        if (first.ended && first.step >= step) return;
        if (left_out(c.first_nodes(), c.second_nodes(), std::sqrt(c.squared_distance(rest_)))) return;
        const double t = first.ended ? first.step : contact::largest_step(c.features(), from, by, kept_share, step);
        if (t >= step) return;
        step = t;
        if (t < enough) ended.store(true, std::memory_order_relaxed);
    };
    const auto known = nearby(x, dx);
    const std::vector<double> steps =
        known ? known->run(free, limit)
              : Search(*this, x, dx, margin, Search::What::pairs, settings_.self).run(free, limit);
    return std::accumulate(steps.begin(), steps.end(), free, [](double a, double b) { return std::min(a, b); });
}

bool Contact::meets(std::span<const double> x, std::span<const double> dx) const {
    if (largest_exact_step(x, dx) < 1) return true;
    if (is_clear(x, dx)) return false;
    // Distances at the start answer for this step as well as for later ones; the search along the step is slower.
    note_clearance(x);
    return !is_clear(x, dx) && !is_free(x, dx);
}

}  // namespace pliant::sim::contact

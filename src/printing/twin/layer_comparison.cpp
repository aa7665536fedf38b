#include "printing/twin/layer_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pliant::twin {
namespace {

/// Runs of one image, traversed row by row.
struct Source {
    int resin = 0;
    const Runs* runs = nullptr;
    double seconds = 0;
    int pieces = 1;
    std::size_t at = 0;  ///< first run not completed yet
    int value = 0;       ///< in the current piece of the row
};

/// The state of a resin in one piece of a row.
struct ResinThere {
    int resin = 0;
    int left = 0;                               ///< cured, and not yet claimed by an image
    int lacking = 0;                            ///< required but not cured
    double asked_value_s = 0, lit_value_s = 0;  ///< sum over images of value times time
    int value = 0;                              ///< required in total
    int pieces = 1;
};

class Walk {
public:
    Walk(const std::vector<AskedImage>& asked, const std::vector<ShownPicture>& shown, double slack_s)
        : slack_s_(slack_s) {
        for (const AskedImage& a : asked) asked_.push_back({a.resin, &a.runs, a.seconds, 1});
        for (const ShownPicture& s : shown) shown_.push_back({s.resin, s.runs, s.seconds, s.pieces});
        found_.images.resize(asked.size());
        for (std::size_t i = 0; i < asked.size(); ++i) found_.images[i].light = light_of(asked[i].runs);
    }

    LayerDifference result() {
        for (std::optional<int> row = next_row(); row; row = next_row()) walk_row(*row);
        return std::move(found_);
    }

private:
    template <class Each>
    void for_all(Each each) {
        for (std::vector<Source>* sources : {&asked_, &shown_}) {
            for (Source& source : *sources) each(source);
        }
    }

    std::optional<int> next_row() {
        std::optional<int> row;
        for_all([&](const Source& s) {
            if (s.at < s.runs->size()) row = std::min(row.value_or((*s.runs)[s.at].row), (*s.runs)[s.at].row);
        });
        return row;
    }

    /// Between two ends of runs nothing changes.
    void walk_row(int row) {
        borders_.clear();
        for_all([&](const Source& s) {
            for (std::size_t i = s.at; i < s.runs->size() && (*s.runs)[i].row == row; ++i) {
                borders_.push_back((*s.runs)[i].begin);
                borders_.push_back((*s.runs)[i].end);
            }
        });
        std::sort(borders_.begin(), borders_.end());
        borders_.erase(std::unique(borders_.begin(), borders_.end()), borders_.end());
        for (std::size_t i = 0; i + 1 < borders_.size(); ++i) {
            for_all([&](Source& s) { look(s, row, borders_[i]); });
            compare(borders_[i + 1] - borders_[i]);
        }
        for_all([&](Source& s) {
            while (s.at < s.runs->size() && (*s.runs)[s.at].row == row) ++s.at;
        });
    }

    static void look(Source& s, int row, int column) {
        const auto in_row = [&] { return s.at < s.runs->size() && (*s.runs)[s.at].row == row; };
        while (in_row() && (*s.runs)[s.at].end <= column) ++s.at;
        s.value = in_row() && (*s.runs)[s.at].begin <= column ? (*s.runs)[s.at].value : 0;
    }

    ResinThere& there(int resin) {
        const auto known = std::find_if(there_.begin(), there_.end(), [&](auto& r) { return r.resin == resin; });
        if (known != there_.end()) return *known;
        return there_.emplace_back(ResinThere{resin});
    }

    /// Subtracts what the images require from the cured resins. What no image claims is excess; what is not available
    /// is lacking.
    void compare(int pixels) {
        there_.clear();
        for (const Source& s : shown_) {
            if (s.value == 0) continue;
            ResinThere& r = there(s.resin);
            r.left += s.value;
            r.lit_value_s += s.value * s.seconds;
            r.pieces = std::max(r.pieces, s.pieces);
        }
        lacking_.assign(asked_.size(), 0);
        for (std::size_t i = 0; i < asked_.size(); ++i) {
            const Source& s = asked_[i];
            if (s.value == 0) continue;
            ResinThere& r = there(s.resin);
            const int have = std::min(s.value, r.left);
            r.left -= have;
            r.value += s.value;
            r.asked_value_s += s.value * s.seconds;
            lacking_[i] = s.value - have;
            r.lacking += lacking_[i];
        }
        count(pixels);
    }

    void count(int pixels) {
        int foreign = 0, lacking = 0;  // over all resins
        for (const ResinThere& r : there_) {
            lacking += r.lacking;
            foreign += r.left;
        }
        for (const ResinThere& r : there_) {
            if (r.lacking > 0) (foreign > r.left ? found_.foreign_px : found_.missing_px) += pixels;
            if (r.left > 0 && lacking == r.lacking) found_.stray_px += pixels;
            if (r.lacking > 0 || r.left > 0)
                found_.wrong_px += pixels;
            else
                judge_dose(r, pixels);
        }
        for (std::size_t i = 0; i < asked_.size(); ++i) {
            if (lacking_[i] == 0) continue;
            const int others = foreign - there(asked_[i].resin).left;
            const int replaced = std::min(lacking_[i], others);
            found_.images[i].foreign += static_cast<long long>(replaced) * pixels;
            found_.images[i].missing += static_cast<long long>(lacking_[i] - replaced) * pixels;
        }
    }

    /// Grey is a fraction of the pixel, and images that share a pixel each expose their fraction: the exposure is their
    /// weighted mean.
    void judge_dose(const ResinThere& r, int pixels) {
        const double asked_s = r.asked_value_s / r.value, lit_s = r.lit_value_s / r.value;
        if (is_right_dose(asked_s, lit_s, r.pieces, slack_s_)) return;
        found_.wrong_dose_px += pixels;
        if (asked_s <= 0) return;
        found_.least_share = std::min(found_.least_share, lit_s / asked_s);
        found_.most_share = std::max(found_.most_share, lit_s / asked_s);
    }

    double slack_s_;
    std::vector<Source> asked_, shown_;
    std::vector<int> borders_, lacking_;
    std::vector<ResinThere> there_;
    LayerDifference found_;
};

/// Whether every image is a required one, in its resin and for the right time, and none is missing.
bool all_as_asked(const std::vector<AskedImage>& asked, const std::vector<ShownPicture>& shown, double slack_s) {
    if (asked.size() != shown.size()) return false;
    std::vector<bool> taken(shown.size());
    for (const AskedImage& a : asked) {
        std::size_t i = 0;
        while (i < shown.size() && (taken[i] || shown[i].resin != a.resin || *shown[i].runs != a.runs)) ++i;
        if (i == shown.size() || !is_right_dose(a.seconds, shown[i].seconds, shown[i].pieces, slack_s)) return false;
        taken[i] = true;
    }
    return true;
}

}  // namespace

bool is_right_dose(double asked_s, double lit_s, int pieces, double slack_s) {
    if (pieces > 1 && lit_s > 1.5 * asked_s) return false;
    return std::abs(lit_s - asked_s) <= 0.01 * asked_s + slack_s;
}

LayerDifference difference(const std::vector<AskedImage>& asked, const std::vector<ShownPicture>& shown,
                           double slack_s) {
    if (!all_as_asked(asked, shown, slack_s)) return Walk(asked, shown, slack_s).result();
    LayerDifference none;
    for (const AskedImage& a : asked) none.images.push_back({light_of(a.runs), 0, 0});
    return none;
}

}  // namespace pliant::twin

#include "presentation/print_report/print_story.hpp"

#include <fmt/format.h>

#include <optional>

#include "printing/host/print_names.hpp"

namespace pliant::report {
namespace {

/// Text of a value, "" where there is none.
std::string text_of(const host::JournalRecord& record, std::string_view key) {
    const std::string* value = record.find(key);
    return value == nullptr ? "" : *value;
}

class Teller {
public:
    explicit Teller(const std::vector<std::string>& materials) : materials_(materials) {}
    [[nodiscard]] Status take(const host::JournalRecord& record);
    [[nodiscard]] PrintStory finish() {
        for (const auto& [record, key] : open_) {
            story_.happenings.push_back({record,
                                         last_at_s_,
                                         key.first,
                                         true,
                                         "the host ended in the light of " + host::layer_text(key.first),
                                         {}});
            ++story_.faults;
        }
        for (std::size_t h = 0; h < story_.happenings.size(); ++h) say_how_it_went_on(h);
        return std::move(story_);
    }

private:
    [[nodiscard]] Status session(const host::JournalRecord& record);
    [[nodiscard]] Status light(const host::JournalRecord& record);
    [[nodiscard]] Status dark(const host::JournalRecord& record);
    [[nodiscard]] Status change(const host::JournalRecord& record);
    void tell(const host::JournalRecord& record, bool fault, std::string text) {
        story_.happenings.push_back({record.number, last_at_s_, last_layer_, fault, std::move(text), {}});
        if (fault) ++story_.faults;
    }
    [[nodiscard]] Status skip(const host::JournalRecord& record);
    void say_how_it_went_on(std::size_t index);

    const std::vector<std::string>& materials_;
    PrintStory story_;
    std::string boot_;
    std::optional<double> zero_s_;  ///< on the devices' clock: the time of the print's first exposure
    double last_at_s_ = -1;
    int last_layer_ = -1;
    std::map<long, std::pair<int, int>> open_;      ///< running exposures, by record
    std::map<long, std::pair<double, int>> begun_;  ///< start time and layer of each exposure, by record
};

Status Teller::session(const host::JournalRecord& record) {
    ++story_.sessions;
    const std::string boot = text_of(record, "boot");
    const bool restarted = story_.sessions > 1 && boot != boot_;
    boot_ = boot;
    if (restarted) zero_s_.reset();
    if (story_.sessions == 1) return {};
    const bool reset = text_of(record, "before") == "-1";
    tell(record, true,
         fmt::format("{}, and {}", restarted ? "the computer has been started anew" : "another host takes over",
                     reset ? "the controller has lost its position" : "the controller has kept its position"));
    return {};
}

Status Teller::light(const host::JournalRecord& record) {
    const auto layer = record.whole("layer"), material = record.whole("material");
    const auto planned = record.number_of("planned"), at = record.number_of("at");
    if (!layer) return tl::unexpected(layer.error());
    if (!material) return tl::unexpected(material.error());
    if (!planned) return tl::unexpected(planned.error());
    if (!at) return tl::unexpected(at.error());
    if (!zero_s_) zero_s_ = *at - std::max(last_at_s_, 0.0);
    last_at_s_ = *at - *zero_s_;
    last_layer_ = static_cast<int>(*layer);
    const std::pair<int, int> key{last_layer_, static_cast<int>(*material)};
    const auto [found, is_new] = story_.lights.try_emplace(key);
    if (is_new) {
        story_.order[key] = static_cast<int>(story_.order.size());
        found->second.at_s = last_at_s_;
    }
    found->second.planned_s = *planned;
    ++found->second.pieces;
    open_[record.number] = key;
    begun_[record.number] = {last_at_s_, last_layer_};
    return {};
}

Status Teller::dark(const host::JournalRecord& record) {
    const auto number = record.whole("light");
    const auto on = record.number_of("on");
    if (!number) return tl::unexpected(number.error());
    if (!on) return tl::unexpected(on.error());
    const auto known = open_.find(*number);
    if (known == open_.end()) return input_error("record {}: no light {} is on", record.number, *number);
    GivenLight& light = story_.lights[known->second];
    light.lit_s += *on;
    light.complete = text_of(record, "done") == "1";
    const std::string by = text_of(record, "by");
    const std::string layer = host::layer_text(known->second.first);
    open_.erase(known);
    if (by == "guard")
        tell(record, true,
             fmt::format("the host died in the light of {}; its guard made dark after {:.2f} s", layer, *on));
    if (by == "assumed")
        tell(record, true, fmt::format("nobody saw the end of the light of {}; {:.2f} s were assumed", layer, *on));
    if (by == "host" && !light.complete)
        tell(record, false,
             fmt::format("the light of {} broke off after {:.2f} of {:.2f} s", layer, light.lit_s, light.planned_s));
    return {};
}

Status Teller::change(const host::JournalRecord& record) {
    const auto material = record.whole("material"), from = record.whole("from");
    const auto seconds = record.number_of("seconds");
    if (!material) return tl::unexpected(material.error());
    if (!from) return tl::unexpected(from.error());
    if (!seconds) return tl::unexpected(seconds.error());
    tell(record, false,
         fmt::format("{} is lit for {:g} s from {} on", host::material_text(materials_, static_cast<int>(*material)),
                     *seconds, host::layer_text(static_cast<int>(*from))));
    return {};
}

Status Teller::skip(const host::JournalRecord& record) {
    const auto layer = record.whole("layer");
    if (!layer) return tl::unexpected(layer.error());
    tell(record, false, host::layer_text(static_cast<int>(*layer)) + " gets no light");
    return {};
}

Status Teller::take(const host::JournalRecord& record) {
    const std::string& kind = record.kind;
    if (kind == "session") return session(record);
    if (kind == "light") return light(record);
    if (kind == "dark") return dark(record);
    if (kind == "exposure") return change(record);
    if (kind == "skip") return skip(record);
    if (kind == "begin") {
        story_.job = text_of(record, "job");
        story_.digest = text_of(record, "digest");
        story_.printer = text_of(record, "printer");
        story_.end = PrintEnd::interrupted;
    } else if (kind == "stop") {
        tell(record, true, "stopped: " + text_of(record, "why"));
    } else if (kind == "pause") {
        const std::string asked = text_of(record, "asked");
        tell(record, false, asked.empty() ? "paused" : "paused: " + asked);
    } else if (kind == "resume") {
        tell(record, false, "resumed");
    } else if (kind == "suspend") {
        tell(record, false, "suspended and parked");
    } else if (kind == "cancel") {
        story_.end = PrintEnd::cancelled;
        tell(record, false, "cancelled and parked");
    } else if (kind == "end") {
        story_.end = PrintEnd::complete;
    }
    return {};
}

/// A fault was survived if exposures follow it.
void Teller::say_how_it_went_on(std::size_t index) {
    Happening& h = story_.happenings[index];
    if (!h.fault) return;
    const auto next = begun_.upper_bound(h.record);
    if (next != begun_.end())
        h.then = "survived: the light went on in " + host::layer_text(next->second.second);
    else if (story_.end == PrintEnd::complete)
        h.then = "survived: all light had been given";
    else
        h.then = story_.end == PrintEnd::cancelled ? "the print was put away" : "the print waits to be resumed";
}

}  // namespace

Result<PrintStory> story_of(const std::vector<host::JournalRecord>& records,
                            const std::vector<std::string>& materials) {
    Teller teller(materials);
    for (const host::JournalRecord& record : records) {
        if (Status status = teller.take(record); !status) return tl::unexpected(status.error());
    }
    return teller.finish();
}

}  // namespace pliant::report

#include "printing/prepare/pairs.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "printing/prepare/option_text.hpp"

namespace pliant::prepare {
namespace {

struct Pair {
    std::string first, second;
    int pixels = 0, layers = 0;
    std::string named{};  ///< the pair that was given, as in "soft and firm"
};

/// FIRST+SECOND=PIXELS or FIRST+SECOND=PIXELS,LAYERS.
Result<Pair> read_pair(const char* option, const std::string& text, int default_layers) {
    const std::size_t equals = text.rfind('='), plus = text.find('+');
    if (equals == std::string::npos || plus == std::string::npos || plus > equals)
        return input_error("{} {}: write MATERIAL+MATERIAL=PIXELS or MATERIAL+MATERIAL=PIXELS,LAYERS", option, text);
    const std::string numbers = text.substr(equals + 1);
    const std::size_t comma = std::min(numbers.find(','), numbers.size());
    Pair pair{text.substr(0, plus), text.substr(plus + 1, equals - plus - 1), 0, default_layers};
    pair.named = pair.first + " and " + pair.second;
    pair.pixels = plain_number(numbers.substr(0, comma));
    if (comma < numbers.size()) pair.layers = plain_number(numbers.substr(comma + 1));
    if (pair.pixels < 0 || pair.layers < 0)
        return input_error("{} {}: \"{}\" must be whole numbers, as in 4 or 4,2", option, text, numbers);
    return pair;
}

/// The materials of bodies that a pair means by a name: that one, and those made of it for exposures of their own.
std::vector<std::string> meant_by(const std::string& name, const Order& order, const Drawing& drawing) {
    std::vector<std::string> names;
    for (const auto& [own, whole] : drawing.made_of) {
        if (whole == name) names.push_back(own);
    }
    if (names.empty() || name == order.support || has_body_of(drawing, name)) names.insert(names.begin(), name);
    return names;
}

/// The pairs of an option, in order; a pair that is named itself is left as it is named.
Result<std::vector<Pair>> pairs_of(const char* option, const std::vector<std::string>& texts, int default_layers,
                                   const Order& order, const Drawing& drawing) {
    std::vector<Pair> named, meant;
    for (const std::string& text : texts) {
        Result<Pair> pair = read_pair(option, text, default_layers);
        if (!pair) return tl::unexpected(pair.error());
        named.push_back(std::move(*pair));
    }
    const auto is_named = [&](const std::string& a, const std::string& b) {
        return std::any_of(named.begin(), named.end(), [&](const Pair& p) {
            return (p.first == a && p.second == b) || (p.first == b && p.second == a);
        });
    };
    for (const Pair& pair : named) {
        if (pair.first == pair.second) {
            meant.push_back(pair);
            continue;
        }
        for (const std::string& first : meant_by(pair.first, order, drawing)) {
            for (const std::string& second : meant_by(pair.second, order, drawing)) {
                const bool itself = first == pair.first && second == pair.second;
                if (!itself && (first == second || is_named(first, second))) continue;
                meant.push_back({first, second, pair.pixels, pair.layers, pair.named});
            }
        }
    }
    return meant;
}

}  // namespace

Status set_pairs(const Order& order, const Drawing& drawing, slice::Settings& slicing) {
    if (!drawing.stacks.empty() && !(order.interlocks.empty() && order.overlaps.empty()))
        return input_error("--interlock, --overlap: layer images are printed as they are");
    const auto interlocks = pairs_of("--interlock", order.interlocks, 1, order, drawing);
    if (!interlocks) return tl::unexpected(interlocks.error());
    for (const Pair& p : *interlocks) slicing.teeth.push_back({p.first, p.second, p.pixels, p.layers, p.named});
    const auto overlaps = pairs_of("--overlap", order.overlaps, 0, order, drawing);
    if (!overlaps) return tl::unexpected(overlaps.error());
    for (const Pair& p : *overlaps) slicing.bonds.push_back({p.first, p.second, p.pixels, p.layers, p.named});
    return {};
}

}  // namespace pliant::prepare

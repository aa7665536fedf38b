// What a person asks for when a part is sliced, as texts: the options of `pliant slice`.
#pragma once

#include <string>
#include <vector>

namespace pliant::prepare {

/// Empty texts are not given. docs/reference/commands.md says what each may be.
struct Order {
    std::vector<std::string> inputs;
    std::string layer, least_layer;
    std::vector<std::string> assignments, resins, interlocks, overlaps, exposures;
    int copies = 1;
    std::string spacing = "2 mm";
    std::vector<double> turn;
    double scale = 1;
    std::vector<double> at;  ///< of the part's middle from the platform's, mm; empty: in the middle
    std::string least_feature;
    bool any_vat = false;  ///< a resin that no vat holds may be filled into any
    bool no_anti_alias = false;
    double threshold = 0.5;
    std::string support, support_angle, support_spacing, support_tip, support_pillar, lift, raft;
    std::string support_paint;                    ///< a table as read_paint() reads it, not its name
    std::string support_paint_file = "supports";  ///< what messages call it
    std::string hollow, drain;
    std::string version;  ///< of Pliant, for the job to keep
};

}  // namespace pliant::prepare

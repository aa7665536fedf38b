// A slicing order as texts: the options of `pliant slice`.
#pragma once

#include <string>
#include <vector>

namespace pliant::prepare {

/// Empty texts mean not given. docs/reference/commands.md lists the valid values.
struct Order {
    std::vector<std::string> inputs;
    std::string layer, least_layer;
    std::vector<std::string> assignments, resins, interlocks, overlaps, exposures;
    int copies = 1;
    std::string spacing = "2 mm";
    std::vector<double> turn;
    double scale = 1;
    std::vector<double> at;  ///< part's centre from the platform's, mm; empty: centred
    std::string least_feature;
    bool any_vat = false;  ///< a resin without a vat may be filled into any vat
    bool no_anti_alias = false;
    double threshold = 0.5;
    std::string support, support_angle, support_spacing, support_tip, support_pillar, lift, raft;
    std::string support_paint;                    ///< the table itself, in the format of read_paint(), not its file
                                                  ///< name
    std::string support_paint_file = "supports";  ///< its name in messages
    std::string hollow, drain;
    std::string version;  ///< of Pliant, recorded in the job
};

}  // namespace pliant::prepare

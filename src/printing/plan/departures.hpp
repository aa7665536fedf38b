// When the part leaves a vat, and how much resin it carries off: the film on its lower end.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/order.hpp"

namespace pliant::plan {

struct Departure {
    int vat = 0;              ///< that the part leaves
    int next = -1;            ///< the vat that comes in its place; -1 at the end of the print
    std::size_t printed = 0;  ///< the last layer printed from it
    std::size_t layer = 0;    ///< before or within which the part leaves; at the end, the last one printed
    double film_ml = 0;       ///< on the part, before brush and cleaning
};

/// In the order of the print. `order`: the vats of each layer; `vat_of_image`: see Plan. At the end the part leaves its
/// last vat if the machine puts vats away.
[[nodiscard]] std::vector<Departure> departures(std::span<const VatList> order,
                                                std::span<const std::vector<int>> vat_of_image,
                                                const job::Manifest& job, const machine::Printer& printer);

/// Resin in ml that a vat loses with the part after its share of a layer: for each layer and vat of the printer. Empty:
/// nothing is lost.
using CarriedOff = std::vector<std::vector<double>>;

/// What the departures take: their films, less what a brush returns.
[[nodiscard]] CarriedOff carried_off(std::span<const Departure> departures, std::size_t layers,
                                     const machine::Printer& printer);

/// No less than carried_off(), whatever vats are used in whatever order.
[[nodiscard]] CarriedOff most_carried_off(const job::Manifest& job, const machine::Printer& printer);

}  // namespace pliant::plan

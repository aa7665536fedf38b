// How clean the machine's nozzles get the part in the virtual printer, at its present height.
#pragma once

#include <optional>
#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/twin/cure.hpp"
#include "printing/wash/run_off.hpp"

namespace pliant::twin {

/// Caches the result until the part has grown by a twentieth: tracing rays costs some milliseconds. The printer must
/// outlive it.
class SprayedPart {
public:
    explicit SprayedPart(const machine::Printer& printer) : printer_(&printer) {}

    /// Fraction of the film that this many seconds of spray remove, averaged over the part's surface. Nothing if the
    /// machine does not list its nozzles, or before the first layer is closed: then the mean of the thesis'
    /// measurements is used.
    [[nodiscard]] std::optional<double> removed(const Cure& cure, double seconds);
    /// The part is removed.
    void clear();

private:
    void look(const std::vector<CuredLayer>& layers);

    const machine::Printer* printer_;
    int seen_um_ = 0;  ///< height of the part at the last ray tracing
    std::vector<wash::Face> faces_;
    std::vector<double> rates_;
};

}  // namespace pliant::twin

// How clean the machine's sprinklers get the part in the virtual printer, as far as it has grown.
#pragma once

#include <optional>
#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/twin/cure.hpp"
#include "printing/wash/run_off.hpp"

namespace pliant::twin {

/// Keeps what the jets reach until the part has grown by a twentieth: rays cost some milliseconds. The printer must
/// outlive it.
class SprayedPart {
public:
    explicit SprayedPart(const machine::Printer& printer) : printer_(&printer) {}

    /// Share of the film that so many seconds of spray take off, in the mean over the part's surface. Nothing where the
    /// machine does not say where its sprinklers are, or before the first layer is closed: then the mean of the thesis'
    /// measurements has to do.
    [[nodiscard]] std::optional<double> removed(const Cure& cure, double seconds);
    /// The part is gone.
    void clear();

private:
    void look(const std::vector<CuredLayer>& layers);

    const machine::Printer* printer_;
    int seen_um_ = 0;  ///< height of the part that the jets were followed to
    std::vector<wash::Face> faces_;
    std::vector<double> rates_;
};

}  // namespace pliant::twin

#include "printing/wash/spray.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/core/parallel.hpp"

namespace pliant::wash {
namespace {

using machine::Printer;

constexpr int places_of_stroke = 12;  // number of positions at which a stroke is sampled

/// A nozzle at one moment, in the part's frame, millimetres.
struct Head {
    Vec3 place;
    Vec3 aim;
    double least_cosine = 0;   ///< of the angle between its axis and a drop
    double flow_mm3_s_sr = 0;  ///< per solid angle of the cone
};

/// Nozzles at a fraction of the stroke: the carriage starts from its back position and moves on, the platform rises.
std::vector<Head> heads_at(const Printer& p, double part_mm, const Strokes& strokes, double share) {
    double flow = 0;
    for (const machine::Sprinkler& s : p.sprinklers) flow += s.flow;
    const bool tower = p.has_carriage();
    const double back_mm = tower ? (p.carriage.back_off_um + share * strokes.x_um) / 1000 : 0;
    const double hang_um = tower ? p.clear_um(0) : p.table.bath_gap_um;
    const double platform_mm = part_mm + (hang_um + share * strokes.z_um) / 1000;
    std::vector<Head> heads;
    for (const machine::Sprinkler& s : p.sprinklers) {
        Head head{{s.place_mm[0], s.place_mm[1], s.place_mm[2] - platform_mm}, {s.aim[0], s.aim[1], s.aim[2]}, 0, 0};
        (p.carriage.along_y ? head.place.y : head.place.x) -= back_mm;
        head.least_cosine = std::cos(s.cone_rad / 2);
        const double steradians = 2 * std::numbers::pi * (1 - head.least_cosine);
        head.flow_mm3_s_sr = 1000 * p.cleaning.solvent_ml_s * s.flow / flow / steradians;
        heads.push_back(head);
    }
    return heads;
}

bool is_solid(const PartCells& part, const Vec3& point) {
    const auto cell = [](double mm, double size) { return static_cast<int>(std::floor(mm / size)); };
    return part.at(cell(point.x - part.x_mm, part.cell_mm), cell(point.y - part.y_mm, part.cell_mm),
                   cell(-point.z, part.high_mm));
}

/// Walks along a ray from cell to cell until it leaves the part's box; returns whether it hits a solid cell.
bool is_hidden(const PartCells& part, const Vec3& from, const Vec3& direction) {
    const std::array<double, 3> size = {part.cell_mm, part.cell_mm, part.high_mm};
    const std::array<double, 3> at = {from.x - part.x_mm, from.y - part.y_mm, -from.z};
    const std::array<double, 3> way = {direction.x, direction.y, -direction.z};
    const std::array<int, 3> cells = {part.columns, part.rows, part.slabs};
    std::array<int, 3> cell{}, step{};
    std::array<double, 3> next{}, each{};
    for (std::size_t i = 0; i < 3; ++i) {
        cell[i] = static_cast<int>(std::floor(at[i] / size[i]));
        step[i] = way[i] > 0 ? 1 : -1;
        const double border = (cell[i] + (way[i] > 0 ? 1 : 0)) * size[i];
        each[i] = way[i] != 0 ? size[i] / std::abs(way[i]) : std::numeric_limits<double>::infinity();
        next[i] = way[i] != 0 ? (border - at[i]) / way[i] : std::numeric_limits<double>::infinity();
    }
    for (;;) {
        const auto i = static_cast<std::size_t>(std::min_element(next.begin(), next.end()) - next.begin());
        cell[i] += step[i];
        next[i] += each[i];
        if (step[i] > 0 ? cell[i] >= cells[i] : cell[i] < 0) return false;
        if (part.at(cell[0], cell[1], cell[2])) return true;
    }
}

/// Contribution of one nozzle to a face, in mm per second.
double rate_of(const PartCells& part, const Face& face, const Head& head) {
    const Vec3 to_head = head.place - face.middle;
    const double distance = norm(to_head);
    if (!(distance > 0)) return 0;
    const Vec3 direction = to_head / distance;
    const double facing = dot(direction, face.normal);
    if (facing <= 0 || -dot(direction, head.aim) < head.least_cosine) return 0;
    // Starts outside by the height of the steps that approximate a slope; between two walls, at the face itself.
    const double cell_mm = std::min(part.cell_mm, part.high_mm);
    Vec3 from = face.middle + cell_mm * face.normal;
    if (is_solid(part, from)) from = face.middle + 1e-3 * cell_mm * face.axis;
    if (is_hidden(part, from, unit(head.place - from))) return 0;
    return head.flow_mm3_s_sr * facing / (distance * distance);
}

}  // namespace

Strokes strokes_of(const Printer& printer) {
    return {printer.has_carriage() ? printer.cleaning.stroke_x_um : 0, printer.cleaning.stroke_z_um};
}

std::vector<double> spray_rates(const PartCells& part, const std::vector<Face>& faces, const Printer& printer,
                                const Strokes& strokes) {
    std::vector<Head> heads;
    for (int i = 0; i < places_of_stroke; ++i) {
        const double share = (i + 0.5) / places_of_stroke;
        for (const Head& head : heads_at(printer, part.height_mm(), strokes, share)) heads.push_back(head);
    }
    std::vector<double> rates(faces.size());
    constexpr std::size_t grain = 256;
    parallel_for(faces.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            double sum = 0;
            for (const Head& head : heads) sum += rate_of(part, faces[f], head);
            rates[f] = sum / places_of_stroke;
        }
    });
    return rates;
}

Cleanness cleanness(const std::vector<Face>& faces, const std::vector<double>& rates_mm_s, double seconds) {
    Cleanness c;
    double area = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const double left = std::exp(-rates_mm_s[f] * seconds / wash_depth_mm);
        c.left.push_back(left);
        c.removed += faces[f].area_mm2 * (1 - left);
        c.unseen += rates_mm_s[f] > 0 ? 0 : faces[f].area_mm2;
        area += faces[f].area_mm2;
    }
    if (area <= 0) return c;
    c.removed /= area;
    c.unseen /= area;
    return c;
}

}  // namespace pliant::wash

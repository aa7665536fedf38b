#include "printing/prepare/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/mesh/triangle_tree.hpp"
#include "printing/job/exposure.hpp"
#include "printing/prepare/option_text.hpp"
#include "printing/prepare/settings.hpp"

namespace pliant::prepare {
namespace {

/// What an estimate does not include is an error all the same if it cannot be read.
Status check_slow(const Order& order) {
    if (Status status = check_companions(order); !status) return status;
    if (!order.hollow.empty()) {
        if (const auto hollow = hollow_settings(order); !hollow) return tl::unexpected(hollow.error());
    }
    const Result<double> least = length_um("--least-layer", order.least_layer, 0);
    if (!least) return tl::unexpected(least.error());
    return check_supports(order);
}

/// Removes what an estimate does not include, and the material that would be printed in supports alone.
void leave_out_slow(const Drawing& drawing, Order& order, job::JobSettings& settings) {
    std::erase_if(settings.materials, [&](const job::Material& material) {
        return material.name == order.support && !has_body_of(drawing, material.name);
    });
    for (std::string* text :
         {&order.support, &order.support_angle, &order.support_spacing, &order.support_tip, &order.support_pillar,
          &order.support_paint, &order.lift, &order.raft, &order.hollow, &order.drain, &order.least_layer})
        text->clear();
}

int material_of(const job::Manifest& manifest, const std::string& name) {
    const auto found = std::find_if(manifest.materials.begin(), manifest.materials.end(),
                                    [&](const job::Material& m) { return m.name == name; });
    return found == manifest.materials.end() ? -1 : static_cast<int>(found - manifest.materials.begin());
}

/// Adds an area in mm² of a material to each layer whose middle is between two heights.
void fill(job::Manifest& manifest, int material, double bottom_um, double top_um, double area_mm2) {
    for (job::Layer& layer : manifest.layers) {
        const double middle_um = layer.z_um - 0.5 * layer.thickness_um;
        if (middle_um < bottom_um || middle_um > top_um) continue;
        const auto known = std::find_if(layer.images.begin(), layer.images.end(),
                                        [&](const job::LayerImage& i) { return i.material == material; });
        if (known != layer.images.end())
            known->area_mm2 += area_mm2;
        else
            layer.images.push_back({material, "estimate.png", area_mm2});
    }
}

/// The volume that is cut out of a body, by the points of a grid in each piece of air: as rough as an estimate is.
double air_um3(const slice::Body& body) {
    constexpr int cells = 16;
    if (body.air_um.empty()) return 0;
    const mesh::TriangleTree part(body.surface_um);
    double sum = 0;
    for (const mesh::TriMesh& surface : body.air_um) {
        const mesh::TriangleTree air(surface);
        const Box3 box = mesh::bounds(surface);
        const Vec3 step = box.size() / cells;
        int inside = 0, common = 0;
        for (int k = 0; k < cells * cells * cells; ++k) {
            const Vec3 p = box.low + Vec3{(k % cells + 0.5) * step.x, (k / cells % cells + 0.5) * step.y,
                                          (k / (cells * cells) + 0.5) * step.z};
            if (std::fabs(air.winding_number(p)) < 0.5) continue;
            ++inside;
            common += std::fabs(part.winding_number(p)) < 0.5 ? 0 : 1;
        }
        if (inside > 0) sum += std::fabs(mesh::signed_volume(surface)) * common / inside;
    }
    return sum;
}

Status add_body(const slice::Body& body, std::size_t index, job::Manifest& manifest) {
    if (!body.slices.empty()) return input_error("{}: is made of slices: no estimate", slice::describe(body, index));
    const Result<Box3> box = slice::bounds(body, slice::describe(body, index));
    if (!box) return tl::unexpected(box.error());
    constexpr double um3_in_mm3 = 1e9;
    const double volume_mm3 =
        std::max(0.0, std::fabs(mesh::signed_volume(body.surface_um)) - air_um3(body)) / um3_in_mm3;
    const double height_mm = (box->high.z - box->low.z) / 1000;
    const double area_mm2 = height_mm > 0 ? volume_mm3 / height_mm : 0;
    const double share = body.blend ? 0.5 : 1;
    fill(manifest, material_of(manifest, body.material), box->low.z, box->high.z, share * area_mm2);
    if (body.blend)
        fill(manifest, material_of(manifest, body.blend->second), box->low.z, box->high.z, (1 - share) * area_mm2);
    return {};
}

/// Sorts images by material, and gives each its own exposure if its material has a rule.
void finish(const job::JobSettings& settings, job::Manifest& manifest) {
    for (std::size_t k = 0; k < manifest.layers.size(); ++k) {
        job::Layer& layer = manifest.layers[k];
        std::sort(layer.images.begin(), layer.images.end(),
                  [](const job::LayerImage& a, const job::LayerImage& b) { return a.material < b.material; });
        for (job::LayerImage& image : layer.images) {
            const job::Material& material = manifest.materials[static_cast<std::size_t>(image.material)];
            if (const auto rule = settings.exposures.find(material.name); rule != settings.exposures.end())
                image.exposure_s = job::exposure_s(material, rule->second, static_cast<int>(k), layer.thickness_um);
        }
    }
}

job::Manifest empty_job(const job::JobSettings& settings, double height_um) {
    job::Manifest manifest;
    manifest.name = settings.name;
    manifest.width_px = settings.slicing.raster.width_px;
    manifest.height_px = settings.slicing.raster.height_px;
    manifest.pixel_um = settings.slicing.raster.pixel_um;
    manifest.bottom_layers = settings.bottom_layers;
    manifest.materials = settings.materials;
    manifest.any_vat = settings.any_vat;
    const int layer_um = settings.slicing.layer_um;
    const int layers = static_cast<int>(std::lround(height_um / layer_um));
    for (int k = 0; k < layers; ++k) manifest.layers.push_back({(k + 1) * layer_um, layer_um, {}});
    return manifest;
}

}  // namespace

Result<plan::Plan> estimate(Order order, const machine::Printer& printer, Drawing drawing) {
    if (!drawing.stacks.empty()) return input_error("layer images are planned when they are sliced: no estimate");
    if (Status status = check_slow(order); !status) return tl::unexpected(status.error());
    const Result<job::JobSettings> read = job_settings(order, printer, std::nullopt, drawing);
    if (!read) return tl::unexpected(read.error());
    job::JobSettings settings = *read;
    leave_out_slow(drawing, order, settings);
    std::vector<std::string> notes;
    Progress silent;
    if (Status placed = arrange(order, settings, drawing, notes, silent); !placed)
        return tl::unexpected(placed.error());
    double height_um = 0;
    for (const slice::Body& body : drawing.bodies) {
        for (const Vec3& p : body.surface_um.points) height_um = std::max(height_um, p.z);
    }
    job::Manifest manifest = empty_job(settings, height_um);
    for (std::size_t b = 0; b < drawing.bodies.size(); ++b) {
        if (Status added = add_body(drawing.bodies[b], b, manifest); !added) return tl::unexpected(added.error());
    }
    finish(settings, manifest);
    return plan::make_plan(manifest, printer);
}

}  // namespace pliant::prepare
